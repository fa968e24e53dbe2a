// GGX with a roughness for each of two directions: alpha.x along local X, alpha.y along local Y, both > 0. Equal ones
// give what microfacet.h has. Masking and sampling as there. Directions are local: the mean normal is +Z.
#ifndef SNELL_KERNEL_GGX_ANISOTROPIC_H
#define SNELL_KERNEL_GGX_ANISOTROPIC_H
#include "snell/kernel/warp.h"
SNELL_BEGIN

// Density of microfacet normals, per steradian: the integral of D(m) * m.z over the hemisphere is 1.
SNELL_FN float anisotropic_d(vec3 m, vec2 alpha)
{
    if (m.z <= 0.0f) return 0.0f;
    float a = alpha.x * alpha.y;
    // for alpha.x = alpha.y this is what ggx_d divides by, over a
    float k = m.x * m.x * alpha.y / alpha.x + m.y * m.y * alpha.x / alpha.y + a * m.z * m.z;
    return a / (pi * k * k);
}

// Smith's auxiliary function of w: shadowed to visible area ratio.
SNELL_FN float anisotropic_lambda(vec3 w, vec2 alpha)
{
    float spread = sqr(alpha.x * w.x) + sqr(alpha.y * w.y);
    return 0.5f * (sqrt(1.0f + spread / max(w.z * w.z, 1e-20f)) - 1.0f);
}

// A normal visible from w (w.z > 0), with density max(dot(w, m), 0) * anisotropic_d(m) / ((1 + lambda(w)) * w.z): Dupuy
// and Benyoub 2023, Sampling Visible GGX Normals with Spherical Caps.
SNELL_FN vec3 sample_anisotropic_visible(vec3 w, vec2 alpha, vec2 u)
{
    vec3 v = normalize(vec3(alpha.x * w.x, alpha.y * w.y, w.z));
    float z = (1.0f - u.x) * (1.0f + v.z) - v.z;
    float r = safe_sqrt(1.0f - z * z);
    vec2 p = unit_circle(u.y);
    vec3 h = vec3(r * p.x, r * p.y, z) + v;
    return normalize(vec3(alpha.x * h.x, alpha.y * h.y, max(h.z, 1e-7f)));
}

SNELL_END
#endif
