// Fresnel's equations and Snell's law.
#ifndef TWIN_CASES
#include "snell/kernel/fresnel.h"
#else

TWIN(split_dielectric, 1e-4f, 1e-5f, 0.001f) // near the critical angle cos_t loses half of its digits
{
    float cos_i = range(-1.0f, 1.0f);
    float ior = range(0.4f, 4.0f);
    DielectricSplit s = split_dielectric(cos_i, ior);
    give(s.reflectance);
    give(s.cos_t);
    give(s.eta);
}
TWIN(fresnel_conductor, 1e-4f, 1e-5f, 0.0f)
{
    float cos_i = range(0.0f, 1.0f);
    vec3 eta = color();
    vec3 k = color();
    give(fresnel_conductor(cos_i, 4.0f * eta + vec3(0.05f), 8.0f * k));
}
TWIN(refract_direction, 1e-4f, 1e-5f, 0.001f) // as split_dielectric
{
    vec3 w = direction();
    vec3 n = direction();
    float ior = range(0.4f, 4.0f);
    DielectricSplit s = split_dielectric(dot(w, n), ior);
    give(refract_direction(w, n, s));
}

#endif
