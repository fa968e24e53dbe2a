// The stages of the path tracer.
#ifndef TWIN_CASES
#include "snell/kernel/path.h"
#include "tests/gpu/draw.h"
SNELL_BEGIN
SNELL_FN void give_path_step(PathStep step)
{
    give(step.emitted);
    give(step.layer);
    give(step.has_connection);
    give(step.has_next);
    if (step.has_connection != 0u) give_connection(step.connection);
    if (step.has_next != 0u) give_camera_path(step.next);
}
SNELL_END
#else

TWIN(state_key, 0.0f, 0.0f, 0.0f)
{
    RenderParams params = draw_params();
    PathState state = draw_state();
    SampleKey key = state_key(params, state);
    give(key.kind);
    give(key.pixel);
    give(key.reversed_index);
    give(vertex_dimension(state.depth, state.slot & 3u));
    give(scatter_layer(state.depth));
}
TWIN(generate_camera_path, 1e-5f, 1e-5f, 0.0f)
{
    RenderParams params = draw_params();
    uint x = index_below(2000u);
    uint y = index_below(2000u);
    uint sample_index = word();
    uint slot = word();
    give_camera_path(generate_camera_path(params, x, y, sample_index, slot));
}
TWIN_BUILTIN(make_vertex, 1e-3f, 1e-4f, 0.001f) // the normals switch sides
{
    Ray ray = draw_ray();
    Hit hit = draw_hit();
    vec3 w = direction();
    Vertex v = make_vertex(scene, ray, hit);
    give_surface_point(v.surface);
    give_material_point(v.material);
    give(v.wo);
    give(v.emission);
    give(vertex_eval(v, w));
}
TWIN_BUILTIN(medium, 1e-5f, 1e-6f, 0.0f)
{
    uint material = index_below(scene_materials);
    float way = magnitude(1e-3f, 10.0f);
    uint outside = index_below(2u);
    give(medium_transmittance(scene, material, way));
    give(medium_behind(scene, material, outside == 0u));
}
TWIN_BUILTIN(light_transmittance, 1e-3f, 1e-4f, 0.001f) // the normals switch sides
{
    Ray ray = draw_ray();
    Hit hit = draw_hit();
    uint material = index_below(scene_materials);
    LightSample s = no_light_sample();
    s.direction = direction();
    s.target = point(2.0f);
    s.is_infinite = index_below(4u) == 0u ? 1u : 0u;
    give(light_transmittance(scene, material, make_vertex(scene, ray, hit), s));
}
TWIN(scatter, 1e-3f, 1e-4f, 0.001f) // the same
{
    PathState state = draw_state();
    Ray ray = draw_ray();
    Hit hit = draw_hit();
    BsdfSample s;
    s.wi = direction();
    s.weight = color();
    s.pdf = magnitude(1e-3f, 10.0f);
    s.eta = range(0.5f, 2.0f);
    s.is_delta = index_below(2u);
    give_camera_path(scatter(scene, state, make_vertex(scene, ray, hit), s));
}
TWIN(environment, 1e-6f, 0.0f, 0.0f)
{
    RenderParams params = draw_params();
    float a = magnitude(1e-3f, 10.0f);
    float b = magnitude(1e-3f, 10.0f);
    uint zero = index_below(4u);
    give(environment_radiance(scene, params));
    give(environment_probability(scene, params));
    give(bsdf_sampling_weight(params, zero == 0u ? 0.0f : a, b));
}
TWIN(sample_direct, 1e-3f, 1e-4f, 0.001f) // see sample_light
{
    RenderParams params = draw_params();
    PathState state = draw_state();
    vec3 p = point(4.0f);
    give_light_sample(sample_direct(scene, params, state_key(params, state), state, p));
}
TWIN_BUILTIN(shade_path, 1e-3f, 1e-3f, 0.005f) // all branches of all materials and lights
{
    RenderParams params = draw_params();
    PathState state = draw_state();
    Ray ray = draw_ray();
    Hit hit = draw_hit();
    uint nothing = index_below(16u);
    if (nothing == 0u) hit = miss(ray.t_max);
    give_path_step(shade_path(scene, params, state, ray, hit));
}

#endif
