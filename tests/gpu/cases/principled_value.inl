// A principled surface evaluated. All in one case: every call brings the whole code along, which GPU compilers feel.
#ifndef TWIN_CASES
#include "tests/gpu/draw_principled.h"
#else

TWIN_BUILTIN(evaluate_principled, 2e-3f, 1e-4f, 0.005f) // see rough_dielectric
{
    PrincipledPoint p = draw_principled_point();
    vec3 wo = draw_outgoing();
    vec3 wi = direction();
    float cos_h = unit();
    wo.z = abs(wo.z);
    uint below = index_below(2u);
    p = resolve_principled(scene.albedo, p, mirror_in_surface(wo, below != 0u));
    FacetSplit s = split_facet(p, cos_h);
    give(s.reflected);
    give(s.through);
    give(s.p_reflected);
    if (p.alphas.x > 0.0f) give_principled_value(evaluate_facets(p, wo, wi));
    if (p.coat > 0.0f && p.clearcoat_alpha > 0.0f) give_principled_value(evaluate_coat(p, wo, wi));
    give_principled_value(evaluate_principled_above(p, wo, wi));
    wo = mirror_in_surface(wo, below != 0u);
    give_principled_value(evaluate_principled(p, wo, wi));
    give(eval_principled(p, wo, wi));
    give(pdf_principled(p, wo, wi));
}

#endif
