// Rays against primitives.
#ifndef TWIN_CASES
#include "snell/kernel/intersect.h"
#include "tests/gpu/draw.h"
SNELL_BEGIN
SNELL_FN void give_intersection(Intersection r)
{
    give(r.ok);
    give(r.t);
    give(r.u);
    give(r.v);
}
// A ray towards a point of the plane of the triangle: inside, outside, on an edge or at a vertex.
SNELL_FN_COLD Ray draw_ray_toward(vec3 v0, vec3 v1, vec3 v2)
{
    vec3 origin = point(4.0f);
    float u = range(-0.5f, 1.0f);
    float v = range(-0.5f, 1.0f);
    return make_ray(origin, (v0 + u * (v1 - v0) + v * (v2 - v0)) - origin, infinity());
}
SNELL_END
#else

TWIN(longest_axis, 0.0f, 0.0f, 0.0f)
{
    give(uint(longest_axis(direction())));
}
TWIN(no_intersection, 0.0f, 0.0f, 0.0f)
{
    float t_max = magnitude(1e-3f, 1e6f);
    give_intersection(no_intersection(t_max));
}
TWIN(is_traceable, 0.0f, 0.0f, 0.0f) // rays of any bits
{
    Ray ray = draw_ray();
    uint spoilt = index_below(8u);
    uint bits = word();
    uint exponent = index_below(2u) * 0x7f800000u;
    if (spoilt == 0u) ray.origin.y = uintBitsToFloat(bits | exponent);
    if (spoilt == 1u) ray.direction.z = uintBitsToFloat(bits | exponent);
    if (spoilt == 2u) ray.direction = vec3(0.0f);
    if (spoilt == 3u) ray.t_min = uintBitsToFloat(bits | exponent);
    if (spoilt == 4u) ray.t_max = uintBitsToFloat(bits | exponent);
    give(is_traceable(ray));
}
TWIN(shear_ray, 3e-7f, 0.0f, 0.0f)
{
    Ray ray = draw_ray();
    if (!is_traceable(ray)) ray.direction.x = 1.0f;
    ShearedRay s = shear_ray(ray);
    give(s.kx);
    give(s.ky);
    give(s.kz);
    give(s.sx);
    give(s.sy);
    give(s.sz);
}
TWIN(product_error, 0.0f, 0.0f, 0.0f) // worthless if fused or reordered
{
    float a = range(-1e3f, 1e3f);
    float b = range(-1e3f, 1e3f);
    give(product_error(a, b, a * b));
}
TWIN(edge_function, 0.0f, 0.0f, 0.0f)
{
    float a = range(-1e3f, 1e3f);
    float b = range(-1e3f, 1e3f);
    float c = range(-1e3f, 1e3f);
    uint close = index_below(2u); // a * b against b * a', with a' next to a
    give(edge_function(a, b, close == 0u ? b : c, close == 0u ? uintBitsToFloat(floatBitsToUint(a) ^ 1u) : c));
}
TWIN(intersect_triangle_watertight, 1e-4f, 1e-5f, 0.001f) // rays along edges and slivers
{
    vec3 v0 = point(2.0f);
    vec3 v1 = point(2.0f);
    vec3 v2 = point(2.0f);
    Ray ray = draw_ray_toward(v0, v1, v2);
    if (!is_traceable(ray)) ray.direction.x = 1.0f;
    give_intersection(intersect_triangle_watertight(ray, shear_ray(ray), v0, v1, v2));
}
TWIN(intersect_triangle_moller_trumbore, 1e-4f, 1e-5f, 0.001f) // the same
{
    vec3 v0 = point(2.0f);
    vec3 v1 = point(2.0f);
    vec3 v2 = point(2.0f);
    Ray ray = draw_ray_toward(v0, v1, v2);
    give_intersection(intersect_triangle_moller_trumbore(ray, v0, v1, v2));
}
TWIN(intersect_sphere, 1e-4f, 1e-5f, 0.001f) // tangents
{
    vec3 center = point(2.0f);
    float radius = magnitude(1e-2f, 3.0f);
    Ray ray = draw_ray();
    if (!is_traceable(ray)) ray.direction.x = 1.0f;
    give_intersection(intersect_sphere(ray, center, radius));
}
TWIN(intersect_plane, 1e-4f, 1e-5f, 0.001f) // rays along the plane
{
    vec3 normal = direction();
    float offset = range(-2.0f, 2.0f);
    Ray ray = draw_ray();
    give_intersection(intersect_plane(ray, normal, offset));
}
TWIN(ray_to_object, 1e-6f, 1e-5f, 0.0f)
{
    uint i = index_below(scene_instances);
    Ray ray = draw_ray();
    give(ray_to_object(ray, scene.instances.at[i].to_object));
}
TWIN(intersect_primitive, 1e-4f, 1e-5f, 0.001f) // as its parts
{
    Hit hit = draw_hit();
    uint test = index_below(2u);
    Ray ray = draw_ray();
    if (!is_traceable(ray)) ray.direction.x = 1.0f;
    give_intersection(intersect_primitive_by(scene, hit.primitive, ray, shear_ray(ray), test));
    give_intersection(intersect_primitive(scene, hit.primitive, ray));
}
TWIN(is_better_hit, 0.0f, 0.0f, 0.0f)
{
    Hit found = draw_hit();
    float t = index_below(2u) == 0u ? found.t : 1.0f;
    uint primitive = index_below(2u) == 0u ? found.primitive : 5u;
    uint instance = index_below(3u);
    if (instance == 0u) instance = none;
    give(is_better_hit(t, primitive, instance, found));
    give(is_later_hit(t, primitive, instance, found));
}

#endif
