// From materials of the file to those of the scene: with the light, the medium and the opacity of a shape.
#include "snell/io/pbrt/materials.h"

#include <cmath>

namespace snell::pbrt {
namespace {

MaterialDesc make_use(Loader& loader, const MaterialEntry& entry, const MaterialUse& use)
{
    MaterialDesc desc = entry.desc;
    if (use.area_light != none && use.keeps_light) {
        const AreaLight& light = loader.area_lights[use.area_light];
        desc.emission = light.radiance * use.light_scale;
        desc.emission_texture = light.image;
        desc.two_sided_emission = light.two_sided;
    }
    if (entry.is_interface) {
        // The border of a medium that only absorbs is a body of glass that does not refract.
        desc.kind = material_dielectric;
        desc.base_color = vec3(1.0f);
        desc.ior = 1.0f;
        desc.alpha = 0.0f;
    }
    if (use.medium != none) {
        const Medium& medium = loader.media[use.medium];
        const bool is_clear = desc.kind == material_dielectric ||
                              (desc.kind == material_principled && desc.principled.transmission > 0.0f);
        if (is_clear) desc.absorption = medium.absorption;
        if (desc.kind == material_principled && is_clear) desc.principled.thin_walled = false;
    }
    if (use.opacity < 1.0f || use.alpha != none) {
        const TextureValue alpha = use.alpha != none ? texture_value(loader, use.alpha) : TextureValue{};
        desc.coverage = coverage_blend;
        desc.opacity = clamp(alpha.factor.x * use.opacity, 0.0f, 1.0f) * entry.desc.opacity;
        if (!alpha.is_constant()) desc.opacity_texture = alpha.ref;
    }
    return desc;
}

bool is_plain(const MaterialDesc& m)
{
    return m.kind == material_diffuse || m.kind == material_principled;
}

MaterialDesc as_principled(MaterialDesc m)
{
    if (m.kind == material_diffuse) {
        m.kind = material_principled;
        m.principled.specular = 0.0f;
        m.principled.roughness = 1.0f;
    }
    return m;
}

} // namespace

std::shared_ptr<MaterialEntry> named_material(Loader& loader, const std::string& name)
{
    std::shared_ptr<MaterialEntry>& entry = loader.materials[name];
    if (!entry) {
        // v4 lets materials be made after their use.
        entry = std::make_shared<MaterialEntry>();
        entry->is_defined = false;
        entry->desc.name = name;
        entry->desc.base_color = vec3(0.5f);
    }
    return entry;
}

Index<MaterialDesc> use_material(Loader& loader, const std::shared_ptr<MaterialEntry>& entry, const MaterialUse& use)
{
    Index<MaterialDesc>& index = entry->uses[use];
    if (!index.valid()) index = add(loader.scene, make_use(loader, *entry, use));
    return index;
}

void update_uses(Loader& loader, MaterialEntry& entry)
{
    for (const auto& [use, index] : entry.uses) loader.scene.materials[index.value] = make_use(loader, entry, use);
}

void mix_materials(Making& m, const MaterialEntry& a, const MaterialEntry& b, const TextureValue& amount)
{
    const std::string name = m.desc().name;
    const float mean = mean_of(m.loader, amount).x;
    if (amount.is_constant() && (mean <= 0.0f || mean >= 1.0f)) {
        const MaterialEntry& one = mean <= 0.0f ? a : b;
        m.entry.desc = one.desc;
        m.entry.is_interface = one.is_interface;
    } else if (a.is_interface != b.is_interface) {
        // Holes: there is as much of the surface as there is of the other material.
        m.entry.desc = a.is_interface ? b.desc : a.desc;
        m.desc().coverage = coverage_blend;
        m.desc().opacity_texture = amount.ref;
        m.desc().opacity = a.is_interface ? amount.factor.x : 1.0f - amount.factor.x;
        if (b.is_interface && !amount.is_constant()) {
            const TextureValue rest = map_texture(m.loader, amount, [](float x) { return 1.0f - x; });
            m.desc().opacity_texture = rest.ref;
            m.desc().opacity = 1.0f;
        }
    } else if (a.desc.kind == material_diffuse && b.desc.kind == material_diffuse) {
        TextureNode mixed;
        mixed.kind = TextureNode::Kind::mix;
        mixed.spot = m.parameters.spot;
        const TextureValue values[3] = {
            {a.desc.base_color, a.desc.base_texture}, {b.desc.base_color, b.desc.base_texture}, amount};
        for (std::size_t i = 0; i < 3; ++i) {
            TextureNode part;
            part.value = values[i];
            m.loader.textures.push_back(part);
            mixed.input[i] = static_cast<uint>(m.loader.textures.size() - 1);
            mixed.cost += 1;
        }
        m.entry.desc = a.desc;
        if (values[0].is_constant() && values[1].is_constant() && amount.is_constant()) {
            m.desc().base_color = mix(values[0].factor, values[1].factor, mean);
        } else {
            m.loader.textures.push_back(mixed);
            set_base(m.desc(), texture_value(m.loader, static_cast<uint>(m.loader.textures.size() - 1)));
        }
    } else if (amount.is_constant() && is_plain(a.desc) && is_plain(b.desc) && !a.desc.base_texture.valid() &&
               !b.desc.base_texture.valid()) {
        const MaterialDesc x = as_principled(a.desc), y = as_principled(b.desc);
        m.entry.desc = mean < 0.5f ? x : y;
        MaterialDesc& d = m.desc();
        d.base_color = mix(x.base_color, y.base_color, mean);
        d.ior = mix(x.ior, y.ior, mean);
        PrincipledDesc& p = d.principled;
        const PrincipledDesc &px = x.principled, &py = y.principled;
        p.metallic = mix(px.metallic, py.metallic, mean);
        p.roughness = mix(px.roughness, py.roughness, mean);
        p.specular = mix(px.specular, py.specular, mean);
        p.specular_color = mix(px.specular_color, py.specular_color, mean);
        p.clearcoat = mix(px.clearcoat, py.clearcoat, mean);
        p.transmission = mix(px.transmission, py.transmission, mean);
        p.diffuse_transmission = mix(px.diffuse_transmission, py.diffuse_transmission, mean);
        m.inform("parts", "a mix of two materials becomes one principled surface between them");
    } else {
        const MaterialEntry& one = mean < 0.5f ? a : b;
        m.entry.desc = one.desc;
        m.entry.is_interface = one.is_interface;
        m.warn("parts", fmt::format("a mix of such different materials becomes the stronger one, '{}'",
                                    one.desc.name.substr(0, 60)));
    }
    m.desc().name = name;
}

void add_medium(Loader& loader, const std::string& name, const ParameterList& parameters)
{
    const std::string type = parameters.text("type", "homogeneous");
    Medium medium;
    medium.name = name;
    const auto coefficient = [&](std::string_view parameter, vec3 otherwise) {
        const Parameter* p = parameters.find(parameter);
        if (p == nullptr) return otherwise;
        const auto spectrum = loader.spectra.read(*p, *loader.state.space, Use::plain);
        return spectrum ? max(plain_rgb(*spectrum), vec3(0.0f)) : otherwise;
    };
    const float scale = parameters.number("scale", 1.0f);
    const std::string preset = parameters.text("preset");
    // pbrt's defaults
    medium.absorption = scale * coefficient("sigma_a", vec3(0.0011f, 0.0024f, 0.014f));
    const vec3 scattering = coefficient("sigma_s", vec3(2.55f, 3.21f, 3.77f));
    medium.scatters =
        type != "homogeneous" || !preset.empty() || max(scattering.x, max(scattering.y, scattering.z)) > 0.0f;
    if (type != "homogeneous") {
        medium.absorption = vec3(0.0f);
        loader.warn(parameters.spot, "medium type " + type,
                    fmt::format("media of type {} are left out", type.substr(0, 40)));
    }
    for (const Parameter& parameter : parameters.all()) parameter.used = true;
    loader.media.push_back(medium);
    loader.medium_names[name] = static_cast<uint>(loader.media.size() - 1);
}

} // namespace snell::pbrt
