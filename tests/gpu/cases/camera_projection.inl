// Projections of lenses, and their inverses.
#ifndef TWIN_CASES
#include "snell/kernel/camera_projection.h"
SNELL_BEGIN
SNELL_FN_COLD BrownConrady draw_brown_conrady()
{
    BrownConrady b;
    b.k1 = range(-0.1f, 0.2f);
    b.k2 = range(-0.02f, 0.05f);
    b.k3 = range(0.0f, 0.01f);
    b.k4 = range(0.0f, 0.05f);
    b.k5 = range(0.0f, 0.01f);
    b.k6 = range(0.0f, 0.001f);
    b.p1 = range(-0.01f, 0.01f);
    b.p2 = range(-0.01f, 0.01f);
    return b;
}
SNELL_END
#else

TWIN_BUILTIN(fisheyes, 1e-5f, 1e-5f, 0.001f) // beyond the circle there is nothing
{
    float r = range(0.0f, 3.3f);
    float theta = range(0.0f, 3.0f);
    give(arc_sine(min(0.5f * r, 1.0f)));
    give(equidistant_angle(r));
    give(equisolid_angle(r));
    give(stereographic_angle(r));
    give(stereographic_radius(theta));
    give(fisheye_orthographic_angle(r));
    give(fisheye_orthographic_radius(theta));
}
TWIN(odd_polynomial, 1e-4f, 1e-4f, 0.002f) // where it turns back there is nothing
{
    vec4 k;
    k.x = range(-0.1f, 0.1f);
    k.y = range(-0.05f, 0.05f);
    k.z = range(0.0f, 0.01f);
    k.w = range(0.0f, 0.001f);
    float x = range(0.0f, 3.0f);
    give(odd_polynomial(k, x));
    give(invert_odd_polynomial(k, x, 3.0f));
}
TWIN(kannala_brandt, 1e-4f, 1e-4f, 0.002f)
{
    vec4 k;
    k.x = range(-0.05f, 0.05f);
    k.y = range(-0.02f, 0.02f);
    k.z = range(0.0f, 0.005f);
    k.w = range(0.0f, 0.001f);
    float r = range(0.0f, 3.5f);
    give(kannala_brandt_angle(k, r));
    give(kannala_brandt_radius(k, 0.8f * r));
}
TWIN_BUILTIN(hmd, 1e-4f, 1e-4f, 0.002f)
{
    vec3 k;
    k.x = range(0.0f, 0.3f);
    k.y = range(0.0f, 0.1f);
    k.z = range(0.0f, 0.05f);
    float r = range(0.0f, 1.5f);
    give(hmd_angle(k, r));
    give(hmd_radius(k, r));
}
TWIN(brown_conrady, 1e-4f, 1e-4f, 0.002f)
{
    BrownConrady b = draw_brown_conrady();
    vec2 m = point2(1.2f);
    give(brown_conrady_point(b, m));
    give(brown_conrady_folds(b, m));
    give(brown_conrady_look(b, m));
}

#endif
