// A hit, ready for scattering.
#ifndef TWIN_CASES
#include "snell/kernel/path_state.h"
#include "tests/gpu/draw_principled.h"
#else

TWIN_BUILTIN(make_vertex, 1e-3f, 1e-3f, 0.005f) // the normals switch sides; the nearest texel changes
{
    Ray ray = draw_ray();
    Hit hit = draw_hit();
    vec3 w = direction();
    ray.direction = normalize(ray.direction);
    Vertex v = make_vertex(scene, ray, hit);
    give_surface_point(v.surface);
    give_material_point(v.material);
    if (v.material.kind == material_principled) give_resolved(v.material.principled);
    give(v.wo);
    give(v.emission);
    give(vertex_eval(v, w));
}
TWIN_BUILTIN(bent_frame, 1e-3f, 1e-3f, 0.005f) // see mapped_normal
{
    Ray ray = draw_ray();
    Hit hit = draw_hit();
    Frame frame = bent_frame(scene, surface_point(scene, ray, hit), hit, -normalize(ray.direction));
    give(frame.s);
    give(frame.t);
    give(frame.n);
}

#endif
