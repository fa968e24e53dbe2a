// The prelude: constants and small helpers.
#ifndef TWIN_CASES
#include "snell/kernel/lang.h"
#else

TWIN(constants, 0.0f, 0.0f, 0.0f)
{
    give(pi);
    give(inv_pi);
    give(none);
    give(floatBitsToUint(infinity()));
}
TWIN(is_finite, 0.0f, 0.0f, 0.0f) // all bit patterns, NaN and infinities among them
{
    uint x = word();
    uint exponent = index_below(4u) == 0u ? 0x7f800000u : 0u;
    uint y = word();
    uint z = word();
    give(is_finite(uintBitsToFloat(x | exponent)));
    give(is_finite3(vec3(uintBitsToFloat(x | exponent), uintBitsToFloat(y), uintBitsToFloat(z))));
}
TWIN(sqr, 0.0f, 0.0f, 0.0f)
{
    float x = range(-1e10f, 1e10f);
    give(sqr(x));
}
TWIN(max3, 0.0f, 0.0f, 0.0f)
{
    vec3 v = point(10.0f);
    give(max3(v));
}
TWIN(is_black, 0.0f, 0.0f, 0.0f)
{
    vec3 c = color();
    uint mask = index_below(8u);
    if ((mask & 1u) != 0u) c.x = 0.0f;
    if ((mask & 2u) != 0u) c.y = -0.0f;
    if ((mask & 4u) != 0u) c.z = 0.0f;
    give(is_black(c));
}
TWIN(luminance, 3e-7f, 0.0f, 0.0f) // sum of positive terms: fused or not, within 2 ulp
{
    vec3 c = color();
    give(luminance(c));
}
TWIN(safe_sqrt, 1e-7f, 0.0f, 0.0f)
{
    float x = range(-1.0f, 4.0f);
    give(safe_sqrt(x));
}

#endif
