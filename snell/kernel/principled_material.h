// A principled material at a hit: its parameters with their textures looked up.
#ifndef SNELL_KERNEL_PRINCIPLED_MATERIAL_H
#define SNELL_KERNEL_PRINCIPLED_MATERIAL_H
#include "snell/kernel/principled.h"
#include "snell/kernel/random.h"
#include "snell/kernel/tangent.h"
SNELL_BEGIN

// The direction and strength of anisotropy: the texture's red and green are a vector as in a normal map, in the frame
// of the tangents; its blue is strength.
SNELL_FN_COLD void look_up_anisotropy(SNELL_IN(SceneView) scene, SNELL_IN(Principled) principled,
                                      SNELL_IN(SurfacePoint) surface, bool mirrored, SNELL_INOUT(PrincipledPoint) p)
{
    vec2 d = vec2(cos(principled.anisotropy_rotation), sin(principled.anisotropy_rotation));
    p.anisotropy = principled.anisotropy;
    if (may_have(feature_textures) && principled.anisotropy_slot != none) {
        vec4 texel = sample_texture(scene, principled.anisotropy_slot, surface.uv, surface.uv_1);
        p.anisotropy = p.anisotropy * texel.z;
        vec2 t = vec2(2.0f * texel.x - 1.0f, 2.0f * texel.y - 1.0f);
        float l2 = t.x * t.x + t.y * t.y;
        if (l2 > 1e-6f) {
            t = t / sqrt(l2);
            d = vec2(d.x * t.x - d.y * t.y, d.y * t.x + d.x * t.y);
        }
    }
    // the frame is right-handed; where the texture is mirrored, its v runs the other way
    p.anisotropy_direction = vec2(d.x, mirrored ? -d.y : d.y);
}

// Everything that resolve_principled needs. frame: around the shading normal, s along the tangents; wo: local.
SNELL_FN_COLD PrincipledPoint principled_point(SNELL_IN(SceneView) scene, SNELL_IN(Material) material,
                                               SNELL_IN(SurfacePoint) surface, SNELL_IN(Hit) hit, vec3 base_color,
                                               SNELL_IN(Frame) frame, vec3 back)
{
    Principled m = scene.principled.at[material.principled];
    PrincipledPoint p = plain_principled_point(0.0f);
    p.base_color = base_color;
    p.metallic = m.metallic * slot_value(scene, m.metallic_slot, surface);
    p.alpha = sqr(m.roughness * slot_value(scene, m.roughness_slot, surface));
    p.ior = material.ior;
    p.specular = m.specular * slot_value(scene, m.specular_slot, surface);
    p.specular_color = m.specular_color * slot_color(scene, m.specular_color_slot, surface);
    p.clearcoat = m.clearcoat * slot_value(scene, m.clearcoat_slot, surface);
    p.clearcoat_alpha = sqr(m.clearcoat_roughness * slot_value(scene, m.clearcoat_roughness_slot, surface));
    p.sheen_color = m.sheen_color * slot_color(scene, m.sheen_color_slot, surface);
    p.sheen_alpha = sqr(m.sheen_roughness * slot_value(scene, m.sheen_roughness_slot, surface));
    p.transmission = m.transmission * slot_value(scene, m.transmission_slot, surface);
    p.thin_walled = m.thin_walled;
    p.glass_table = m.glass_table;
    p.iridescence = m.iridescence * slot_value(scene, m.iridescence_slot, surface);
    p.iridescence_ior = m.iridescence_ior;
    p.iridescence_thickness = mix(m.iridescence_thickness_min, m.iridescence_thickness_max,
                                  slot_value(scene, m.iridescence_thickness_slot, surface));
    p.diffuse_transmission = m.diffuse_transmission * slot_value(scene, m.diffuse_transmission_slot, surface);
    p.diffuse_transmission_color =
        m.diffuse_transmission_color * slot_color(scene, m.diffuse_transmission_color_slot, surface);
    if (may_have(feature_anisotropy) && m.anisotropy > 0.0f) {
        uint uv_set = m.anisotropy_slot != none ? scene.slots.at[m.anisotropy_slot].uv_set : 0u;
        Tangents t = surface_tangents(scene, surface, hit, uv_set);
        look_up_anisotropy(scene, m, surface, dot(cross(frame.n, t.u), t.v) < 0.0f, p);
    }
    if (may_have(feature_clearcoat) && p.clearcoat > 0.0f) {
        // the coat lies on the surface as the mesh has it, not on the base's bumps
        vec3 n = surface.shading_normal;
        if (may_have(feature_textures) && m.clearcoat_normal_slot != none)
            n = mapped_normal(scene, surface, hit, m.clearcoat_normal_slot, m.clearcoat_normal_scale, back);
        vec3 local = to_local(frame, n);
        p.clearcoat_normal = dot(frame.n, back) < 0.0f ? vec3(-local.x, -local.y, local.z) : local;
        if (p.clearcoat_normal.z < 0.0f) p.clearcoat_normal = vec3(0.0f, 0.0f, 1.0f);
    }
    return p;
}

// For dispersion a path carries one of red, green and blue from its first dispersive surface on; the number of the one,
// by chance, each with probability 1/3.
SNELL_FN uint choose_color_channel(uint key_pixel, uint key_reversed_index)
{
    return hash_uint(key_pixel ^ hash_uint(key_reversed_index ^ 0x68e31da4u)) % 3u;
}

SNELL_END
#endif
