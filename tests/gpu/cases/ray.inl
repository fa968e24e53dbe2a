// Rays, hits and how primitives are numbered.
#ifndef TWIN_CASES
#include "snell/kernel/ray.h"
#else

TWIN(pack_primitive, 0.0f, 0.0f, 0.0f)
{
    uint kind = index_below(3u);
    uint index = word() & 0x3fffffffu;
    uint any = word();
    give(pack_primitive(kind, index));
    give(primitive_kind(any));
    give(primitive_index(any));
}
TWIN(make_ray, 0.0f, 0.0f, 0.0f)
{
    vec3 origin = point(1e3f);
    vec3 d = direction();
    float t_max = magnitude(1e-3f, 1e6f);
    give(make_ray(origin, d, t_max));
}
TWIN(miss, 0.0f, 0.0f, 0.0f)
{
    float t_max = magnitude(1e-3f, 1e6f);
    uint primitive = word();
    Hit hit = miss(t_max);
    give(hit);
    give(is_hit(hit));
    hit.primitive = primitive;
    give(is_hit(hit));
}
TWIN(ray_at, 1e-6f, 1e-3f, 0.0f) // origin and t * direction may cancel: 1e-6 of their size, 1000
{
    vec3 origin = point(1e3f);
    vec3 d = direction();
    float t = range(0.0f, 1e3f);
    give(ray_at(make_ray(origin, d, infinity()), t));
}

#endif
