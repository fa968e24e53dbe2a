// Once a vertex: what each lobe of a principled surface weighs for light that goes to wo.
#ifndef SNELL_KERNEL_PRINCIPLED_RESOLVE_H
#define SNELL_KERNEL_PRINCIPLED_RESOLVE_H
#include "snell/kernel/principled_point.h"
SNELL_BEGIN

// The layers on top; w is wo on the upper side. Returns what they leave for the base, in [0, 1].
SNELL_FN_COLD float resolve_coats(FloatArray albedo, SNELL_INOUT(PrincipledPoint) p, vec3 w)
{
    float below = 1.0f;
    float clearcoat = clamp(p.clearcoat, 0.0f, 1.0f);
    if (may_have(feature_clearcoat) && clearcoat > 0.0f) {
        if (dot(p.clearcoat_normal, w) <= 0.0f) p.clearcoat_normal = vec3(0.0f, 0.0f, 1.0f);
        p.clearcoat_alpha = clamp(p.clearcoat_alpha, 0.0f, 1.0f);
        if (p.clearcoat_alpha < principled_smooth_alpha) p.clearcoat_alpha = 0.0f;
        vec2 e = ggx_albedo(albedo, dot(p.clearcoat_normal, w), p.clearcoat_alpha);
        p.coat = clearcoat;
        p.p_coat = clearcoat * (clearcoat_f0 * e.x + (1.0f - clearcoat_f0) * e.y);
        p.albedo += p.p_coat;
        below -= p.p_coat;
    }
    vec3 color = clamp(p.sheen_color, 0.0f, 1.0f);
    if (may_have(feature_sheen) && max3(color) > 0.0f) {
        p.sheen_alpha = clamp(p.sheen_alpha, sheen_alpha_min, 1.0f);
        float e = sheen_albedo(albedo, w.z, p.sheen_alpha);
        p.sheen = color * (e > 1.0f ? below / e : below);
        vec3 seen = color * (min(e, 1.0f) * below);
        p.p_sheen = mean3(seen);
        p.albedo += seen;
        below *= 1.0f - max3(color) * min(e, 1.0f);
    }
    return below;
}

// What single scattering lets leave rough solid glass without tint.
SNELL_FN_COLD vec3 glass_albedo(FloatArray albedo, SNELL_IN(PrincipledPoint) p, float cos_o, float alpha, vec3 f0,
                                float f90)
{
    uint table = p.glass_table + (p.eta < 1.0f ? glass_dense_side : glass_thin_side);
    float whole = look_up_rough_albedo(albedo, albedo_ggx, cos_o, alpha);
    vec3 leaves = (1.0f - f0) * look_up_rough_albedo(albedo, table, cos_o, alpha) + f0 * whole;
    if (f90 < 1.0f)
        leaves += (f90 - 1.0f) * look_up_rough_albedo(albedo, p.glass_table + glass_thin_side_edge, cos_o, alpha);
    return leaves;
}

// The glass; weight: its share. e: ggx_albedo for wo. Its albedo goes to p_facets or p_straight.
SNELL_FN_COLD void resolve_glass(FloatArray albedo, SNELL_INOUT(PrincipledPoint) p, vec3 w, bool solid, float weight,
                                 vec3 dielectric_f0, vec3 schlick_f0, vec2 e)
{
    float f90 = clamp(p.specular, 0.0f, 1.0f);
    vec3 f0 = schlick_f0;
    float whole = e.x; // of thin glass: what is not reflected goes the same way below the surface
    vec3 gain = vec3(1.0f / whole);
    float edge = schlick_weight(w.z);
    if (solid) {
        if (abs(p.eta - 1.0f) < principled_straight_eta) {
            p.eta = 1.0f;
            p.straight = weight * p.base_color;
            p.albedo += p.straight;
            p.p_straight = mean3(p.straight);
            return;
        }
        DielectricSplit split = split_dielectric(w.z, p.eta);
        edge = glass_edge(split);
        // from inside there is total reflection, which leaves no room for a weaker specular
        if (p.eta < 1.0f) f90 = 1.0f;
        f0 = dielectric_f0;
        if (may_have(feature_iridescence) && p.iridescence > 0.0f && split.reflectance < 1.0f) {
            vec3 film = film_reflectance(p.eta < 1.0f ? split.cos_t : w.z, p.iridescence_ior, p.iridescence_thickness,
                                         dielectric_f0);
            f0 = mix(f0, f0_behind(film, f90, edge), min(p.iridescence, 1.0f));
        }
        gain = vec3(1.0f);
        if (p.alphas.y > 0.0f && p.glass_table != none) {
            vec3 leaves = glass_albedo(albedo, p, w.z, p.alphas.y, f0, f90);
            // of anisotropic glass the albedo is only guessed, and rather too dark than too bright
            if (may_have(feature_anisotropy) && p.alphas.x > p.alphas.y)
                leaves = 1.03f * max(leaves, glass_albedo(albedo, p, w.z, p.alphas.x, f0, f90));
            gain = glass_gain_margin / clamp(leaves, 0.1f, 1.0f);
        }
    }
    p.glass_f0 = f0;
    p.glass_f90 = f90;
    p.glass_weight = weight * gain;
    vec3 f = f0 + (f90 - f0) * edge;
    vec3 seen = weight * (f + (1.0f - f) * p.base_color);
    p.albedo += seen;
    p.p_facets += mean3(seen);
}

// `albedo` are the tables of albedo.h. The result serves this wo only; wo.z != 0. A resolved point
// may be given again, with other parameters.
SNELL_FN_COLD PrincipledPoint resolve_principled(FloatArray albedo, SNELL_IN(PrincipledPoint) point, vec3 wo)
{
    PrincipledPoint p = point;
    clear_principled(p);
    vec3 w = vec3(wo.x, wo.y, abs(wo.z));
    p.base_color = clamp(p.base_color, 0.0f, 1.0f);
    float metallic = clamp(p.metallic, 0.0f, 1.0f);
    float transmission = p.ior < 0.05f ? 0.0f : clamp(p.transmission, 0.0f, 1.0f);
    bool solid = transmission > 0.0f && p.thin_walled == 0u && metallic < 1.0f;
    float ior = clamp(p.ior, 0.05f, 20.0f);
    if (solid) p.eta = wo.z > 0.0f ? ior : 1.0f / ior;

    // from within a solid the layers outside it are not looked at
    float below = 1.0f;
    if (!solid || wo.z > 0.0f) below = resolve_coats(albedo, p, w);

    if (p.anisotropy <= 0.0f) p.anisotropy_direction = vec2(1.0f, 0.0f);
    p.alphas = principled_alphas(p.alpha, p.anisotropy);
    vec2 e;
    if (may_have(feature_anisotropy) && p.alphas.x > p.alphas.y)
        e = anisotropic_albedo(albedo, to_facet_frame(p, w), p.alphas, min(p.anisotropy, 1.0f));
    else
        e = ggx_albedo(albedo, w.z, p.alphas.x);
    float edge = schlick_weight(w.z);

    if (metallic > 0.0f) {
        vec3 f0 = p.base_color;
        if (may_have(feature_iridescence) && p.iridescence > 0.0f) {
            vec3 film = film_reflectance(min(w.z, 1.0f), p.iridescence_ior, p.iridescence_thickness, f0);
            f0 = mix(f0, f0_behind(film, 1.0f, edge), min(p.iridescence, 1.0f));
        }
        vec3 weight = (below * metallic) * scattering_gain(f0, e.x);
        p.reflected_f0 = weight * f0;
        p.reflected_edge = weight * (1.0f - f0);
        vec3 seen = p.reflected_f0 * e.x + p.reflected_edge * e.y;
        p.albedo += seen;
        p.p_facets = mean3(seen);
    }
    if (metallic < 1.0f) {
        float f90 = clamp(p.specular, 0.0f, 1.0f);
        vec3 plain_f0 = min(f0_of_ior(max(p.ior, 0.0f)) * max(p.specular_color, 0.0f), 1.0f) * f90;
        vec3 f0 = plain_f0;
        if (may_have(feature_iridescence) && p.iridescence > 0.0f && (!solid || transmission < 1.0f)) {
            vec3 film = film_reflectance(min(w.z, 1.0f), p.iridescence_ior, p.iridescence_thickness, f0);
            f0 = mix(f0, f0_behind(film, f90, edge), min(p.iridescence, 1.0f));
        }
        float weight = below * (1.0f - metallic);
        if (may_have(feature_glass) && transmission > 0.0f)
            resolve_glass(albedo, p, w, solid, weight * transmission, plain_f0, f0, e);
        weight *= 1.0f - transmission;
        if (weight > 0.0f) {
            vec3 gain = weight * scattering_gain(f0, e.x);
            p.reflected_f0 += gain * f0;
            p.reflected_edge += gain * (f90 - f0);
            vec3 seen = gain * (f0 * e.x + (f90 - f0) * e.y);
            p.p_facets += mean3(seen);
            weight = max(weight - max3(seen), 0.0f);
            float through = clamp(p.diffuse_transmission, 0.0f, 1.0f);
            p.diffuse = weight * (1.0f - through) * p.base_color;
            p.diffuse_through = weight * through * clamp(p.diffuse_transmission_color, 0.0f, 1.0f);
            p.p_diffuse = mean3(p.diffuse);
            p.p_through = mean3(p.diffuse_through);
            p.albedo += seen + p.diffuse + p.diffuse_through;
        }
    }
    p.albedo = clamp(p.albedo, 0.0f, 1.0f);
    float total = p.p_coat + p.p_sheen + p.p_facets + p.p_straight + p.p_diffuse + p.p_through;
    float scale = total > 0.0f ? 1.0f / total : 0.0f;
    p.p_coat *= scale;
    p.p_sheen *= scale;
    p.p_facets *= scale;
    p.p_straight *= scale;
    p.p_diffuse *= scale;
    p.p_through *= scale;
    return p;
}

SNELL_END
#endif
