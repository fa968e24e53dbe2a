// Warps: uniform points in the unit square become points and directions with a known density. u is in [0, 1)^2.
// A sample_x has density pdf_x: per unit of area on disk and triangle, per steradian for directions.
#ifndef SNELL_KERNEL_WARP_H
#define SNELL_KERNEL_WARP_H
#include "snell/kernel/lang.h"
SNELL_BEGIN

// (cos a, sin a) for a in [-pi/4, pi/4]: Taylor polynomials, within 3e-7. Our own, so that both languages agree.
SNELL_FN vec2 cos_sin_eighth(float a)
{
    float q = a * a;
    float c = 1.0f + q * (-0.5f + q * (4.16666667e-2f + q * (-1.38888889e-3f + q * 2.48015873e-5f)));
    float s = a * (1.0f + q * (-1.66666667e-1f + q * (8.33333333e-3f + q * (-1.98412698e-4f + q * 2.75573192e-6f))));
    return vec2(c, s);
}

// (cos, sin) of `turn` full turns, turn in [0, 1].
SNELL_FN vec2 unit_circle(float turn)
{
    float quarters = floor(turn * 4.0f + 0.5f);
    vec2 p = cos_sin_eighth((turn * 4.0f - quarters) * (0.5f * pi));
    if (quarters == 1.0f) return vec2(-p.y, p.x);
    if (quarters == 2.0f) return vec2(-p.x, -p.y);
    if (quarters == 3.0f) return vec2(p.y, -p.x);
    return p;
}

// The concentric map from the square to the unit disk (Shirley and Chiu 1997). Density 1/pi.
SNELL_FN vec2 sample_disk(vec2 u)
{
    float a = 2.0f * u.x - 1.0f;
    float b = 2.0f * u.y - 1.0f;
    bool wide = abs(a) > abs(b); // as choices, not as branches: nobody can predict them
    float r = wide ? a : b;
    float slope = (wide ? b : a) / (r == 0.0f ? 1.0f : r);
    vec2 p = cos_sin_eighth(0.25f * pi * slope);
    return vec2(r * (wide ? p.x : p.y), r * (wide ? p.y : p.x));
}

SNELL_FN float pdf_disk()
{
    return inv_pi;
}

// Cosine-distributed directions around +Z.
SNELL_FN vec3 sample_cosine_hemisphere(vec2 u)
{
    vec2 d = sample_disk(u);
    return vec3(d.x, d.y, safe_sqrt(1.0f - d.x * d.x - d.y * d.y));
}

SNELL_FN float pdf_cosine_hemisphere(vec3 w)
{
    return max(w.z, 0.0f) * inv_pi;
}

// Uniform directions around +Z: the concentric disk lifted by Lambert's equal-area map.
SNELL_FN vec3 sample_uniform_hemisphere(vec2 u)
{
    vec2 d = sample_disk(u);
    float r2 = d.x * d.x + d.y * d.y;
    float k = safe_sqrt(2.0f - r2);
    return vec3(d.x * k, d.y * k, 1.0f - r2);
}

SNELL_FN float pdf_uniform_hemisphere(vec3 w)
{
    return w.z > 0.0f ? 0.5f * inv_pi : 0.0f;
}

SNELL_FN vec3 sample_uniform_sphere(vec2 u)
{
    float z = 1.0f - 2.0f * u.x;
    float r = safe_sqrt(4.0f * u.x * (1.0f - u.x));
    vec2 p = unit_circle(u.y);
    return vec3(r * p.x, r * p.y, z);
}

SNELL_FN float pdf_uniform_sphere()
{
    return 0.25f * inv_pi;
}

// Uniform directions within a cone around +Z, given as 1 - cos of its half angle: for a narrow cone the cosine itself
// would have lost all digits.
SNELL_FN vec3 sample_uniform_cone(vec2 u, float one_minus_cos)
{
    float h = u.x * one_minus_cos; // 1 - cos(theta)
    float r = safe_sqrt(h * (2.0f - h));
    vec2 p = unit_circle(u.y);
    return vec3(r * p.x, r * p.y, 1.0f - h);
}

SNELL_FN float pdf_uniform_cone(float one_minus_cos)
{
    return 0.5f * inv_pi / one_minus_cos;
}

// Barycentric weights (of the second and the third vertex), uniform over the triangle: Heitz 2019, A Low-Distortion Map
// Between Triangle and Square. Density 1 / area.
SNELL_FN vec2 sample_triangle(vec2 u)
{
    bool upper = u.y > u.x;
    float small = 0.5f * (upper ? u.x : u.y);
    float large = (upper ? u.y : u.x) - small;
    return vec2(upper ? small : large, upper ? large : small);
}

SNELL_END
#endif
