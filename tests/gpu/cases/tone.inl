// Display values.
#ifndef TWIN_CASES
#include "snell/kernel/tone.h"
#else

TWIN_BUILTIN(srgb_encode, 2e-6f, 1e-6f, 0.0f) // pow is built in and rounds as it likes
{
    float x = range(-0.5f, 1.5f);
    give(srgb_encode(x));
}
TWIN_BUILTIN(srgb_decode, 2e-6f, 1e-6f, 0.0f)
{
    float x = range(-0.5f, 1.5f);
    give(srgb_decode(x));
}
TWIN(tone_curve_aces_hill, 4e-6f, 2e-6f, 0.0f)
{
    vec3 c = color();
    give(tone_curve_aces_hill(magnitude(1e-3f, 1e3f) * c));
}
TWIN(tone_curve_neutral, 4e-6f, 2e-6f, 0.0f)
{
    vec3 c = color();
    give(tone_curve_neutral(magnitude(1e-3f, 1e3f) * c));
}
TWIN_BUILTIN(agx_sigmoid, 1e-4f, 5e-5f, 0.0f) // differences of powers
{
    float x = range(0.0f, 1.0f);
    give(agx_sigmoid(x));
}
TWIN_BUILTIN(tone_curve_agx, 2e-4f, 1e-4f, 0.0f)
{
    vec3 c = color();
    give(tone_curve_agx(magnitude(1e-3f, 1e3f) * c));
}
TWIN(tone_curve, 4e-6f, 2e-6f, 0.0f)
{
    vec3 c = color();
    float scale = magnitude(1e-3f, 1e4f);
    uint curve = index_below(5u);
    if (curve == tone_agx) curve = tone_neutral; // AgX, which is less exact, has its own case
    give(tone_curve(scale * c, curve));
}
TWIN_BUILTIN(display_value, 1e-5f, 1e-5f, 0.0f)
{
    vec3 c = point(4.0f);
    float exposure = range(-10.0f, 10.0f);
    uint curve = index_below(5u);
    if (curve == tone_agx) curve = tone_neutral; // AgX, which is less exact, has its own case
    give(display_value(c, exposure, curve));
}

#endif
