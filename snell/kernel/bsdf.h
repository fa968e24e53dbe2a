// Scattering at a surface point. Directions are local (shading normal = +Z, outward), unit length, and point away from
// the surface; wo is where the light goes (to the camera), wi where it comes from.
//
//   eval_bsdf    BSDF times |cos(wi)|, for radiance; 0 for the delta parts
//   pdf_bsdf     density per steradian with which sample_bsdf draws wi; 0 for the delta parts
//   sample_bsdf  draws wi; `weight` is eval / pdf of what was drawn
#ifndef SNELL_KERNEL_BSDF_H
#define SNELL_KERNEL_BSDF_H
#include "snell/kernel/bsdf_sample.h"
#include "snell/kernel/features.h"
#include "snell/kernel/fresnel.h"
#include "snell/kernel/microfacet.h"
#include "snell/kernel/principled.h"
#include "snell/kernel/scene_view.h"
SNELL_BEGIN

// A material with its textures looked up.
struct MaterialPoint
{
    vec3 base_color;
    uint kind;     // material_*
    vec3 specular; // mix: specular reflectance; conductor: eta
    float alpha;   // GGX roughness, 0: smooth; always 0 for a dielectric with an ior of 1 (within 1e-3)
    vec3 k;        // conductor: k; dielectric: absorption
    float ior;
    PrincipledPoint principled; // for material_principled, resolved for wo; else not set
};

// --- Lambert: reflects on the side that wo is on -------------------------------------------------------------------

SNELL_FN vec3 eval_lambert(vec3 albedo, vec3 wo, vec3 wi)
{
    return wo.z * wi.z > 0.0f ? albedo * (inv_pi * abs(wi.z)) : vec3(0.0f);
}

SNELL_FN float pdf_lambert(vec3 wo, vec3 wi)
{
    return wo.z * wi.z > 0.0f ? inv_pi * abs(wi.z) : 0.0f;
}

SNELL_FN BsdfSample sample_lambert(vec3 albedo, vec3 wo, vec2 u)
{
    BsdfSample s = no_bsdf_sample();
    vec3 w = sample_cosine_hemisphere(u);
    s.wi = wo.z < 0.0f ? vec3(w.x, w.y, -w.z) : w;
    s.pdf = w.z * inv_pi;
    s.weight = albedo;
    return s;
}

// --- GGX reflection, the geometric part: what is left of the BSDF * |cos| without Fresnel's factor -------------------
// Both sides reflect. alpha > 0.

SNELL_FN float eval_ggx_reflection(float alpha, vec3 wo, vec3 wi)
{
    if (wo.z * wi.z <= 0.0f) return 0.0f;
    vec3 m = normalize(wo.z > 0.0f ? wo + wi : -(wo + wi));
    return ggx_d(m, alpha) * ggx_g2(wo.z, wi.z, alpha) / (4.0f * abs(wo.z));
}

SNELL_FN float pdf_ggx_reflection(float alpha, vec3 wo, vec3 wi)
{
    if (wo.z * wi.z <= 0.0f) return 0.0f;
    vec3 w = wo.z > 0.0f ? wo : -wo;
    vec3 m = normalize(wo.z > 0.0f ? wo + wi : -(wo + wi));
    return pdf_ggx_visible(w, m, alpha) / max(4.0f * dot(w, m), 1e-20f);
}

// Draws wi alone; a z on the other side of wo's means no sample.
SNELL_FN vec3 sample_ggx_reflection(float alpha, vec3 wo, vec2 u)
{
    vec3 w = wo.z > 0.0f ? wo : -wo;
    vec3 m = sample_ggx_visible(w, alpha, u);
    vec3 r = 2.0f * dot(w, m) * m - w;
    return wo.z > 0.0f ? r : -r;
}

// --- Dielectric --------------------------------------------------------------------------------------------------
// base_color tints what passes through. Smooth: two delta parts, chosen by Fresnel's reflectance. Rough: Walter et al.
// 2007. Radiance is scaled by 1 / eta^2 on refraction (Veach 1997, 5.2).

SNELL_FN BsdfSample sample_smooth_dielectric(SNELL_IN(MaterialPoint) m, vec3 wo, float u)
{
    BsdfSample s = no_bsdf_sample();
    DielectricSplit split = split_dielectric(wo.z, m.ior);
    s.is_delta = 1u;
    if (u < split.reflectance) {
        s.wi = vec3(-wo.x, -wo.y, wo.z);
        s.weight = vec3(1.0f);
        s.pdf = split.reflectance;
        return s;
    }
    s.wi = refract_direction(wo, vec3(0.0f, 0.0f, 1.0f), split);
    s.weight = m.base_color / (split.eta * split.eta);
    s.pdf = 1.0f - split.reflectance;
    s.eta = split.eta;
    return s;
}

SNELL_FN vec3 eval_rough_dielectric(SNELL_IN(MaterialPoint) m, vec3 wo, vec3 wi)
{
    float eta = wo.z > 0.0f ? m.ior : 1.0f / m.ior;
    vec3 h = dielectric_half_vector(wo, wi, eta);
    if (h.z == 0.0f) return vec3(0.0f);
    float o = dot(wo, h);
    float i = dot(wi, h);
    float reflectance = split_dielectric(o, m.ior).reflectance;
    float dg = ggx_d(h, m.alpha) * ggx_g2(wo.z, wi.z, m.alpha);
    if (wo.z * wi.z > 0.0f) return vec3(reflectance * dg / (4.0f * abs(wo.z)));
    float denominator = sqr(i + o / eta);
    return m.base_color * ((1.0f - reflectance) * dg * abs(i * o / (wo.z * denominator)) / (eta * eta));
}

SNELL_FN float pdf_rough_dielectric(SNELL_IN(MaterialPoint) m, vec3 wo, vec3 wi)
{
    float eta = wo.z > 0.0f ? m.ior : 1.0f / m.ior;
    vec3 h = dielectric_half_vector(wo, wi, eta);
    if (h.z == 0.0f) return 0.0f;
    float o = dot(wo, h);
    float i = dot(wi, h);
    float reflectance = split_dielectric(o, m.ior).reflectance;
    // density of visible normals, as pdf_ggx_visible, for wo on either side
    float visible = ggx_g1(wo.z, m.alpha) * abs(o) * ggx_d(h, m.alpha) / abs(wo.z);
    if (wo.z * wi.z > 0.0f) return reflectance * visible / (4.0f * abs(o));
    return (1.0f - reflectance) * visible * abs(i) / sqr(i + o / eta);
}

SNELL_FN BsdfSample sample_rough_dielectric(SNELL_IN(MaterialPoint) m, vec3 wo, vec2 u, float u_lobe)
{
    BsdfSample s = no_bsdf_sample();
    if (wo.z == 0.0f) return s;
    vec3 w = wo.z > 0.0f ? wo : vec3(wo.x, wo.y, -wo.z);
    vec3 h = sample_ggx_visible(w, m.alpha, u);
    if (wo.z < 0.0f) h = vec3(-h.x, -h.y, h.z); // facet normal on the side of +Z that is visible from below
    DielectricSplit split = split_dielectric(dot(wo, h), m.ior);
    if (u_lobe < split.reflectance) {
        s.wi = 2.0f * dot(wo, h) * h - wo;
        if (s.wi.z * wo.z <= 0.0f) return s;
    } else {
        s.wi = refract_direction(wo, h, split);
        if (s.wi.z * wo.z >= 0.0f) return s;
        s.eta = split.eta;
    }
    s.pdf = pdf_rough_dielectric(m, wo, s.wi);
    if (s.pdf > 0.0f) s.weight = eval_rough_dielectric(m, wo, s.wi) / s.pdf;
    return s;
}

// --- All materials -------------------------------------------------------------------------------------------------

// Probability of drawing the specular part of a mix.
SNELL_FN float mix_specular_probability(SNELL_IN(MaterialPoint) m)
{
    float s = luminance(m.specular);
    float d = luminance(m.base_color);
    return s + d > 0.0f ? s / (s + d) : 0.0f;
}

// True if eval_bsdf can be other than 0: there is a part that light sampling can serve.
SNELL_FN bool has_smooth_part(SNELL_IN(MaterialPoint) m)
{
    if (is_material(m.kind, material_principled)) return principled_has_smooth_part(m.principled);
    return m.kind == material_diffuse || is_material(m.kind, material_mix) ||
           ((is_material(m.kind, material_dielectric) || is_material(m.kind, material_conductor)) && m.alpha > 0.0f);
}

SNELL_FN vec3 eval_bsdf(SNELL_IN(MaterialPoint) m, vec3 wo, vec3 wi)
{
    if (m.kind == material_diffuse) return eval_lambert(m.base_color, wo, wi);
    if (is_material(m.kind, material_mix)) {
        vec3 f = eval_lambert(m.base_color, wo, wi);
        if (m.alpha > 0.0f) f += m.specular * eval_ggx_reflection(m.alpha, wo, wi);
        return f;
    }
    if (is_material(m.kind, material_principled)) { // a copy, so that the rest of m may stay in registers
        PrincipledPoint p = m.principled;
        return eval_principled(p, wo, wi);
    }
    if (m.alpha > 0.0f && is_material(m.kind, material_dielectric)) return eval_rough_dielectric(m, wo, wi);
    if (m.alpha > 0.0f && is_material(m.kind, material_conductor) && wo.z * wi.z > 0.0f) {
        float cos_h = dot(wo, normalize(wo + wi));
        return fresnel_conductor(clamp(cos_h, 0.0f, 1.0f), m.specular, m.k) * eval_ggx_reflection(m.alpha, wo, wi);
    }
    return vec3(0.0f);
}

SNELL_FN float pdf_bsdf(SNELL_IN(MaterialPoint) m, vec3 wo, vec3 wi)
{
    if (m.kind == material_diffuse) return pdf_lambert(wo, wi);
    if (is_material(m.kind, material_mix)) {
        float p = mix_specular_probability(m);
        float pdf = (1.0f - p) * pdf_lambert(wo, wi);
        if (m.alpha > 0.0f) pdf += p * pdf_ggx_reflection(m.alpha, wo, wi);
        return pdf;
    }
    if (is_material(m.kind, material_principled)) {
        PrincipledPoint p = m.principled;
        return pdf_principled(p, wo, wi);
    }
    if (m.alpha > 0.0f && is_material(m.kind, material_dielectric)) return pdf_rough_dielectric(m, wo, wi);
    if (m.alpha > 0.0f && is_material(m.kind, material_conductor)) return pdf_ggx_reflection(m.alpha, wo, wi);
    return 0.0f;
}

// u: for the direction; u_lobe: for the choice between parts.
SNELL_FN BsdfSample sample_bsdf(SNELL_IN(MaterialPoint) m, vec3 wo, vec2 u, float u_lobe)
{
    BsdfSample s = no_bsdf_sample();
    if (wo.z == 0.0f || m.kind == material_unlit) return s;
    if (m.kind == material_diffuse) return sample_lambert(m.base_color, wo, u);
    if (is_material(m.kind, material_principled)) {
        PrincipledPoint p = m.principled;
        return sample_principled(p, wo, u, u_lobe);
    }
    if (is_material(m.kind, material_dielectric)) {
        if (m.alpha > 0.0f) return sample_rough_dielectric(m, wo, u, u_lobe);
        return sample_smooth_dielectric(m, wo, u_lobe);
    }
    vec3 mirrored = vec3(-wo.x, -wo.y, wo.z);
    if (is_material(m.kind, material_mirror) || (is_material(m.kind, material_conductor) && m.alpha == 0.0f)) {
        s.wi = mirrored;
        s.weight = is_material(m.kind, material_mirror) ? m.base_color : fresnel_conductor(abs(wo.z), m.specular, m.k);
        s.pdf = 1.0f;
        s.is_delta = 1u;
        return s;
    }
    float p_specular = is_material(m.kind, material_mix) ? mix_specular_probability(m) : 1.0f;
    if (u_lobe < p_specular) {
        if (m.alpha == 0.0f) {
            s.wi = mirrored;
            s.weight = m.specular / p_specular;
            s.pdf = p_specular;
            s.is_delta = 1u;
            return s;
        }
        s.wi = sample_ggx_reflection(m.alpha, wo, u);
        if (s.wi.z * wo.z <= 0.0f) return s;
    } else {
        s.wi = sample_lambert(m.base_color, wo, u).wi;
    }
    s.pdf = pdf_bsdf(m, wo, s.wi);
    if (s.pdf > 0.0f) s.weight = eval_bsdf(m, wo, s.wi) / s.pdf;
    return s;
}

SNELL_END
#endif
