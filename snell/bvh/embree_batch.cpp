#ifdef SNELL_HAS_EMBREE
#include "snell/bvh/embree_batch.h"

#include "snell/bvh/embree_rays.h"

#include <cstddef>
#include <type_traits>

namespace snell {

Intersection meet_primitive(const EmbreeBatch& batch, uint lane, uint primitive, uint instance, const Ray& ray,
                            const ShearedRay& shear)
{
    Intersection r = intersect_primitive_by(*batch.view, primitive, ray, shear, batch.test);
    if (r.ok && batch.after != nullptr && !is_later_hit(r.t, primitive, instance, batch.after[lane])) {
        Ray onward = ray; // the far side of a sphere may be
        onward.t_min = r.t;
        r = intersect_primitive_by(*batch.view, primitive, onward, shear, batch.test);
    }
    return r;
}

namespace {

// The hit of a lane that Embree has found, as it counts here. Where our test says no because it rounds an edge the
// other way, Embree's word is taken, or there would be a hole.
bool settle(EmbreeBatch& batch, uint lane, uint primitive, uint instance, float embree_t, float u, float v)
{
    Ray ray = batch.rays[lane];
    ShearedRay shear = batch.shears[lane];
    if (instance != none) {
        ray = ray_to_object(ray, batch.scene->instances[instance].to_object);
        if (!is_traceable(ray)) return false;
        shear = shear_ray(ray);
    }
    Intersection r = meet_primitive(batch, lane, primitive, instance, ray, shear);
    if (!r.ok) {
        if (primitive_kind(primitive) != kind_triangle) return false;
        Ray line = ray;
        line.t_min = -infinity(), line.t_max = infinity();
        if (intersect_primitive_by(*batch.view, primitive, line, shear, batch.test).ok) return false;
        const EmbreeLane& map = batch.lanes[lane];
        r = {embree_t * map.scale + map.start, u, v, true};
        if (!(r.t > ray.t_min && r.t < ray.t_max)) return false;
        if (batch.after != nullptr && !is_later_hit(r.t, primitive, instance, batch.after[lane])) return false;
    }
    if (!is_better_hit(r.t, primitive, instance, batch.hits[lane])) return false;
    batch.hits[lane] = {r.t, r.u, r.v, primitive, instance};
    return true;
}

} // namespace

void settle_hits(const RTCFilterFunctionNArguments* a)
{
    static_assert(std::is_standard_layout_v<EmbreeBatch> && offsetof(EmbreeBatch, context) == 0);
    EmbreeBatch& batch = *reinterpret_cast<EmbreeBatch*>(a->context);
    for (uint i = 0; i < a->N; ++i) {
        if (a->valid[i] == 0) continue;
        const uint lane = RTCRayN_id(a->ray, a->N, i);
        const uint instance = RTCHitN_instID(a->hit, a->N, i, 0);
        const uint primitive = primitive_of_embree(*batch.scene, instance, RTCHitN_geomID(a->hit, a->N, i),
                                                   RTCHitN_primID(a->hit, a->N, i));
        float& end = RTCRayN_tfar(a->ray, a->N, i);
        if (settle(batch, lane, primitive, instance_of_embree(instance), end, RTCHitN_u(a->hit, a->N, i),
                   RTCHitN_v(a->hit, a->N, i)))
            end = a_little_later(batch.lanes[lane].to_embree(batch.hits[lane].t));
        else
            a->valid[i] = 0;
    }
}

} // namespace snell
#endif
