// The parameters of Material "principled" by name, for the reader and the writer.
#pragma once

#include "snell/scene/scene.h"

#include <string_view>

namespace snell::pbrt {

struct NumberSlot
{
    std::string_view name;
    float PrincipledDesc::*number;
    TextureRef PrincipledDesc::*texture; // or null
};
inline constexpr NumberSlot number_slots[] = {
    {"metallic", &PrincipledDesc::metallic, &PrincipledDesc::metallic_texture},
    {"roughness", &PrincipledDesc::roughness, &PrincipledDesc::roughness_texture},
    {"specular", &PrincipledDesc::specular, &PrincipledDesc::specular_texture},
    {"clearcoat", &PrincipledDesc::clearcoat, &PrincipledDesc::clearcoat_texture},
    {"clearcoat_roughness", &PrincipledDesc::clearcoat_roughness, &PrincipledDesc::clearcoat_roughness_texture},
    {"clearcoat_normal_scale", &PrincipledDesc::clearcoat_normal_scale, nullptr},
    {"sheen_roughness", &PrincipledDesc::sheen_roughness, &PrincipledDesc::sheen_roughness_texture},
    {"transmission", &PrincipledDesc::transmission, &PrincipledDesc::transmission_texture},
    {"anisotropy", &PrincipledDesc::anisotropy, nullptr},
    {"anisotropy_rotation", &PrincipledDesc::anisotropy_rotation, nullptr},
    {"iridescence", &PrincipledDesc::iridescence, &PrincipledDesc::iridescence_texture},
    {"iridescence_ior", &PrincipledDesc::iridescence_ior, nullptr},
    {"iridescence_thickness_min", &PrincipledDesc::iridescence_thickness_min, nullptr},
    {"iridescence_thickness_max", &PrincipledDesc::iridescence_thickness_max, nullptr},
    {"dispersion", &PrincipledDesc::dispersion, nullptr},
    {"diffuse_transmission", &PrincipledDesc::diffuse_transmission, &PrincipledDesc::diffuse_transmission_texture}};

struct ColorSlot
{
    std::string_view name;
    vec3 PrincipledDesc::*color;
    TextureRef PrincipledDesc::*texture;
};
inline constexpr ColorSlot color_slots[] = {
    {"specular_color", &PrincipledDesc::specular_color, &PrincipledDesc::specular_color_texture},
    {"sheen_color", &PrincipledDesc::sheen_color, &PrincipledDesc::sheen_color_texture},
    {"diffuse_transmission_color", &PrincipledDesc::diffuse_transmission_color,
     &PrincipledDesc::diffuse_transmission_color_texture}};

// Textures that multiply nothing.
struct MapSlot
{
    std::string_view name;
    TextureRef PrincipledDesc::*texture;
};
inline constexpr MapSlot map_slots[] = {{"clearcoat_normal", &PrincipledDesc::clearcoat_normal_texture},
                                        {"anisotropy_direction", &PrincipledDesc::anisotropy_texture},
                                        {"iridescence_thickness", &PrincipledDesc::iridescence_thickness_texture}};

// Calls visit(texture) for each texture that the material's kind looks at.
template <class Visit>
void for_each_texture(const MaterialDesc& m, const Visit& visit)
{
    for (const TextureRef* ref : {&m.base_texture, &m.emission_texture, &m.normal_texture, &m.opacity_texture})
        if (ref->valid()) visit(*ref);
    if (m.kind != material_principled) return;
    const auto of = [&](TextureRef PrincipledDesc::*texture) {
        if (texture != nullptr && (m.principled.*texture).valid()) visit(m.principled.*texture);
    };
    for (const NumberSlot& slot : number_slots) of(slot.texture);
    for (const ColorSlot& slot : color_slots) of(slot.texture);
    for (const MapSlot& slot : map_slots) of(slot.texture);
}

} // namespace snell::pbrt
