// Tangent frames and normal maps.
#ifndef TWIN_CASES
#include "snell/kernel/tangent.h"
#include "tests/gpu/draw.h"
#else

TWIN(triangle_tangents, 1e-4f, 1e-5f, 0.001f) // texture coordinates that nearly lie on a line
{
    Hit hit = draw_hit();
    uint uv_set = index_below(2u);
    hit.primitive = pack_primitive(kind_triangle, primitive_index(hit.primitive));
    Tangents t = triangle_tangents(scene, hit, uv_set);
    give(t.u);
    give(t.v);
}
TWIN_BUILTIN(surface_tangents, 1e-3f, 1e-3f, 0.001f) // the same
{
    Ray ray = draw_ray();
    Hit hit = draw_hit();
    uint uv_set = index_below(2u);
    Tangents t = surface_tangents(scene, surface_point(scene, ray, hit), hit, uv_set);
    give(t.u);
    give(t.v);
}
TWIN(make_tangent_frame, 1e-3f, 1e-3f, 0.001f) // a tangent next to the normal
{
    vec3 n = direction();
    vec3 tangent = 3.0f * direction();
    Frame frame = make_tangent_frame(n, tangent);
    give(frame.s);
    give(frame.t);
    give(frame.n);
}
TWIN(visible_normal, 1e-3f, 1e-3f, 0.003f) // next to where it starts to turn; mirrored into the opposite direction
{
    vec3 m = direction();
    vec3 n = direction();
    vec3 geometric_normal = direction();
    vec3 back = direction();
    if (dot(n, back) < 0.0f) n = -n;
    if (dot(geometric_normal, back) < 0.0f) geometric_normal = -geometric_normal;
    give(visible_normal(m, n, geometric_normal, back));
}
TWIN_BUILTIN(mapped_normal, 1e-3f, 1e-3f, 0.003f) // the normals switch sides
{
    Ray ray = draw_ray();
    Hit hit = draw_hit();
    uint slot = index_below(scene_slots);
    float scale = range(-2.0f, 2.0f);
    give(mapped_normal(scene, surface_point(scene, ray, hit), hit, slot, scale, -normalize(ray.direction)));
}

#endif
