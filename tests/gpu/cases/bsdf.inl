// Scattering: each material by itself, then through the dispatching functions.
#ifndef TWIN_CASES
#include "tests/gpu/draw_principled.h"
#else

TWIN(no_bsdf_sample, 0.0f, 0.0f, 0.0f)
{
    BsdfSample s = no_bsdf_sample();
    give(s.wi);
    give(s.weight);
    give(s.pdf);
    give(s.eta);
    give(s.is_delta);
}
TWIN(lambert, 1e-5f, 1e-3f, 0.0f) // see sample_cosine_hemisphere
{
    vec3 albedo = color();
    vec3 wo = direction();
    vec3 wi = direction();
    vec2 u = unit2();
    give(eval_lambert(albedo, wo, wi));
    give(pdf_lambert(wo, wi));
    give_bsdf_sample(sample_lambert(albedo, wo, u));
}
TWIN(ggx_reflection, 1e-3f, 1e-5f, 0.001f) // near the peak of a small alpha a tiny turn of the normal counts
{
    float alpha = magnitude(1e-2f, 1.0f);
    vec3 wo = direction();
    vec3 wi = direction();
    if (wo.z == 0.0f) wo = vec3(0.0f, 0.0f, 1.0f);
    give(eval_ggx_reflection(alpha, wo, wi));
    give(pdf_ggx_reflection(alpha, wo, wi));
}
TWIN(sample_ggx_reflection, 1e-3f, 1e-4f, 0.01f) // see sample_ggx_visible
{
    float alpha = magnitude(1e-2f, 1.0f);
    vec3 wo = direction();
    vec2 u = unit2();
    if (wo.z == 0.0f) wo = vec3(0.0f, 0.0f, 1.0f);
    give(sample_ggx_reflection(alpha, wo, u));
}
TWIN(sample_smooth_dielectric, 1e-3f, 1e-5f, 0.001f) // u next to the reflectance; the critical angle
{
    MaterialPoint m = draw_material_point(material_dielectric, 0.0f);
    vec3 wo = direction();
    float u = unit();
    give_bsdf_sample(sample_smooth_dielectric(m, wo, u));
}
TWIN(dielectric_half_vector, 1e-3f, 1e-4f, 0.001f) // wo and wi cancel
{
    vec3 wo = direction();
    vec3 wi = direction();
    float eta = range(0.4f, 3.0f);
    give(dielectric_half_vector(wo, wi, eta));
}
TWIN(rough_dielectric, 1e-3f, 1e-4f, 0.002f) // where i + o / eta cancels, the density is huge
{
    float alpha = magnitude(1e-2f, 1.0f);
    MaterialPoint m = draw_material_point(material_dielectric, alpha);
    vec3 wo = direction();
    vec3 wi = direction();
    give(eval_rough_dielectric(m, wo, wi));
    give(pdf_rough_dielectric(m, wo, wi));
}
TWIN(sample_rough_dielectric, 1e-3f, 1e-4f, 0.01f) // both of the above, and the choice of the lobe
{
    float alpha = magnitude(1e-2f, 1.0f);
    MaterialPoint m = draw_material_point(material_dielectric, alpha);
    vec3 wo = direction();
    vec2 u = unit2();
    float u_lobe = unit();
    give_bsdf_sample(sample_rough_dielectric(m, wo, u, u_lobe));
}
TWIN(mix_specular_probability, 1e-6f, 0.0f, 0.0f)
{
    uint kind = index_below(5u);
    float alpha = range(0.0f, 1.0f);
    MaterialPoint m = draw_material_point(kind, alpha);
    give(mix_specular_probability(m));
    give(has_smooth_part(m));
}
TWIN_BUILTIN(eval_bsdf, 1e-3f, 1e-4f, 0.002f) // as the parts
{
    uint kind = index_below(material_kinds);
    float alpha = magnitude(1e-2f, 1.0f);
    uint smooth_one = index_below(4u);
    vec3 wo = direction();
    MaterialPoint m = draw_resolved_point(scene, kind, smooth_one == 0u ? 0.0f : alpha, wo);
    vec3 wi = direction();
    give(eval_bsdf(m, wo, wi));
    give(pdf_bsdf(m, wo, wi));
}
TWIN_BUILTIN(sample_bsdf, 1e-3f, 1e-3f, 0.005f) // as the parts
{
    uint kind = index_below(material_kinds);
    float alpha = magnitude(1e-2f, 1.0f);
    uint smooth_one = index_below(4u);
    vec3 wo = direction();
    MaterialPoint m = draw_resolved_point(scene, kind, smooth_one == 0u ? 0.0f : alpha, wo);
    vec2 u = unit2();
    float u_lobe = unit();
    give_bsdf_sample(sample_bsdf(m, wo, u, u_lobe));
}

#endif
