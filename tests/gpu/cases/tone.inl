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
TWIN(tone_curve, 2e-6f, 1e-6f, 0.0f)
{
    vec3 c = color();
    float scale = magnitude(1e-3f, 1e4f);
    uint curve = index_below(3u);
    give(tone_curve(scale * c, curve));
}
TWIN_BUILTIN(display_value, 1e-5f, 1e-5f, 0.0f)
{
    vec3 c = point(4.0f);
    float exposure = range(-10.0f, 10.0f);
    uint curve = index_below(3u);
    give(display_value(c, exposure, curve));
}

#endif
