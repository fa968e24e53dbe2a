// Rays and hits in Embree's words; only where it is installed (SNELL_HAS_EMBREE).
#pragma once

#include "snell/bvh/simd/ray_state.h"
#include "snell/scene/packed.h"

#include <embree3/rtcore.h>

namespace snell {

// Embree's interval includes its end and does not reach below 0: t_min must not be negative.
inline RTCRay to_embree(const Ray& ray)
{
    RTCRay r{};
    r.org_x = ray.origin.x, r.org_y = ray.origin.y, r.org_z = ray.origin.z;
    r.dir_x = ray.direction.x, r.dir_y = ray.direction.y, r.dir_z = ray.direction.z;
    r.tnear = ray.t_min;
    r.tfar = float_before(ray.t_max);
    r.mask = 0xffffffffu;
    return r;
}

// A question about the nearest hit.
inline RTCRayHit to_query(const Ray& ray)
{
    RTCRayHit query{to_embree(ray), {}};
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    return query;
}

// What Embree's numbers of an instance, a geometry and a primitive of an EmbreeScene are in a Hit.
inline uint instance_of_embree(uint instance)
{
    return instance == RTC_INVALID_GEOMETRY_ID ? none : instance - 2;
}
inline uint primitive_of_embree(const PackedScene& scene, uint instance, uint geometry, uint primitive)
{
    const PackedGroup& group =
        instance == RTC_INVALID_GEOMETRY_ID ? scene.world : scene.groups[scene.instances[instance - 2].group];
    return geometry == 0 ? pack_primitive(kind_triangle, group.first_triangle + primitive)
                         : pack_primitive(kind_sphere, group.first_sphere + primitive);
}

// The answer of a query, for a ray that ended at t_max; a sphere's has u and v 0.
inline Hit to_hit(const PackedScene& scene, const RTCRayHit& answer, float t_max)
{
    const RTCHit& h = answer.hit;
    if (h.geomID == RTC_INVALID_GEOMETRY_ID) return miss(t_max);
    return {answer.ray.tfar, h.u, h.v, primitive_of_embree(scene, h.instID[0], h.geomID, h.primID),
            instance_of_embree(h.instID[0])};
}

} // namespace snell
