// Rays and what they hit.
#ifndef SNELL_KERNEL_RAY_H
#define SNELL_KERNEL_RAY_H
#include "snell/kernel/lang.h"
SNELL_BEGIN

// Points origin + t * direction with t_min < t < t_max. The direction need not have unit length; t counts in its
// lengths.
struct Ray
{
    vec3 origin;
    float t_min;
    vec3 direction;
    float t_max;
};
SNELL_LAYOUT(Ray, 32)

// Kinds of primitive; they live in the two top bits of Hit::primitive.
SNELL_CONST uint kind_triangle = 0u;
SNELL_CONST uint kind_sphere = 1u;
SNELL_CONST uint kind_plane = 2u;

// The nearest intersection of a ray; a miss has primitive == none.
struct Hit
{
    float t;        // distance along the ray; t_max of the ray if nothing was hit
    float u, v;     // triangle: barycentric weights of its second and third vertex; else 0
    uint primitive; // kind << 30 | index into the packed array of that kind; none: nothing was hit
    uint instance;  // index into the packed instances; none: a primitive that lies in world space
};
SNELL_LAYOUT(Hit, 20)

SNELL_FN uint pack_primitive(uint kind, uint index)
{
    return (kind << 30) | index;
}
SNELL_FN uint primitive_kind(uint primitive)
{
    return primitive >> 30;
}
SNELL_FN uint primitive_index(uint primitive)
{
    return primitive & 0x3fffffffu;
}

SNELL_FN Ray make_ray(vec3 origin, vec3 direction, float t_max)
{
    Ray ray;
    ray.origin = origin;
    ray.t_min = 0.0f;
    ray.direction = direction;
    ray.t_max = t_max;
    return ray;
}

SNELL_FN Hit miss(float t_max)
{
    Hit hit;
    hit.t = t_max;
    hit.u = 0.0f;
    hit.v = 0.0f;
    hit.primitive = none;
    hit.instance = none;
    return hit;
}

SNELL_FN bool is_hit(Hit hit)
{
    return hit.primitive != none;
}

SNELL_FN vec3 ray_at(Ray ray, float t)
{
    return ray.origin + t * ray.direction;
}

SNELL_END
#endif
