// What sampling of a scattering model gives, and the geometry that the models have in common. Directions are as at the
// head of bsdf.h: local, unit length, away from the surface.
#ifndef SNELL_KERNEL_BSDF_SAMPLE_H
#define SNELL_KERNEL_BSDF_SAMPLE_H
#include "snell/kernel/lang.h"
SNELL_BEGIN

struct BsdfSample
{
    vec3 wi;
    vec3 weight; // BSDF * |cos| / pdf
    float pdf;   // per steradian; probability if is_delta; 0: no sample, and nothing else means anything
    float eta;   // transmitted side over incident side if the sample crosses the surface, else 1
    uint is_delta;
};

SNELL_FN BsdfSample no_bsdf_sample()
{
    BsdfSample s;
    s.wi = vec3(0.0f, 0.0f, 1.0f);
    s.weight = vec3(0.0f);
    s.pdf = 0.0f;
    s.eta = 1.0f;
    s.is_delta = 0u;
    return s;
}

// The microfacet normal that takes wo to wi, on the side of +Z; zero if there is none.
SNELL_FN vec3 dielectric_half_vector(vec3 wo, vec3 wi, float eta)
{
    vec3 h = wo.z * wi.z > 0.0f ? wo + wi : wi * eta + wo;
    float l2 = dot(h, h);
    if (wo.z == 0.0f || wi.z == 0.0f || l2 < 1e-12f) return vec3(0.0f);
    h = h / sqrt(l2);
    if (h.z < 0.0f) h = -h;
    // a facet seen from behind
    if (dot(h, wi) * wi.z <= 0.0f || dot(h, wo) * wo.z <= 0.0f) return vec3(0.0f);
    return h;
}

SNELL_END
#endif
