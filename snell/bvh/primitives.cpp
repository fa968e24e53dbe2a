#include "snell/bvh/primitives.h"

#include "snell/bvh/big_pages.h"
#include "snell/core/parallel.h"
#include "snell/kernel/bounds.h"

#include <algorithm>
#include <atomic>

namespace snell {

static constexpr std::size_t grain = 16384;

static PrimitiveRef make_ref(const Aabb& box, std::size_t index, RefKind kind)
{
    return {box.lower, static_cast<uint>(index), box.upper, kind};
}

static bool is_bounded(const PrimitiveRef& ref)
{
    return is_finite3(ref.lower) && is_finite3(ref.upper);
}

static void remove_unbounded(std::vector<PrimitiveRef>& refs)
{
    std::erase_if(refs, [](const PrimitiveRef& ref) { return !is_bounded(ref); });
}

static PrimitiveRef triangle_ref(const PackedScene& scene, std::size_t index)
{
    const Triangle& tri = scene.triangles[index];
    const Aabb box = triangle_bounds(scene.positions[tri.v0], scene.positions[tri.v1], scene.positions[tri.v2]);
    return make_ref(box, index, RefKind::triangle);
}

Box sphere_box(const Sphere& ball)
{
    const Aabb box = sphere_bounds(ball.center, ball.radius);
    return {box.lower, box.upper};
}

static PrimitiveRef sphere_ref(const PackedScene& scene, std::size_t index)
{
    const Sphere& ball = scene.spheres[index];
    return make_ref(sphere_bounds(ball.center, ball.radius), index, RefKind::sphere);
}

std::vector<PrimitiveRef> collect_primitives(const PackedScene& scene, const PackedGroup& group)
{
    const std::size_t triangles = group.triangle_count;
    auto refs = make_big<PrimitiveRef>(triangles + group.sphere_count);
    std::atomic<bool> all_bounded = true;
    parallel_ranges(refs.size(), grain, [&](std::size_t begin, std::size_t end) {
        bool bounded = true;
        for (std::size_t i = begin; i < end; ++i) {
            refs[i] = i < triangles ? triangle_ref(scene, group.first_triangle + i)
                                    : sphere_ref(scene, group.first_sphere + (i - triangles));
            bounded = bounded && is_bounded(refs[i]);
        }
        if (!bounded) all_bounded = false;
    });
    if (!all_bounded) remove_unbounded(refs);
    return refs;
}

static PrimitiveRef instance_ref(const PackedScene& scene, const std::vector<Box>& group_boxes, std::size_t index)
{
    const Instance& instance = scene.instances[index];
    const Box& box = group_boxes[instance.group];
    return make_ref(instance_bounds(instance.to_world, {box.lower, box.upper}), index, RefKind::instance);
}

void collect_instances(const PackedScene& scene, const std::vector<Box>& group_boxes, std::vector<PrimitiveRef>& refs)
{
    const std::size_t first = refs.size();
    refs.resize(first + scene.instances.size());
    parallel_ranges(scene.instances.size(), grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) refs[first + i] = instance_ref(scene, group_boxes, i);
    });
    remove_unbounded(refs);
}

} // namespace snell
