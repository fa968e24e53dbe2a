// The GGX distribution.
#ifndef TWIN_CASES
#include "snell/kernel/microfacet.h"
#else

TWIN(ggx_d, 1e-5f, 0.0f, 0.0f)
{
    vec3 m = direction();
    float alpha = magnitude(1e-3f, 1.0f);
    give(ggx_d(m, alpha));
}
TWIN(ggx_g, 1e-5f, 1e-6f, 0.0f)
{
    vec3 o = direction();
    vec3 i = direction();
    float alpha = magnitude(1e-3f, 1.0f);
    give(ggx_lambda(o.z, alpha));
    give(ggx_g1(o.z, alpha));
    give(ggx_g2(o.z, i.z, alpha));
}
TWIN(sample_ggx_visible, 1e-4f, 1e-4f, 0.01f) // u.x next to 1: the cap and the direction cancel
{
    vec3 w = upper_direction();
    float alpha = magnitude(1e-3f, 1.0f);
    vec2 u = unit2();
    give(sample_ggx_visible(w, alpha, u));
}
TWIN(pdf_ggx_visible, 1e-4f, 1e-5f, 0.0f)
{
    vec3 w = upper_direction();
    vec3 m = upper_direction();
    float alpha = magnitude(1e-3f, 1.0f);
    give(pdf_ggx_visible(w, m, alpha));
}

#endif
