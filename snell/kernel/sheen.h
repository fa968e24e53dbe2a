// The sheen of cloth: Estevez and Kulla 2017, Production Friendly Microfacet Sheen BRDF, as glTF's KHR_materials_sheen
// has it. Reflection only; directions are local and on the side of +Z.
#ifndef SNELL_KERNEL_SHEEN_H
#define SNELL_KERNEL_SHEEN_H
#include "snell/kernel/lang.h"
SNELL_BEGIN

// Below this the lobe is so narrow and weak that nobody sees it, and the exponent grows without bound.
SNELL_CONST float sheen_alpha_min = 0.01f;

// Density of the fibres' normals, per steradian of m; m.z = cos_m >= 0, alpha in [sheen_alpha_min, 1].
SNELL_FN float sheen_d(float cos_m, float alpha)
{
    float sin2 = max(1.0f - cos_m * cos_m, 0.0f);
    float exponent = 1.0f / alpha;
    return (2.0f + exponent) * pow(sin2, 0.5f * exponent) * (0.5f * inv_pi);
}

// The curve that the paper fitted to the logarithm of the auxiliary function; c in [0, 1/2].
SNELL_FN float sheen_curve(float c, float alpha)
{
    float t = sqr(1.0f - alpha);
    float a = 25.3245f + (21.5473f - 25.3245f) * t;
    float b = 3.32435f + (3.82987f - 3.32435f) * t;
    float power = 0.16801f + (0.19823f - 0.16801f) * t;
    float d = -1.27393f + (-1.97760f + 1.27393f) * t;
    float e = -4.85967f + (-4.32054f + 4.85967f) * t;
    return a / (1.0f + b * pow(max(c, 0.0f), power)) + d * c + e;
}

// Smith's auxiliary function: shadowed to visible area ratio, of a direction with that z in [0, 1].
SNELL_FN float sheen_lambda(float z, float alpha)
{
    float l = z < 0.5f ? sheen_curve(z, alpha) : 2.0f * sheen_curve(0.5f, alpha) - sheen_curve(1.0f - z, alpha);
    return exp(l);
}

// BRDF * cos(wi) for a sheen colour of 1. Not normalised: its albedo can pass 1 at grazing angles; the caller scales.
SNELL_FN float eval_sheen(float alpha, vec3 wo, vec3 wi)
{
    if (wo.z <= 0.0f || wi.z <= 0.0f) return 0.0f;
    vec3 h = normalize(wo + wi);
    float g = 1.0f / (1.0f + sheen_lambda(min(wo.z, 1.0f), alpha) + sheen_lambda(min(wi.z, 1.0f), alpha));
    return sheen_d(h.z, alpha) * g / (4.0f * wo.z);
}

SNELL_END
#endif
