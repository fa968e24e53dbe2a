// A principled surface sampled.
#ifndef TWIN_CASES
#include "tests/gpu/draw_principled.h"
#else

TWIN_BUILTIN(sample_principled, 2e-3f, 1e-3f, 0.02f) // see sample_ggx_visible; u next to the choice of the lobe
{
    PrincipledPoint p = draw_principled_point();
    vec3 wo = draw_outgoing();
    vec2 u = unit2();
    float u_lobe = unit();
    p = resolve_principled(scene.albedo, p, wo);
    give_bsdf_sample(sample_principled(p, wo, u, u_lobe));
    wo.z = abs(wo.z);
    give_bsdf_sample(sample_facets(p, wo, u, u_lobe));
    if (p.coat > 0.0f) give_bsdf_sample(sample_coat(p, wo, u));
}

#endif
