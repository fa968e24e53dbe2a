// Ambient occlusion and the debug views.
#ifndef TWIN_CASES
#include "snell/kernel/views.h"
#include "tests/gpu/draw.h"
#else

TWIN(heat_color, 1e-5f, 1e-5f, 0.0f)
{
    float x = range(-0.5f, 1.5f);
    give(heat_color(x));
}
TWIN(id_color, 0.0f, 1e-6f, 0.0f)
{
    uint id = word();
    give(id_color(id));
}
TWIN(material_albedo, 1e-4f, 1e-5f, 0.0f)
{
    uint kind = index_below(material_kinds);
    MaterialPoint m = draw_material_point(kind, 0.5f);
    m.principled.albedo = color();
    give(material_albedo(m));
}
TWIN_BUILTIN(view_value, 1e-3f, 1e-3f, 0.001f) // fract of a texture coordinate jumps
{
    RenderParams params = draw_params();
    uint view = index_below(view_count);
    Ray ray = draw_ray();
    Hit hit = draw_hit();
    uint steps = index_below(300u);
    uint nothing = index_below(16u);
    if (nothing == 0u) hit = miss(ray.t_max);
    give(view_value(scene, params, view, ray, hit, steps));
}
TWIN(ambient_connection, 1e-3f, 1e-3f, 0.001f) // a direction in the surface
{
    RenderParams params = draw_params();
    PathState state = draw_state();
    Ray ray = draw_ray();
    Hit hit = draw_hit();
    give_connection(ambient_connection(scene, params, state, ray, hit));
}
TWIN_BUILTIN(first_hit, 1e-3f, 1e-4f, 0.001f) // the normals switch sides
{
    Ray ray = draw_ray();
    Hit hit = draw_hit();
    FirstHit f = first_hit(scene, ray, hit);
    give(f.albedo);
    give(f.normal);
    give(f.geometric_normal);
    give(f.position);
    give(f.uv);
    give(f.depth);
    give(f.object);
    give(f.material);
}
TWIN_BUILTIN(look_through, 1e-3f, 1e-3f, 0.002f) // see sample_bsdf
{
    RenderParams params = draw_params();
    PathState state = draw_state();
    Ray ray = draw_ray();
    Hit hit = draw_hit();
    LookThrough seen = look_through(scene, params, state, ray, hit);
    give(seen.ok);
    if (seen.ok != 0u) give_camera_path(seen.path);
}

#endif
