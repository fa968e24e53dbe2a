// Fresnel's equations.
#ifndef SNELL_KERNEL_FRESNEL_H
#define SNELL_KERNEL_FRESNEL_H
#include "snell/kernel/lang.h"
SNELL_BEGIN

// What a smooth dielectric interface does to a ray that meets it.
struct DielectricSplit
{
    float reflectance; // part of the radiance that is reflected, in [0, 1]; 1 under total internal reflection
    float cos_t;       // cosine between the refracted ray and the normal, >= 0; 0 under total internal reflection
    float eta;         // relative index of refraction on the way of the ray: transmitted side over incident side
};

// Fresnel's equations for unpolarised light between two dielectrics (Born & Wolf, Principles of Optics, 1.5.2).
//   cos_i  cosine between the direction away from the surface and its outward normal; negative means from inside
//   ior    index of refraction inside over outside, > 0
SNELL_FN DielectricSplit split_dielectric(float cos_i, float ior)
{
    float eta = cos_i > 0.0f ? ior : 1.0f / ior;
    float c = clamp(abs(cos_i), 0.0f, 1.0f);
    float sin2_t = (1.0f - c * c) / (eta * eta);
    DielectricSplit s;
    s.reflectance = 1.0f;
    s.cos_t = 0.0f;
    s.eta = eta;
    if (sin2_t >= 1.0f) return s;

    float ct = sqrt(1.0f - sin2_t);
    float r_parallel = (eta * c - ct) / (eta * c + ct);
    float r_perpendicular = (c - eta * ct) / (c + eta * ct);
    s.reflectance = 0.5f * (r_parallel * r_parallel + r_perpendicular * r_perpendicular);
    s.cos_t = ct;
    return s;
}

// Reflectance of a conductor with complex index eta + i k against vacuum, for unpolarised light (Born & Wolf 14.2), one
// value a colour channel. cos_i in [0, 1]; eta, k >= 0.
SNELL_FN vec3 fresnel_conductor(float cos_i, vec3 eta, vec3 k)
{
    float c2 = cos_i * cos_i;
    float s2 = 1.0f - c2;
    vec3 eta2 = eta * eta;
    vec3 k2 = k * k;
    vec3 t0 = eta2 - k2 - s2;
    vec3 a2_plus_b2 = sqrt(max(t0 * t0 + 4.0f * eta2 * k2, vec3(0.0f)));
    vec3 a = sqrt(max(0.5f * (a2_plus_b2 + t0), vec3(0.0f)));
    vec3 tiny = vec3(1e-30f); // where there is no interface (eta 1, k 0) the ratios are 0 / 0 at grazing incidence
    vec3 t1 = a2_plus_b2 + c2;
    vec3 t2 = 2.0f * cos_i * a;
    vec3 r_s = (t1 - t2) / max(t1 + t2, tiny);
    vec3 t3 = c2 * a2_plus_b2 + s2 * s2;
    vec3 t4 = t2 * s2;
    vec3 r_p = r_s * (t3 - t4) / max(t3 + t4, tiny);
    return clamp(0.5f * (r_s + r_p), 0.0f, 1.0f);
}

// The direction into which w (away from the surface, unit length) refracts at normal n, given the split's cos_t and
// eta. n may be on either side.
SNELL_FN vec3 refract_direction(vec3 w, vec3 n, DielectricSplit split)
{
    float c = dot(w, n);
    float side = c > 0.0f ? 1.0f : -1.0f;
    return normalize((c / split.eta - side * split.cos_t) * n - w / split.eta);
}

SNELL_END
#endif
