// What a thin film on a surface makes of its Fresnel reflectance: Belcour and Barla 2017, A Practical Extension to
// Microfacet Theory for the Modeling of Varying Iridescence, in the approximations of glTF's KHR_materials_iridescence
// (Schlick's reflectance at both interfaces, three bounces, spectra integrated in Fourier space).
#ifndef SNELL_KERNEL_IRIDESCENCE_H
#define SNELL_KERNEL_IRIDESCENCE_H
#include "snell/kernel/warp.h"
SNELL_BEGIN

SNELL_FN float schlick_weight(float cos_i)
{
    float x = clamp(1.0f - cos_i, 0.0f, 1.0f);
    float x2 = x * x;
    return x2 * x2 * x;
}

// cos of an angle given in full turns, of any size.
SNELL_FN float cos_turns(float turns)
{
    return unit_circle(clamp(turns - floor(turns), 0.0f, 1.0f)).x;
}

// How the eye's three primaries, as Gaussians over the spectrum, see a sum of waves with that optical path difference
// (metres) and phase shift (radians, one a primary). In linear Rec.709; about 1 for no difference (equal energy, which
// is not quite the white of Rec.709).
SNELL_FN vec3 film_sensitivity(float path_difference, vec3 shift)
{
    vec3 value = vec3(5.4856e-13f, 4.4201e-13f, 5.2481e-13f);
    vec3 position = vec3(1.6810e+06f, 1.7953e+06f, 2.2084e+06f);
    vec3 variance = vec3(4.3278e+09f, 9.3046e+09f, 6.6121e+09f);
    float phase = 2.0f * pi * path_difference;
    float phase2 = phase * phase;
    vec3 turns = position * path_difference + shift * (0.5f * inv_pi);
    vec3 wave = vec3(cos_turns(turns.x), cos_turns(turns.y), cos_turns(turns.z));
    vec3 xyz = value * sqrt(2.0f * pi * variance) * wave * exp(-phase2 * variance);
    // X has a second peak
    float second = cos_turns(2.2399e+06f * path_difference + shift.x * (0.5f * inv_pi));
    xyz.x += 9.7470e-14f * sqrt(2.0f * pi * 4.5282e+09f) * second * exp(-4.5282e+09f * phase2);
    xyz = xyz / 1.0685e-7f;
    return vec3(3.2404542f * xyz.x - 1.5371385f * xyz.y - 0.4985314f * xyz.z,
                -0.9692660f * xyz.x + 1.8760108f * xyz.y + 0.0415560f * xyz.z,
                0.0556434f * xyz.x - 0.2040259f * xyz.y + 1.0572252f * xyz.z);
}

// Reflectance of a film in air on a base.
//   cos_i      in air, in [0, 1]
//   film_ior   >= 1; thickness in nanometres, >= 0: below 0.03 nm the film fades away, and 0 is no film
//   base_f0    reflectance of the base in air at normal incidence, in [0, 1]
// The result is in [0, 1].
SNELL_FN_COLD vec3 film_reflectance(float cos_i, float film_ior, float thickness, vec3 base_f0)
{
    float d = clamp(thickness, 0.0f, 1e5f); // so thick a film shows no colours any more
    if (d == 0.0f) return base_f0 + (1.0f - base_f0) * schlick_weight(cos_i);
    float fade = min(d / 0.03f, 1.0f);
    float ior = 1.0f + max(film_ior - 1.0f, 0.0f) * fade * fade * (3.0f - 2.0f * fade);
    float sin2_t = (1.0f - cos_i * cos_i) / (ior * ior);
    float cos_t = safe_sqrt(1.0f - sin2_t);

    // air to film
    float f0 = sqr((ior - 1.0f) / (ior + 1.0f));
    float r12 = f0 + (1.0f - f0) * schlick_weight(cos_i);
    float through = 1.0f - r12; // in both ways

    // film to base: the base's index in air follows from its reflectance
    vec3 root = sqrt(clamp(base_f0, 0.0f, 0.9999f));
    vec3 base_ior = (1.0f + root) / (1.0f - root);
    vec3 r1 = (base_ior - ior) / (base_ior + ior);
    r1 = r1 * r1;
    vec3 r23 = r1 + (1.0f - r1) * schlick_weight(cos_t);
    vec3 shift = vec3(pi + (base_ior.x < ior ? pi : 0.0f), pi + (base_ior.y < ior ? pi : 0.0f),
                      pi + (base_ior.z < ior ? pi : 0.0f));

    // the film's bounces as a series in the amplitude of one round trip
    float path_difference = 2.0f * ior * (d * 1e-9f) * cos_t;
    vec3 round2 = clamp(r12 * r23, 1e-5f, 0.9999f);
    vec3 amplitude = sqrt(round2);
    vec3 once = through * through * r23 / (1.0f - round2);
    vec3 sum = r12 + once;
    vec3 c = once - through;
    for (int m = 1; m <= 2; m++) {
        float times = float(m);
        c = c * amplitude;
        sum += c * (2.0f * film_sensitivity(times * path_difference, times * shift));
    }
    return clamp(sum, 0.0f, 1.0f);
}

SNELL_END
#endif
