// The parts of the path tracer's stages.
#ifndef TWIN_CASES
#include "snell/kernel/path.h"
#include "tests/gpu/draw.h"
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
    uint material = index_below(scene_materials);
    LightSample s = no_light_sample();
    s.direction = direction();
    s.target = point(2.0f);
    s.is_infinite = index_below(4u) == 0u ? 1u : 0u;
    give(light_transmittance(scene, material, draw_vertex(), s));
}
TWIN(scatter, 1e-3f, 1e-4f, 0.001f) // the same
{
    PathState state = draw_state();
    BsdfSample s;
    s.wi = direction();
    s.weight = color();
    s.pdf = magnitude(1e-3f, 10.0f);
    s.eta = range(0.5f, 2.0f);
    s.is_delta = index_below(2u);
    give_camera_path(scatter(scene, state, draw_vertex(), s));
}
TWIN_BUILTIN(escaped, 1e-3f, 1e-3f, 0.002f) // see environment_radiance and pdf_environment
{
    RenderParams params = draw_params();
    SceneView s = draw_environment(scene);
    vec3 w = direction();
    uint depth = index_below(3u);
    float a = magnitude(1e-3f, 10.0f);
    float b = magnitude(1e-3f, 10.0f);
    uint zero = index_below(4u);
    give(escaped_radiance(s, params, depth, w));
    give(escaped_pdf(s, params, w));
    give(environment_probability(s, params));
    give(bsdf_sampling_weight(params, zero == 0u ? 0.0f : a, b));
}
TWIN(seeds, 0.0f, 0.0f, 0.0f)
{
    PathState state = draw_state();
    give(extension_seed(state));
    give(connection_seed(state));
}
TWIN_BUILTIN(sample_direct, 1e-3f, 1e-3f, 0.005f) // see sample_environment
{
    SceneView s = draw_environment(scene);
    RenderParams params = draw_params();
    PathState state = draw_state();
    vec3 p = point(4.0f);
    give_light_sample(sample_direct(s, params, state_key(params, state), state, p));
}
#endif
