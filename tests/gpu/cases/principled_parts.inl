// The steps of resolving a principled surface.
#ifndef TWIN_CASES
#include "tests/gpu/draw_principled.h"
#else

TWIN_BUILTIN(resolve_coats, 1e-3f, 1e-5f, 0.001f)
{
    PrincipledPoint p = draw_principled_point();
    vec3 w = upper_direction();
    clear_principled(p);
    give(resolve_coats(scene.albedo, p, w));
    give(p.coat);
    give(p.sheen);
    give(p.albedo);
}
TWIN_BUILTIN(resolve_glass, 1e-3f, 1e-4f, 0.002f) // films; see glass_edge
{
    PrincipledPoint p = draw_principled_point();
    vec3 w = upper_direction();
    vec3 f0 = 0.2f * color();
    clear_principled(p);
    p.alphas = principled_alphas(p.alpha, p.anisotropy);
    p.eta = p.thin_walled != 0u ? 1.0f : p.ior;
    resolve_glass(scene.albedo, p, w, p.thin_walled == 0u, 0.8f, f0, f0, vec2(0.7f, 0.1f));
    give(p.glass_weight);
    give(p.glass_f0);
    give(p.p_facets);
    p.glass_table = albedo_length;
    give(glass_albedo(scene.albedo, p, w.z, p.alphas.y, f0, 0.5f));
}
#endif
