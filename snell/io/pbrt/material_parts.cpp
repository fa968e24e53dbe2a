// What materials are made of: colours, indices, roughness.
#include "snell/io/pbrt/bake.h"
#include "snell/io/pbrt/materials.h"

#include <algorithm>
#include <cmath>

namespace snell::pbrt {

TextureValue Making::color(std::string_view name, vec3 otherwise)
{
    return color_parameter(loader, parameters, name).value_or(TextureValue{otherwise, {}});
}

TextureValue Making::number(std::string_view name, float otherwise)
{
    return number_parameter(loader, parameters, name).value_or(TextureValue{vec3(otherwise), {}});
}

vec3 Making::plain_color(std::string_view name, vec3 otherwise)
{
    const std::optional<TextureValue> value = color_parameter(loader, parameters, name, Use::plain);
    if (!value) return otherwise;
    if (!value->is_constant())
        warn("textured " + std::string(name), fmt::format("a texture for \"{}\" of {} becomes its mean", name, type));
    return mean_of(loader, *value);
}

float Making::plain_number(std::string_view name, float otherwise)
{
    const std::optional<TextureValue> value = number_parameter(loader, parameters, name);
    if (!value) return otherwise;
    if (!value->is_constant())
        warn("textured " + std::string(name), fmt::format("a texture for \"{}\" of {} becomes its mean", name, type));
    return mean_of(loader, *value).x;
}

void Making::warn(const std::string& key, const std::string& text)
{
    loader.warn(parameters.spot, type + " " + key, text);
}

void Making::inform(const std::string& key, const std::string& text)
{
    loader.inform(parameters.spot, type + " " + key, text);
}

float Making::index(std::string_view name, float otherwise)
{
    const Parameter* p = parameters.find(name);
    if (p == nullptr) return otherwise;
    float eta = otherwise;
    if (p->type == Type::number || p->type == Type::texture || p->type == Type::integer)
        eta = plain_number(name, otherwise);
    else if (const auto spectrum = loader.spectra.read(*p, *loader.state.space, Use::plain)) {
        eta = index_of_refraction(*spectrum);
        if (!p->strings.empty() || p->numbers.size() > 3)
            loader.inform(p->spot, "dispersion", "the index of refraction is taken at 587.6 nm; dispersion is lost");
    }
    if (eta > 0.0f && eta < 100.0f) return eta;
    warn("index", fmt::format("an index of refraction of {} is none; it becomes {}", eta, otherwise));
    return otherwise;
}

Metal Making::metal(const std::string& prefix, std::string_view default_name)
{
    if (parameters.has("reflectance")) {
        // The index that pbrt takes for a reflectance r: eta 1, and the k that reflects r of what comes head-on.
        const vec3 r = clamp(plain_color("reflectance", vec3(0.5f)), 0.0f, 0.9999f);
        return {vec3(1.0f), 2.0f * sqrt(r) / sqrt(max(vec3(1.0f) - r, vec3(0.0f)))};
    }
    const Metal usual = named_metal(default_name);
    const auto read = [&](const std::string& name, vec3 otherwise) {
        Spectrum s;
        s.rgb = otherwise;
        const Parameter* p = parameters.find(prefix + name);
        if (p == nullptr) return s;
        if (p->type == Type::texture)
            s.rgb = plain_color(prefix + name, otherwise);
        else if (const auto given = loader.spectra.read(*p, *loader.state.space, Use::plain))
            s = *given;
        return s;
    };
    return metal_rgb(read("eta", usual.eta), read("k", usual.k));
}

bool Roughness::is_even() const
{
    return std::abs(u - v) <= 1e-3f * std::max(u, v);
}

float Roughness::alpha() const
{
    return std::sqrt(u * v);
}

static float square_root(float x)
{
    return std::sqrt(std::max(x, 0.0f));
}

// How v3 makes an alpha of a roughness between 0 and 1.
static float remap_v3(float roughness)
{
    const float x = std::log(std::max(roughness, 1e-3f));
    return 1.62142f + x * (0.819955f + x * (0.1734f + x * (0.0171201f + x * 0.000640711f)));
}

Roughness read_roughness(Making& making, const std::string& prefix, float otherwise)
{
    Loader& loader = making.loader;
    const bool remaps = making.parameters.flag("remaproughness", true);
    const auto both = number_parameter(loader, making.parameters, prefix + "roughness");
    const auto u = number_parameter(loader, making.parameters, prefix + "uroughness");
    const auto v = number_parameter(loader, making.parameters, prefix + "vroughness");
    const TextureValue usual = both.value_or(TextureValue{vec3(otherwise), {}});
    const TextureValue values[2] = {u.value_or(usual), v.value_or(usual)};
    Roughness result;
    float (*const remap)(float) = !remaps ? nullptr : loader.is_v3 ? remap_v3 : square_root;
    for (int i = 0; i < 2; ++i) {
        float alpha = mean_of(loader, values[i]).x;
        if (remap != nullptr && (alpha > 0.0f || !loader.is_v3)) alpha = remap(alpha);
        if (!(alpha >= 1e-3f)) alpha = 0.0f;
        (i == 0 ? result.u : result.v) = std::min(alpha, 1.0f);
    }
    if (!values[0].is_constant()) result.texture = remap != nullptr ? map_texture(loader, values[0], remap) : values[0];
    return result;
}

TextureValue map_texture(Loader& loader, const TextureValue& value, float (*f)(float))
{
    if (value.is_constant()) return {vec3(f(value.factor.x)), {}};
    TextureValue result;
    result.ref = value.ref;
    Index<Image>& known = loader.mapped_images[{value.ref.image.value, value.factor.x, f}];
    if (known.valid()) {
        result.ref.image = known;
        return result;
    }
    load_image(loader, value.ref.image);
    const Image& source = loader.scene.images[value.ref.image.value];
    Image image;
    image.name = source.name;
    image.width = source.width, image.height = source.height;
    image.format = texels_rgba8_linear;
    TextureRef plain;
    plain.filter = filter_nearest;
    const std::size_t count = std::size_t{image.width} * image.height;
    image.bytes.resize(4 * count);
    const float width = static_cast<float>(image.width), height = static_cast<float>(image.height);
    for (std::size_t i = 0; i < count; ++i) {
        const vec2 uv((static_cast<float>(i % image.width) + 0.5f) / width,
                      1.0f - (static_cast<float>(i / image.width) + 0.5f) / height);
        const float x = clamp(f(look_up(source, plain, uv).x * value.factor.x), 0.0f, 1.0f);
        const auto byte = static_cast<std::uint8_t>(x * 255.0f + 0.5f);
        for (std::size_t c = 0; c < 4; ++c) image.bytes[4 * i + c] = c < 3 ? byte : std::uint8_t{255};
    }
    result.ref.image = known = add(loader.scene, std::move(image));
    loader.images.resize(loader.scene.images.size());
    return result;
}

void set_base(MaterialDesc& desc, const TextureValue& value)
{
    desc.base_color = value.factor;
    desc.base_texture = value.ref;
}

void set_principled_roughness(Making& making, const Roughness& roughness)
{
    PrincipledDesc& p = making.desc().principled;
    p.roughness = std::sqrt(roughness.alpha());
    if (roughness.texture) {
        const TextureValue root = map_texture(making.loader, *roughness.texture, square_root);
        p.roughness = 1.0f;
        p.roughness_texture = root.ref;
    } else if (!roughness.is_even()) {
        // The model takes the smaller alpha, and raises the other one towards 1 by the square of its strength.
        const float small = std::min(roughness.u, roughness.v), large = std::max(roughness.u, roughness.v);
        p.roughness = std::sqrt(small);
        p.anisotropy = std::sqrt((large - small) / (1.0f - small));
        p.anisotropy_rotation = roughness.u > roughness.v ? 0.0f : 1.57079633f;
    }
}

vec3 normal_reflectance(const Metal& m)
{
    const vec3 below = m.eta - vec3(1.0f), above = m.eta + vec3(1.0f);
    return (below * below + m.k * m.k) / (above * above + m.k * m.k);
}

} // namespace snell::pbrt
