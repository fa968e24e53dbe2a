// The GGX microfacet distribution (Walter et al. 2007), isotropic with roughness alpha > 0, with height-correlated
// Smith shadowing (Heitz 2014) and sampling of visible normals. Directions are local: the mean normal is +Z.
#ifndef SNELL_KERNEL_MICROFACET_H
#define SNELL_KERNEL_MICROFACET_H
#include "snell/kernel/warp.h"
SNELL_BEGIN

// Density of microfacet normals, per steradian: the integral of D(m) * m.z over the hemisphere is 1.
SNELL_FN float ggx_d(vec3 m, float alpha)
{
    if (m.z <= 0.0f) return 0.0f;
    float a2 = alpha * alpha;
    // cos^2 (a^2 - 1) + 1, written so that small alpha does not cancel
    float k = m.x * m.x + m.y * m.y + a2 * m.z * m.z;
    return a2 / (pi * k * k);
}

// Smith's auxiliary function: visible to shadowed area ratio, of a direction with that z.
SNELL_FN float ggx_lambda(float z, float alpha)
{
    float c2 = z * z;
    float s2 = max(1.0f - c2, 0.0f);
    return 0.5f * (sqrt(1.0f + alpha * alpha * s2 / max(c2, 1e-20f)) - 1.0f);
}

// Part of the microfacets that is visible from w.
SNELL_FN float ggx_g1(float z, float alpha)
{
    return 1.0f / (1.0f + ggx_lambda(z, alpha));
}

// Part that is visible from both directions.
SNELL_FN float ggx_g2(float z_o, float z_i, float alpha)
{
    return 1.0f / (1.0f + ggx_lambda(z_o, alpha) + ggx_lambda(z_i, alpha));
}

// A normal visible from w (w.z > 0): Dupuy and Benyoub 2023, Sampling Visible GGX Normals with Spherical Caps.
SNELL_FN vec3 sample_ggx_visible(vec3 w, float alpha, vec2 u)
{
    vec3 v = normalize(vec3(alpha * w.x, alpha * w.y, w.z));
    float z = (1.0f - u.x) * (1.0f + v.z) - v.z;
    float r = safe_sqrt(1.0f - z * z);
    vec2 p = unit_circle(u.y);
    vec3 h = vec3(r * p.x, r * p.y, z) + v;
    return normalize(vec3(alpha * h.x, alpha * h.y, max(h.z, 1e-7f)));
}

// Its density per steradian of m.
SNELL_FN float pdf_ggx_visible(vec3 w, vec3 m, float alpha)
{
    return ggx_g1(w.z, alpha) * max(dot(w, m), 0.0f) * ggx_d(m, alpha) / w.z;
}

SNELL_END
#endif
