// Boxes of primitives and instances.
#ifndef TWIN_CASES
#include "snell/kernel/bounds.h"
#include "tests/gpu/draw_boxes.h"
#else

TWIN(aabb, 1e-6f, 0.0f, 0.0f) // products of the area are fused in C++
{
    Aabb a = draw_aabb(10.0f);
    Aabb b = draw_aabb(10.0f);
    float scale = magnitude(1e-3f, 1e3f);
    give_aabb(empty_aabb());
    give_aabb(join(a, b));
    give_aabb(join(a, empty_aabb()));
    give(is_empty(a));
    give(is_empty(empty_aabb()));
    give(half_area(a, scale));
    give(half_area(empty_aabb(), scale));
}
TWIN(float_neighbours, 0.0f, 0.0f, 0.0f)
{
    float x = magnitude(1e-30f, 1e30f);
    uint turn = index_below(2u);
    if (turn == 1u) x = -x;
    give(float_before(x));
    give(float_after(x));
}
TWIN(primitive_bounds, 0.0f, 0.0f, 0.0f)
{
    vec3 a = point(100.0f);
    vec3 b = point(100.0f);
    vec3 c = point(100.0f);
    float radius = magnitude(1e-3f, 1e3f);
    uint broken = index_below(8u);
    if (broken == 0u) b.y = infinity();
    uint flat_one = index_below(4u);
    if (flat_one == 0u) a.x = -0.0f;
    give(plain_zero(a));
    give_aabb(triangle_bounds(a, b, c));
    give_aabb(sphere_bounds(a, radius));
    give_aabb(sphere_bounds(b, radius));
}
TWIN_BUILTIN(instance_bounds, 1e-6f, 1e-6f, 0.0f)
{
    uint i = index_below(scene_instances);
    Aabb box = draw_aabb(10.0f);
    give_aabb(instance_bounds(scene.instances.at[i].to_world, box));
    give_aabb(instance_bounds(scene.instances.at[i].to_world, empty_aabb()));
}

#endif
