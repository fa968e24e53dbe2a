// The principled BSDF: evaluation, density and sampling of a resolved PrincipledPoint. Conventions are those at the
// head of bsdf.h; wo must be the one that the point was resolved for.
#ifndef SNELL_KERNEL_PRINCIPLED_H
#define SNELL_KERNEL_PRINCIPLED_H
#include "snell/kernel/bsdf_sample.h"
#include "snell/kernel/frame.h"
#include "snell/kernel/ggx_anisotropic.h"
#include "snell/kernel/principled_resolve.h"
SNELL_BEGIN

// BSDF * |cos(wi)| and the density, together: they share most of their work.
struct PrincipledValue
{
    vec3 f;
    float pdf;
};

// What a facet does with light that meets it under that cosine.
struct FacetSplit
{
    vec3 reflected;
    vec3 through;      // radiance's scaling by 1 / eta^2 left out
    float p_reflected; // probability with which sampling reflects
};

SNELL_FN_COLD FacetSplit split_facet(SNELL_IN(PrincipledPoint) p, float cos_h)
{
    FacetSplit s;
    float edge = schlick_weight(cos_h);
    s.reflected = p.reflected_f0 + p.reflected_edge * edge;
    s.through = vec3(0.0f);
    s.p_reflected = 1.0f;
    if (may_have(feature_glass) && max3(p.glass_weight) > 0.0f) {
        bool total = false;
        if (p.eta != 1.0f) {
            DielectricSplit split = split_dielectric(cos_h, p.eta);
            edge = glass_edge(split);
            total = split.reflectance >= 1.0f;
        }
        vec3 f = total ? vec3(1.0f) : clamp(p.glass_f0 + (p.glass_f90 - p.glass_f0) * edge, 0.0f, 1.0f);
        s.reflected += p.glass_weight * f;
        s.through = p.glass_weight * p.base_color * (1.0f - f);
        float r = mean3(s.reflected);
        float t = mean3(s.through);
        s.p_reflected = r + t > 0.0f ? r / (r + t) : 1.0f;
    }
    return s;
}

// The rough facets of metal, opaque body and glass; wo.z > 0.
SNELL_FN_COLD PrincipledValue evaluate_facets(SNELL_IN(PrincipledPoint) p, vec3 wo, vec3 wi)
{
    PrincipledValue v;
    v.f = vec3(0.0f);
    v.pdf = 0.0f;
    bool reflects = wi.z > 0.0f;
    bool refracts = may_have(feature_glass) && !reflects && p.eta != 1.0f;
    if (!reflects && max3(p.glass_weight) == 0.0f) return v;
    // thin glass sends light on as a mirror in the surface would have it come
    vec3 i = reflects || refracts ? wi : vec3(wi.x, wi.y, -wi.z);
    vec3 h = dielectric_half_vector(wo, i, p.eta);
    if (h.z <= 0.0f) return v;
    float cos_o = dot(wo, h);
    FacetSplit split = split_facet(p, cos_o);
    vec3 local_o = to_facet_frame(p, wo);
    float lambda_o = anisotropic_lambda(local_o, p.alphas);
    float lambda_i = anisotropic_lambda(to_facet_frame(p, vec3(i.x, i.y, abs(i.z))), p.alphas);
    // per steradian of wi, before masking: the density of normals times what a change of the normal turns wi
    float stretch = 0.25f / wo.z;
    if (refracts) stretch = abs(dot(i, h)) * cos_o / (wo.z * sqr(dot(i, h) + cos_o / p.eta));
    float density = anisotropic_d(to_facet_frame(p, h), p.alphas) * stretch;
    float visible = density / (1.0f + lambda_o);
    v.f = (reflects ? split.reflected : split.through) * (density / (1.0f + lambda_o + lambda_i));
    if (refracts) v.f = v.f / (p.eta * p.eta);
    v.pdf = visible * (reflects ? split.p_reflected : 1.0f - split.p_reflected);
    return v;
}

// The rough clearcoat; wo.z > 0.
SNELL_FN_COLD PrincipledValue evaluate_coat(SNELL_IN(PrincipledPoint) p, vec3 wo, vec3 wi)
{
    PrincipledValue v;
    v.f = vec3(0.0f);
    v.pdf = 0.0f;
    Frame frame = make_frame(p.clearcoat_normal);
    vec3 o = to_local(frame, wo);
    vec3 i = to_local(frame, wi);
    if (wi.z <= 0.0f || o.z <= 0.0f || i.z <= 0.0f) return v;
    vec2 alphas = vec2(p.clearcoat_alpha);
    vec3 h = normalize(o + i);
    float lambda_o = anisotropic_lambda(o, alphas);
    float density = 0.25f * anisotropic_d(h, alphas) / o.z;
    float f = clearcoat_f0 + (1.0f - clearcoat_f0) * schlick_weight(dot(o, h));
    v.f = vec3(p.coat * f * density / (1.0f + lambda_o + anisotropic_lambda(i, alphas)));
    v.pdf = density / (1.0f + lambda_o);
    return v;
}

// All that is not delta. wo.z > 0.
SNELL_FN_COLD PrincipledValue evaluate_principled_above(SNELL_IN(PrincipledPoint) p, vec3 wo, vec3 wi)
{
    PrincipledValue v;
    v.f = vec3(0.0f);
    v.pdf = 0.0f;
    if (wi.z > 0.0f) {
        v.f = p.diffuse * (inv_pi * wi.z);
        v.pdf = p.p_diffuse * inv_pi * wi.z;
        if (may_have(feature_sheen) && p.p_sheen > 0.0f) {
            v.f += p.sheen * eval_sheen(p.sheen_alpha, wo, wi);
            v.pdf += p.p_sheen * (0.5f * inv_pi);
        }
        if (may_have(feature_clearcoat) && p.p_coat > 0.0f && p.clearcoat_alpha > 0.0f) {
            PrincipledValue coat = evaluate_coat(p, wo, wi);
            v.f += coat.f;
            v.pdf += p.p_coat * coat.pdf;
        }
    } else if (wi.z < 0.0f) {
        v.f = p.diffuse_through * (-inv_pi * wi.z);
        v.pdf = p.p_through * -inv_pi * wi.z;
    }
    if (p.p_facets > 0.0f && p.alphas.x > 0.0f && wi.z != 0.0f) {
        PrincipledValue facets = evaluate_facets(p, wo, wi);
        v.f += facets.f;
        v.pdf += p.p_facets * facets.pdf;
    }
    return v;
}

SNELL_FN vec3 mirror_in_surface(vec3 w, bool mirrored)
{
    return mirrored ? vec3(w.x, w.y, -w.z) : w;
}

SNELL_FN_COLD PrincipledValue evaluate_principled(SNELL_IN(PrincipledPoint) p, vec3 wo, vec3 wi)
{
    PrincipledValue v;
    v.f = vec3(0.0f);
    v.pdf = 0.0f;
    if (abs(wo.z) < principled_grazing) return v;
    bool mirrored = wo.z < 0.0f;
    return evaluate_principled_above(p, mirror_in_surface(wo, mirrored), mirror_in_surface(wi, mirrored));
}

// BSDF * |cos(wi)|, for radiance, without the delta parts.
SNELL_FN_COLD vec3 eval_principled(SNELL_IN(PrincipledPoint) p, vec3 wo, vec3 wi)
{
    return evaluate_principled(p, wo, wi).f;
}

SNELL_FN_COLD float pdf_principled(SNELL_IN(PrincipledPoint) p, vec3 wo, vec3 wi)
{
    return evaluate_principled(p, wo, wi).pdf;
}

// True if eval_principled can be other than 0.
SNELL_FN bool principled_has_smooth_part(SNELL_IN(PrincipledPoint) p)
{
    return p.p_diffuse + p.p_through + p.p_sheen > 0.0f || (p.p_facets > 0.0f && p.alphas.x > 0.0f) ||
           (p.p_coat > 0.0f && p.clearcoat_alpha > 0.0f);
}

// Directional albedo, for denoisers; in [0, 1].
SNELL_FN vec3 principled_albedo(SNELL_IN(PrincipledPoint) p)
{
    return p.albedo;
}

// A delta part with coefficient f, drawn with probability `chosen`.
SNELL_FN BsdfSample principled_delta(vec3 wi, vec3 f, float chosen)
{
    BsdfSample s = no_bsdf_sample();
    if (chosen <= 0.0f) return s;
    s.wi = wi;
    s.weight = f / chosen;
    s.pdf = chosen;
    s.is_delta = 1u;
    return s;
}

// The smooth or rough facets; u_lobe chooses between reflection and refraction. Of a rough sample only wi and eta are
// set, and pdf is 1, or 0 if there is none.
SNELL_FN_COLD BsdfSample sample_facets(SNELL_IN(PrincipledPoint) p, vec3 wo, vec2 u, float u_lobe)
{
    BsdfSample s = no_bsdf_sample();
    vec3 h = vec3(0.0f, 0.0f, 1.0f);
    bool rough = p.alphas.x > 0.0f;
    if (rough) h = from_facet_frame(p, sample_anisotropic_visible(to_facet_frame(p, wo), p.alphas, u));
    float cos_o = dot(wo, h);
    FacetSplit split = split_facet(p, cos_o);
    bool reflects = u_lobe < split.p_reflected;
    float eta = reflects ? 1.0f : p.eta;
    vec3 wi = rough ? 2.0f * cos_o * h - wo : vec3(-wo.x, -wo.y, wo.z);
    if (may_have(feature_glass) && !reflects) {
        if (p.eta == 1.0f)
            wi.z = -wi.z;
        else
            wi = refract_direction(wo, h, split_dielectric(cos_o, p.eta));
    }
    if (rough) {
        s.wi = wi;
        s.pdf = (wi.z > 0.0f) == reflects && wi.z != 0.0f ? 1.0f : 0.0f;
    } else {
        vec3 f = reflects ? split.reflected : split.through / (eta * eta);
        s = principled_delta(wi, f, p.p_facets * (reflects ? split.p_reflected : 1.0f - split.p_reflected));
    }
    s.eta = eta;
    return s;
}

// Likewise for the clearcoat.
SNELL_FN_COLD BsdfSample sample_coat(SNELL_IN(PrincipledPoint) p, vec3 wo, vec2 u)
{
    BsdfSample s = no_bsdf_sample();
    vec3 h = p.clearcoat_normal;
    if (p.clearcoat_alpha > 0.0f) {
        Frame frame = make_frame(h);
        h = to_world(frame, sample_anisotropic_visible(to_local(frame, wo), vec2(p.clearcoat_alpha), u));
    }
    float cos_o = dot(wo, h);
    vec3 wi = normalize(2.0f * cos_o * h - wo);
    // below the coat or the surface
    if (wi.z <= 0.0f || dot(wi, p.clearcoat_normal) <= 0.0f) return s;
    if (p.clearcoat_alpha == 0.0f) {
        float f = clearcoat_f0 + (1.0f - clearcoat_f0) * schlick_weight(cos_o);
        return principled_delta(wi, vec3(p.coat * f), p.p_coat);
    }
    s.wi = wi;
    s.pdf = 1.0f;
    return s;
}

// u: for the direction; u_lobe: for the choice between the lobes.
// Which lobe sample_principled draws from.
SNELL_CONST uint lobe_coat = 0u;
SNELL_CONST uint lobe_sheen = 1u;
SNELL_CONST uint lobe_facets = 2u;
SNELL_CONST uint lobe_straight = 3u; // on through a thin surface
SNELL_CONST uint lobe_diffuse = 4u;
SNELL_CONST uint lobe_through = 5u; // diffuse transmission

SNELL_FN uint principled_lobe(SNELL_IN(PrincipledPoint) p, float u_lobe)
{
    float to_sheen = p.p_coat;
    float to_facets = to_sheen + p.p_sheen;
    float to_straight = to_facets + p.p_facets;
    float to_diffuse = to_straight + p.p_straight;
    float to_through = to_diffuse + p.p_diffuse;
    if (u_lobe < to_sheen) return lobe_coat;
    if (u_lobe < to_facets) return lobe_sheen;
    if (u_lobe < to_straight) return lobe_facets;
    if (u_lobe < to_diffuse) return lobe_straight;
    return u_lobe < to_through ? lobe_diffuse : lobe_through;
}

SNELL_FN_COLD BsdfSample sample_principled(SNELL_IN(PrincipledPoint) p, vec3 wo, vec2 u, float u_lobe)
{
    BsdfSample s = no_bsdf_sample();
    if (abs(wo.z) < principled_grazing) return s;
    bool mirrored = wo.z < 0.0f;
    vec3 w = mirror_in_surface(wo, mirrored);
    uint lobe = principled_lobe(p, u_lobe);
    if (may_have(feature_clearcoat) && lobe == lobe_coat) {
        s = sample_coat(p, w, u);
    } else if (lobe == lobe_sheen) {
        s.wi = sample_uniform_hemisphere(u);
        s.pdf = 1.0f;
    } else if (lobe == lobe_facets) {
        s = sample_facets(p, w, u, clamp((u_lobe - (p.p_coat + p.p_sheen)) / p.p_facets, 0.0f, 1.0f));
    } else if (lobe == lobe_straight) {
        s = principled_delta(-w, p.straight, p.p_straight);
    } else {
        s.wi = sample_cosine_hemisphere(u);
        if (lobe == lobe_through) s.wi.z = -s.wi.z;
        s.pdf = 1.0f;
    }
    if (s.pdf > 0.0f && s.is_delta == 0u) {
        PrincipledValue v = evaluate_principled_above(p, w, s.wi);
        s.pdf = v.pdf;
        if (v.pdf > 0.0f) s.weight = v.f / v.pdf;
    }
    s.wi = mirror_in_surface(s.wi, mirrored);
    return s;
}

SNELL_END
#endif
