// From scene-linear radiance to display values: exposure, tone curve, sRGB encoding.
#ifndef SNELL_KERNEL_TONE_H
#define SNELL_KERNEL_TONE_H
#include "snell/kernel/lang.h"
SNELL_BEGIN

// Tone curves by number.
SNELL_CONST uint tone_none = 0u;     // clip
SNELL_CONST uint tone_reinhard = 1u; // x / (1 + x) on luminance
SNELL_CONST uint tone_aces = 2u;     // Narkowicz's 2015 fit of the ACES curve

// The piecewise sRGB curve (IEC 61966-2-1), from linear [0, 1] to encoded [0, 1].
SNELL_FN float srgb_encode(float x)
{
    float c = clamp(x, 0.0f, 1.0f);
    return c <= 0.0031308f ? 12.92f * c : 1.055f * pow(c, 1.0f / 2.4f) - 0.055f;
}

// The inverse: encoded [0, 1] to linear [0, 1].
SNELL_FN float srgb_decode(float x)
{
    float c = clamp(x, 0.0f, 1.0f);
    return c <= 0.04045f ? c / 12.92f : pow((c + 0.055f) / 1.055f, 2.4f);
}

SNELL_FN vec3 tone_curve(vec3 radiance, uint curve)
{
    if (curve == tone_reinhard) return radiance / (1.0f + luminance(radiance));
    if (curve == tone_aces) {
        vec3 x = radiance;
        return clamp((x * (2.51f * x + 0.03f)) / (x * (2.43f * x + 0.59f) + 0.14f), 0.0f, 1.0f);
    }
    return radiance;
}

// Display value in [0, 1] of a radiance; exposure in EV (a factor of 2 each).
SNELL_FN vec3 display_value(vec3 radiance, float exposure_ev, uint curve)
{
    vec3 c = tone_curve(max(radiance, vec3(0.0f)) * exp2(exposure_ev), curve);
    return vec3(srgb_encode(c.x), srgb_encode(c.y), srgb_encode(c.z));
}

SNELL_END
#endif
