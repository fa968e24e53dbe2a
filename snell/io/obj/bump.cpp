#include "snell/io/obj/bump.h"

#include "snell/core/parallel.h"

#include <atomic>

namespace snell::obj {
namespace {

constexpr std::size_t grain = 1 << 14;

// One number of a texel, 0 to 3, in [0, 1] as it is stored.
float texel(const Image& image, std::size_t i, std::size_t channel)
{
    if (image.format == texels_rgba32f) return image.floats[4 * i + channel];
    return static_cast<float>(image.bytes[4 * i + channel]) / 255.0f;
}

template <class Holds>
bool any_texel(const Image& image, const Holds& holds)
{
    std::atomic<bool> found = false;
    parallel_ranges(std::size_t{image.width} * image.height, grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end && !found.load(std::memory_order_relaxed); ++i)
            if (holds(i)) found = true;
    });
    return found;
}

} // namespace

bool has_alpha(const Image& image)
{
    return any_texel(image, [&](std::size_t i) { return texel(image, i, 3) < 1.0f; });
}

bool is_height_map(const Image& image)
{
    constexpr float rounding = 0.05f; // JPEG's greys are not quite grey
    return !any_texel(image, [&](std::size_t i) {
        const float red = texel(image, i, 0);
        return abs(texel(image, i, 1) - red) > rounding || abs(texel(image, i, 2) - red) > rounding;
    });
}

Image normal_map(const Image& heights)
{
    Image out;
    out.name = heights.name;
    out.width = heights.width;
    out.height = heights.height;
    out.format = texels_rgba8_linear;
    const std::size_t w = heights.width, h = heights.height;
    out.bytes.resize(4 * w * h);
    parallel_for(h, [&](std::size_t y) {
        const std::size_t above = (y + h - 1) % h * w, below = (y + 1) % h * w;
        for (std::size_t x = 0; x < w; ++x) {
            const float du =
                0.5f * (texel(heights, y * w + (x + 1) % w, 0) - texel(heights, y * w + (x + w - 1) % w, 0));
            const float dv = 0.5f * (texel(heights, above + x, 0) - texel(heights, below + x, 0)); // v points up
            const vec3 n = 0.5f + 0.5f * normalize(vec3(-du, -dv, 1.0f));
            for (int k = 0; k < 3; ++k)
                out.bytes[4 * (y * w + x) + static_cast<std::size_t>(k)] =
                    static_cast<std::uint8_t>(255.0f * n[k] + 0.5f);
            out.bytes[4 * (y * w + x) + 3] = 255;
        }
    });
    return out;
}

} // namespace snell::obj
