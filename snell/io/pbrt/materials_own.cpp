// Our own materials: what MaterialDesc has and pbrt has no name for.
#include "snell/io/pbrt/materials.h"
#include "snell/io/pbrt/slots.h"

namespace snell::pbrt {
namespace {

// A parameter and the texture that multiplies it may both be there: "float metallic" and "texture metallic". A texture
// alone carries its own factor.
void read_slot(Making& m, std::string_view name, bool is_color, vec3& factor, TextureRef* ref)
{
    const Parameter* texture = m.parameters.find(name, {Type::texture});
    const Parameter* value = nullptr;
    for (const Parameter& p : m.parameters.all())
        if (p.name == name && p.type != Type::texture) value = &p;
    if (texture != nullptr && ref != nullptr) {
        const auto given = is_color ? color_parameter(m.loader, m.parameters, name, Use::plain)
                                    : number_parameter(m.loader, m.parameters, name);
        // find() meets whichever stands first; a texture must be looked up as one.
        const auto& names = is_color ? m.loader.color_textures : m.loader.number_textures;
        const auto known = texture->strings.empty() ? names.end() : names.find(texture->strings[0]);
        const TextureValue own =
            known != names.end() ? texture_value(m.loader, known->second) : given.value_or(TextureValue{});
        *ref = own.ref;
        factor = own.factor;
    }
    if (value != nullptr) {
        value->used = true;
        if (const auto spectrum = m.loader.spectra.read(*value, *m.loader.state.space, Use::plain)) {
            const vec3 given = plain_rgb(*spectrum);
            factor = texture != nullptr ? factor * given : given;
        }
    }
}

void make_principled(Making& m)
{
    MaterialDesc& d = m.desc();
    d.kind = material_principled;
    d.base_color = vec3(1.0f);
    read_slot(m, "base_color", true, d.base_color, &d.base_texture);
    d.ior = m.index("ior", 1.5f);
    read_slot(m, "absorption", true, d.absorption, nullptr);
    PrincipledDesc& p = d.principled;
    for (const NumberSlot& slot : number_slots) {
        vec3 factor(p.*slot.number);
        read_slot(m, slot.name, false, factor, slot.texture != nullptr ? &(p.*slot.texture) : nullptr);
        p.*slot.number = factor.x;
    }
    for (const ColorSlot& slot : color_slots) read_slot(m, slot.name, true, p.*slot.color, &(p.*slot.texture));
    for (const MapSlot& slot : map_slots) {
        vec3 unused(1.0f);
        read_slot(m, slot.name, false, unused, &(p.*slot.texture));
    }
    p.thin_walled = m.parameters.flag("thin_walled", true);
}

void make_mix(Making& m)
{
    MaterialDesc& d = m.desc();
    d.kind = material_mix;
    set_base(d, m.color("reflectance", vec3(0.5f)));
    d.specular = m.plain_color("specular", vec3(0.0f));
    d.alpha = m.plain_number("alpha", 0.0f);
    d.texture_tints_specular = m.parameters.flag("texture_tints_specular", false);
}

} // namespace

void read_common_parameters(Making& m)
{
    MaterialDesc& d = m.desc();
    read_slot(m, "emission", true, d.emission, &d.emission_texture);
    d.two_sided_emission = m.parameters.flag("two_sided_emission", false);
    d.single_sided = m.parameters.flag("single_sided", false);
    if (m.type != "subsurface" && m.type != "kdsubsurface")
        d.name = m.parameters.text("name", d.name); // theirs: a preset
    vec3 unused(1.0f);
    read_slot(m, "normal", false, unused, &d.normal_texture);
    d.normal_scale = m.parameters.number("normal_scale", 1.0f);
    if (m.type == "uber" || !(m.parameters.has("opacity") || m.parameters.has("coverage"))) return; // v3 has its own
    vec3 opacity(1.0f);
    read_slot(m, "opacity", false, opacity, &d.opacity_texture);
    d.opacity = opacity.x;
    d.cutoff = m.parameters.number("cutoff", 0.5f);
    const std::string coverage = m.parameters.text("coverage", "blend");
    d.coverage = coverage == "mask" ? coverage_mask : coverage == "opaque" ? coverage_opaque : coverage_blend;
}

bool make_own_material(Making& m)
{
    if (m.type == "principled")
        make_principled(m);
    else if (m.type == "diffuse_specular")
        make_mix(m);
    else if (m.type == "unlit") {
        m.desc().kind = material_unlit;
        set_base(m.desc(), m.color("color", vec3(1.0f)));
    } else
        return false;
    return true;
}

} // namespace snell::pbrt
