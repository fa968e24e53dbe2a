#include "snell/io/pbrt/bake.h"

#include "snell/core/parallel.h"
#include "snell/kernel/tone.h"

#include <algorithm>
#include <cmath>

namespace snell::pbrt {
namespace {

using Kind = TextureNode::Kind;

vec2 mapped(const TextureNode& node, vec2 uv)
{
    const vec3 p(uv.x, uv.y, 1.0f);
    return {dot(node.row_u, p), dot(node.row_v, p)};
}

bool is_constant(const TextureNode& node)
{
    return node.kind == Kind::value && node.value.is_constant();
}

float srgb_byte(std::uint8_t byte)
{
    static const std::array<float, 256> table = [] {
        std::array<float, 256> t{};
        for (std::size_t i = 0; i < 256; ++i) t[i] = srgb_decode(static_cast<float>(i) / 255.0f);
        return t;
    }();
    return table[byte];
}

vec4 texel(const Image& image, std::size_t x, std::size_t y)
{
    const std::size_t at = 4 * (y * image.width + x);
    if (image.format == texels_rgba32f)
        return {image.floats[at], image.floats[at + 1], image.floats[at + 2], image.floats[at + 3]};
    vec4 value;
    for (int c = 0; c < 4; ++c) {
        const std::uint8_t byte = image.bytes[at + static_cast<std::size_t>(c)];
        const bool is_curved = image.format == texels_rgba8_srgb && c < 3;
        value[c] = is_curved ? srgb_byte(byte) : static_cast<float>(byte) / 255.0f;
    }
    return value;
}

std::size_t wrapped(float cell, uint size, uint wrap)
{
    if (!(std::abs(cell) < 1e9f)) return 0;
    long long i = static_cast<long long>(cell);
    const long long n = size;
    if (wrap == wrap_clamp) return static_cast<std::size_t>(std::clamp(i, 0ll, n - 1));
    if (wrap == wrap_mirror) {
        i = ((i % (2 * n)) + 2 * n) % (2 * n);
        return static_cast<std::size_t>(i < n ? i : 2 * n - 1 - i);
    }
    return static_cast<std::size_t>(((i % n) + n) % n);
}

// What a texture's picture has for each side of the unit square.
uint texels_wanted(Loader& loader, uint texture)
{
    const TextureNode& node = loader.textures[texture];
    const auto repeats = [](vec3 row) { return std::max({std::abs(row.x), std::abs(row.y), 1e-3f}); };
    float wanted = 64.0f;
    if (node.kind == Kind::value) {
        if (node.value.is_constant()) return 1;
        const TextureRef& ref = node.value.ref;
        load_image(loader, ref.image);
        const Image& image = loader.scene.images[ref.image.value];
        wanted =
            static_cast<float>(std::max(image.width, image.height)) * std::max(repeats(ref.row_u), repeats(ref.row_v));
    } else if (node.kind == Kind::checkerboard) {
        wanted = 32.0f * std::max(repeats(node.row_u), repeats(node.row_v));
    }
    uint most = static_cast<uint>(std::clamp(wanted, 64.0f, 1024.0f));
    if (node.kind != Kind::value)
        for (const uint input : node.input)
            if (input != none) most = std::max(most, texels_wanted(loader, input));
    return std::min(most, 1024u);
}

TextureValue picture(Loader& loader, std::vector<vec3> texels, uint size, uint filter, const std::string& name)
{
    float most = 0.0f;
    for (vec3& t : texels) {
        for (int c = 0; c < 3; ++c) t[c] = std::isfinite(t[c]) ? std::max(t[c], 0.0f) : 0.0f;
        most = std::max({most, t.x, t.y, t.z});
    }
    // Texels are in [0, 1]; what is more goes into the factor.
    const float factor = most > 1.0f ? most : 1.0f;
    Image image;
    image.name = name;
    image.width = image.height = size;
    const bool is_small = texels.size() <= 4;
    image.format = is_small ? texels_rgba32f : texels_rgba8_srgb;
    for (const vec3 t : texels) {
        for (int c = 0; c < 3; ++c) {
            const float value = t[c] / factor;
            if (is_small)
                image.floats.push_back(value);
            else
                image.bytes.push_back(static_cast<std::uint8_t>(srgb_encode(value) * 255.0f + 0.5f));
        }
        if (is_small)
            image.floats.push_back(1.0f);
        else
            image.bytes.push_back(255);
    }
    TextureValue value;
    value.factor = vec3(factor);
    value.ref.image = add(loader.scene, std::move(image));
    value.ref.filter = filter;
    loader.images.resize(loader.scene.images.size());
    return value;
}

TextureValue bake_checks(Loader& loader, const TextureNode& node)
{
    const vec3 a = loader.textures[node.input[0]].value.factor, b = loader.textures[node.input[1]].value.factor;
    // Two checks a side; the row at the top has the larger v.
    TextureValue value = picture(loader, {b, a, a, b}, 2, filter_nearest, "checkerboard");
    value.ref.row_u = 0.5f * node.row_u, value.ref.row_v = 0.5f * node.row_v;
    return value;
}

} // namespace

vec4 look_up(const Image& image, const TextureRef& ref, vec2 uv)
{
    const vec3 p(uv.x, uv.y, 1.0f);
    const float x = dot(ref.row_u, p) * static_cast<float>(image.width);
    const float y = (1.0f - dot(ref.row_v, p)) * static_cast<float>(image.height);
    const auto at = [&](float cx, float cy) {
        return texel(image, wrapped(cx, image.width, ref.wrap_u), wrapped(cy, image.height, ref.wrap_v));
    };
    if (ref.filter == filter_nearest) return at(std::floor(x), std::floor(y));
    const float x0 = std::floor(x - 0.5f), y0 = std::floor(y - 0.5f), tx = x - 0.5f - x0, ty = y - 0.5f - y0;
    const vec4 top = at(x0, y0) * (1.0f - tx) + at(x0 + 1.0f, y0) * tx;
    const vec4 bottom = at(x0, y0 + 1.0f) * (1.0f - tx) + at(x0 + 1.0f, y0 + 1.0f) * tx;
    return top * (1.0f - ty) + bottom * ty;
}

vec3 evaluate(Loader& loader, uint texture, vec2 uv)
{
    const TextureNode& node = loader.textures[texture];
    if (node.kind == Kind::value || node.is_baked) {
        if (node.value.is_constant()) return node.value.factor;
        const vec4 t = look_up(loader.scene.images[node.value.ref.image.value], node.value.ref, uv);
        return node.value.factor * vec3(t.x, t.y, t.z);
    }
    if (node.kind == Kind::scale) return evaluate(loader, node.input[0], uv) * evaluate(loader, node.input[1], uv);
    if (node.kind == Kind::mix) {
        const float amount = evaluate(loader, node.input[2], uv).x;
        return mix(evaluate(loader, node.input[0], uv), evaluate(loader, node.input[1], uv), amount);
    }
    const vec2 st = mapped(node, uv);
    if (node.kind == Kind::checkerboard) {
        const float cells = std::floor(st.x) + std::floor(st.y);
        const bool is_even = std::floor(0.5f * cells) * 2.0f == cells;
        return evaluate(loader, node.input[is_even ? 0 : 1], uv);
    }
    const vec2 t = clamp(st, 0.0f, 1.0f);
    return mix(mix(node.corners[0], node.corners[2], t.x), mix(node.corners[1], node.corners[3], t.x), t.y);
}

TextureValue bake(Loader& loader, uint texture)
{
    const TextureNode& node = loader.textures[texture];
    if (node.kind == Kind::checkerboard && is_constant(loader.textures[node.input[0]]) &&
        is_constant(loader.textures[node.input[1]]))
        return bake_checks(loader, node);

    uint size = texels_wanted(loader, texture); // loads the pictures, too
    const std::size_t count = std::size_t{size} * size;
    const std::size_t look_ups = count * node.cost;
    if (look_ups > loader.texels_left) {
        loader.warn(node.spot, "too many texels",
                    "so many textures of textures are computed already; this and later ones become their mean");
        vec3 sum(0.0f);
        for (int i = 0; i < 64; ++i)
            sum += evaluate(loader, texture,
                            {(static_cast<float>(i % 8) + 0.5f) / 8, (static_cast<float>(i / 8) + 0.5f) / 8});
        return {sum / 64.0f, {}};
    }
    loader.texels_left -= look_ups;
    std::vector<vec3> texels(count);
    parallel_ranges(size, 16, [&](std::size_t begin, std::size_t end) {
        for (std::size_t y = begin; y < end; ++y)
            for (std::size_t x = 0; x < size; ++x) {
                const float s = static_cast<float>(size);
                texels[y * size + x] = evaluate(
                    loader, texture, {(static_cast<float>(x) + 0.5f) / s, 1.0f - (static_cast<float>(y) + 0.5f) / s});
            }
    });
    return picture(loader, std::move(texels), size, filter_bilinear, fmt::format("texture {}", node.spot.line));
}

} // namespace snell::pbrt
