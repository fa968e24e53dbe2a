#include "snell/view/display.h"

#include "snell/core/parallel.h"
#include "snell/kernel/tone.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace snell::view {

// ---- sRGB, by table ----

namespace {
// The sRGB byte of a value in [0, 1), by the upper bits of its float: 2^11 entries an octave keep it within 0.06 of a
// step. What is below the first octave is black.
class SrgbTable
{
  public:
    SrgbTable()
    {
        for (std::size_t i = 0; i < size; ++i) {
            const std::uint32_t low = first + (static_cast<std::uint32_t>(i) << shift);
            const float middle = std::bit_cast<float>(low + (1u << (shift - 1)));
            bytes_[i] = static_cast<std::uint8_t>(std::lround(255.0f * srgb_encode(middle)));
        }
    }

    std::uint32_t operator()(float x) const
    {
        // Also false for NaN.
        if (!(x >= smallest)) return 0;
        if (x >= 1.0f) return 255;
        return bytes_[(std::bit_cast<std::uint32_t>(x) - first) >> shift];
    }

  private:
    static constexpr int octaves = 13, shift = 12; // 23 - 11
    static constexpr float smallest = 1.0f / (1 << octaves);
    static constexpr std::uint32_t first = std::bit_cast<std::uint32_t>(smallest);
    static constexpr std::size_t size = (std::bit_cast<std::uint32_t>(1.0f) - first) >> shift;
    std::array<std::uint8_t, size> bytes_{};
};
} // namespace

static const SrgbTable& srgb_table()
{
    static const SrgbTable table;
    return table;
}

static std::uint32_t pack(const SrgbTable& table, vec3 linear)
{
    return table(linear.x) | table(linear.y) << 8 | table(linear.z) << 16 | 0xff000000u;
}

// Calls with(f), where f is the curve without a test of which one it is.
template <class With>
static void with_curve(uint curve, const With& with)
{
    switch (curve) {
    case tone_reinhard:
        return with([](vec3 c) { return tone_curve(c, tone_reinhard); });
    case tone_aces:
        return with([](vec3 c) { return tone_curve(c, tone_aces); });
    case tone_none:
        return with([](vec3 c) { return c; });
    default:
        return with([curve](vec3 c) { return tone_curve(c, curve); });
    }
}

void to_screen(const vec3* radiance, std::size_t count, const DisplaySettings& settings, std::uint32_t* to)
{
    const SrgbTable& table = srgb_table();
    const float scale = std::exp2(settings.exposure_ev);
    with_curve(settings.curve, [&](auto&& curve) {
        for (std::size_t i = 0; i < count; ++i) to[i] = pack(table, curve(scale * max(radiance[i], vec3(0.0f))));
    });
}

// ---- from films ----

static vec3 mean(const Film& film, std::size_t pixel)
{
    const uint n = film.sample_count[pixel];
    return n == 0 ? vec3(0.0f) : film.sum[pixel] * (1.0f / static_cast<float>(n));
}

// Bilinear, at (x, y) in [0, 1].
static vec3 enlarged(const Film& film, float x, float y)
{
    const float px = std::clamp(x * static_cast<float>(film.width) - 0.5f, 0.0f, static_cast<float>(film.width - 1));
    const float py = std::clamp(y * static_cast<float>(film.height) - 0.5f, 0.0f, static_cast<float>(film.height - 1));
    const int x0 = static_cast<int>(px), y0 = static_cast<int>(py);
    const int x1 = std::min(x0 + 1, film.width - 1), y1 = std::min(y0 + 1, film.height - 1);
    const float u = px - static_cast<float>(x0), v = py - static_cast<float>(y0);
    const auto at = [&](int column, int row) {
        return mean(film, static_cast<std::size_t>(row) * static_cast<std::size_t>(film.width) +
                              static_cast<std::size_t>(column));
    };
    return mix(mix(at(x0, y0), at(x1, y0), u), mix(at(x0, y1), at(x1, y1), u), v);
}

void to_screen(const Shot& shot, const DisplaySettings& settings, ScreenPicture& to)
{
    const Film& film = shot.film;
    to.width = film.width, to.height = film.height;
    const auto width = static_cast<std::size_t>(film.width), height = static_cast<std::size_t>(film.height);
    to.texels.resize(width * height);
    const DisplaySettings shown = shot.is_data ? DisplaySettings{} : settings;
    const Film* under = shot.spp == 0 && shot.under != nullptr ? &shot.under->film : nullptr;
    constexpr std::size_t rows = 32; // a piece of work worth handing to a thread
    parallel_ranges(height, rows, [&](std::size_t begin, std::size_t end) {
        std::vector<vec3> row(width);
        for (std::size_t y = begin; y < end; ++y) {
            const std::size_t first = y * width;
            for (std::size_t x = 0; x < width; ++x) {
                if (under != nullptr && film.sample_count[first + x] == 0)
                    row[x] = enlarged(*under, (static_cast<float>(x) + 0.5f) / static_cast<float>(width),
                                      (static_cast<float>(y) + 0.5f) / static_cast<float>(height));
                else
                    row[x] = mean(film, first + x);
            }
            to_screen(row.data(), width, shown, to.texels.data() + first);
        }
    });
}

} // namespace snell::view
