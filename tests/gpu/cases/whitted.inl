// The shade stage of Whitted's renderer.
#ifndef TWIN_CASES
#include "snell/kernel/whitted.h"
#include "tests/gpu/draw_principled.h"
#else

TWIN(is_worth_following, 0.0f, 0.0f, 1e-4f) // products at the cut-off
{
    give(is_worth_following(draw_state()) ? 1u : 0u);
}
TWIN(without_diffuse, 1e-6f, 0.0f, 0.0f)
{
    PrincipledPoint p = plain_principled_point(0.5f);
    p.diffuse = color();
    p.diffuse_through = color();
    p.sheen = color();
    p.p_coat = unit();
    p.p_sheen = unit();
    p.p_facets = unit();
    p.p_straight = unit();
    p.p_diffuse = unit();
    p.p_through = unit();
    give_resolved(without_diffuse(p));
}
TWIN_BUILTIN(shade_whitted, 1e-3f, 1e-3f, 0.005f) // all branches of all materials
{
    RenderParams params = draw_params();
    PathState state = draw_state();
    Ray ray = draw_ray();
    Hit hit = draw_hit();
    uint nothing = index_below(16u);
    if (nothing == 0u) hit = miss(ray.t_max);
    WhittedStep step = shade_whitted(scene, params, state, ray, hit);
    give(step.emitted);
    give(step.layer);
    give(step.light_tasks);
    give_state(step.state);
    give(step.has_next_0);
    give(step.has_next_1);
    if (step.has_next_0 != 0u) give_camera_path(step.next_0);
    if (step.has_next_1 != 0u) give_camera_path(step.next_1);
}
TWIN_BUILTIN(whitted_connection, 1e-3f, 1e-3f, 0.002f) // see sample_light
{
    RenderParams params = draw_params();
    WhittedStep step;
    step.state = draw_state();
    uint task = index_below(8u);
    uint kind = index_below(material_kinds);
    float alpha = magnitude(1e-2f, 1.0f);
    step.vertex = draw_vertex(); // not make_vertex, whose textures take long to compile
    step.vertex.material = draw_resolved_point(scene, kind, alpha, step.vertex.wo);
    Connection c = whitted_connection(scene, params, step, task);
    give(c.value);
    give(c.slot);
    give(c.layer);
    if (!is_black(c.value)) give(c.ray); // nothing to test: the ray has no meaning
}

#endif
