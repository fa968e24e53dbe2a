// From scene-linear radiance to display values: exposure, tone curve, sRGB encoding.
#ifndef SNELL_KERNEL_TONE_H
#define SNELL_KERNEL_TONE_H
#include "snell/kernel/lang.h"
SNELL_BEGIN

// Tone curves by number.
SNELL_CONST uint tone_none = 0u;     // clip
SNELL_CONST uint tone_reinhard = 1u; // x / (1 + x) on luminance
SNELL_CONST uint tone_aces = 2u;     // Narkowicz's 2015 fit of the ACES curve, on each channel
SNELL_CONST uint tone_aces_hill = 3u; // Hill's 2015 fit of the ACES transforms
SNELL_CONST uint tone_agx = 4u;      // Sobotka's AgX, its base look
SNELL_CONST uint tone_neutral = 5u;  // Khronos PBR Neutral: colours below 0.8 stay as they are
SNELL_CONST uint tone_count = 6u;

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

// Stephen Hill's fit of the ACES reference rendering and output transforms for Rec.709 displays (BakingLab,
// ACES.hlsl), linear [0, inf) to linear, which may leave [0, 1] a little.
SNELL_FN vec3 tone_curve_aces_hill(vec3 c)
{
    vec3 v = vec3(0.59719f * c.x + 0.35458f * c.y + 0.04823f * c.z, 0.07600f * c.x + 0.90834f * c.y + 0.01566f * c.z,
                  0.02840f * c.x + 0.13383f * c.y + 0.83777f * c.z);
    v = (v * (v + 0.0245786f) - 0.000090537f) / (v * (0.983729f * v + 0.4329510f) + 0.238081f);
    return vec3(1.60475f * v.x - 0.53108f * v.y - 0.07367f * v.z, -0.10208f * v.x + 1.10813f * v.y - 0.00605f * v.z,
                -0.00327f * v.x - 0.07276f * v.y + 1.07602f * v.z);
}

// AgX's curve on one channel: from its log encoding in [0, 1] to display values in [0, 1]. A hyperbola on each side of
// the pivot, which is middle grey, with a slope of 2 there; powers of 3 (toe) and 3.25 (shoulder).
SNELL_FN float agx_sigmoid(float x)
{
    float x_pivot = 0.6060606f; // 10 of the 16.5 EV
    float y_pivot = 0.5f;
    float slope = 2.0f;
    bool is_toe = x < x_pivot;
    float power = is_toe ? 3.0f : 3.25f;
    float run = is_toe ? x_pivot : 1.0f - x_pivot;
    float rise = is_toe ? y_pivot : 1.0f - y_pivot;
    // So that the hyperbola ends in the corner.
    float scale = pow(pow(slope * run, -power) * (pow(slope * run / rise, power) - 1.0f), -1.0f / power);
    float t = slope * abs(x - x_pivot) / scale;
    float y = scale * t / pow(1.0f + pow(t, power), 1.0f / power);
    return clamp(is_toe ? y_pivot - y : y_pivot + y, 0.0f, 1.0f);
}

// Troy Sobotka's AgX (2022) with its base look, as renderers take it for Rec.709: an inset of the primaries, 16.5 EV of
// log encoding around middle grey, the curve, the outset, and out of its display's gamma of 2.2. Linear to linear.
SNELL_FN vec3 tone_curve_agx(vec3 c)
{
    vec3 v = vec3(0.842479062253094f * c.x + 0.0784335999999992f * c.y + 0.0792237451477643f * c.z,
                  0.0423282422610123f * c.x + 0.878468636469772f * c.y + 0.0791661274605434f * c.z,
                  0.0423756549057051f * c.x + 0.0784336f * c.y + 0.879142973793104f * c.z);
    v = (log2(max(v, vec3(1e-10f))) + 12.47393f) / 16.5f;
    v = clamp(v, 0.0f, 1.0f);
    v = vec3(agx_sigmoid(v.x), agx_sigmoid(v.y), agx_sigmoid(v.z));
    vec3 o = vec3(1.19687900512017f * v.x - 0.0980208811401368f * v.y - 0.0990297440797205f * v.z,
                  -0.0528968517574562f * v.x + 1.15190312990417f * v.y - 0.0989611768448433f * v.z,
                  -0.0529716355144438f * v.x - 0.0980434501171241f * v.y + 1.15107367264116f * v.z);
    return pow(clamp(o, 0.0f, 1.0f), vec3(2.2f));
}

// Khronos' PBR Neutral tone mapper (2024): base colours look as an artist has chosen them, highlights are compressed
// and lose their saturation. Linear to linear [0, 1].
SNELL_FN vec3 tone_curve_neutral(vec3 c)
{
    float start = 0.8f - 0.04f;
    float lowest = min(c.x, min(c.y, c.z));
    float offset = lowest < 0.08f ? lowest - 6.25f * lowest * lowest : 0.04f; // the Fresnel reflection of a white sky
    vec3 v = c - vec3(offset);
    float peak = max(v.x, max(v.y, v.z));
    if (peak < start) return v;
    float d = 1.0f - start;
    float compressed = 1.0f - d * d / (peak + d - start);
    float g = 1.0f - 1.0f / (0.15f * (peak - compressed) + 1.0f);
    return mix(v * (compressed / peak), vec3(compressed), g);
}

SNELL_FN vec3 tone_curve(vec3 radiance, uint curve)
{
    if (curve == tone_reinhard) return radiance / (1.0f + luminance(radiance));
    if (curve == tone_aces) {
        vec3 x = radiance;
        return clamp((x * (2.51f * x + 0.03f)) / (x * (2.43f * x + 0.59f) + 0.14f), 0.0f, 1.0f);
    }
    if (curve == tone_aces_hill) return tone_curve_aces_hill(radiance);
    if (curve == tone_agx) return tone_curve_agx(radiance);
    if (curve == tone_neutral) return tone_curve_neutral(radiance);
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
