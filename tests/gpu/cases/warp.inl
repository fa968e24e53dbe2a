// Warps of the unit square.
#ifndef TWIN_CASES
#include "snell/kernel/warp.h"
#else

TWIN(cos_sin_eighth, 1e-6f, 1e-7f, 0.0f)
{
    float a = range(-0.25f * pi, 0.25f * pi);
    give(cos_sin_eighth(a));
}
TWIN(unit_circle, 1e-6f, 1e-6f, 0.0f)
{
    float turn = range(0.0f, 1.0f);
    give(unit_circle(turn));
}
TWIN(sample_disk, 1e-6f, 1e-6f, 0.0f)
{
    vec2 u = unit2();
    give(sample_disk(u));
    give(pdf_disk());
}
TWIN(sample_cosine_hemisphere, 1e-5f, 1e-3f, 0.0f) // z = sqrt(1 - r^2) at the rim: an ulp of r^2 is 2.4e-4 of z
{
    vec2 u = unit2();
    vec3 w = sample_cosine_hemisphere(u);
    give(w);
    give(pdf_cosine_hemisphere(w));
}
TWIN(sample_uniform_hemisphere, 1e-5f, 1e-6f, 0.0f)
{
    vec2 u = unit2();
    give(sample_uniform_hemisphere(u));
    vec3 w = direction();
    give(pdf_uniform_hemisphere(w));
}
TWIN(sample_uniform_sphere, 1e-5f, 1e-6f, 0.0f)
{
    vec2 u = unit2();
    give(sample_uniform_sphere(u));
    give(pdf_uniform_sphere());
}
TWIN(sample_uniform_cone, 1e-5f, 1e-6f, 0.0f)
{
    vec2 u = unit2();
    float one_minus_cos = magnitude(1e-8f, 2.0f);
    give(sample_uniform_cone(u, one_minus_cos));
    give(pdf_uniform_cone(one_minus_cos));
}
TWIN(sample_triangle, 1e-6f, 1e-7f, 0.0f)
{
    vec2 u = unit2();
    give(sample_triangle(u));
}

#endif
