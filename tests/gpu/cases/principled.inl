// The principled surface: its parts, resolved, evaluated and sampled.
#ifndef TWIN_CASES
#include "tests/gpu/draw_principled.h"
#else

TWIN(principled_basics, 1e-5f, 1e-6f, 0.0f)
{
    float ior = range(0.0f, 3.0f);
    float x = unit();
    float y = unit();
    vec3 a = color();
    vec3 w = direction();
    PrincipledPoint p = plain_principled_point(x);
    give(p.alpha);
    give(p.glass_table);
    p.p_coat = 1.0f;
    clear_principled(p);
    give(p.p_coat);
    give(mean3(a));
    give(dispersed_ior(ior, x));
    give(f0_of_ior(ior));
    give(principled_alphas(x, y));
    p.anisotropy_direction = vec2(0.6f, 0.8f);
    give(to_facet_frame(p, w));
    give(from_facet_frame(p, w));
    give(f0_behind(a, x, 0.9f * y));
    give(scattering_gain(a, 0.3f + 0.7f * x));
    give(mirror_in_surface(w, x < 0.5f));
}
TWIN(glass_edge, 1e-3f, 1e-4f, 0.001f) // the critical angle
{
    float cos_i = unit();
    float ior = range(0.4f, 2.5f);
    give(glass_edge(split_dielectric(cos_i, ior)));
}
TWIN_BUILTIN(resolve_principled, 1e-3f, 1e-4f, 0.003f) // as the parts
{
    PrincipledPoint p = draw_principled_point();
    vec3 wo = draw_outgoing();
    PrincipledPoint r = resolve_principled(scene.albedo, p, wo);
    give_resolved(r);
    give(principled_has_smooth_part(r));
    give(principled_albedo(r));
}
TWIN(principled_delta, 1e-5f, 0.0f, 0.0f)
{
    vec3 wi = direction();
    vec3 f = color();
    float chosen = unit();
    give_bsdf_sample(principled_delta(wi, f, chosen));
}
#endif
