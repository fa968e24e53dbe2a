#include "snell/bvh/primitives.h"

#include "snell/bvh/big_pages.h"
#include "snell/core/parallel.h"

#include <algorithm>
#include <atomic>

namespace snell {

static constexpr std::size_t grain = 16384;

// Adding 0 turns -0 into +0: min and max of the two depend on the order, and builds must not.
static PrimitiveRef make_ref(vec3 lower, vec3 upper, std::size_t index, RefKind kind)
{
    return {lower + 0.0f, static_cast<uint>(index), upper + 0.0f, kind};
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
    const vec3 a = scene.positions[tri.v0], b = scene.positions[tri.v1], c = scene.positions[tri.v2];
    PrimitiveRef ref = make_ref(min(a, min(b, c)), max(a, max(b, c)), index, RefKind::triangle);
    // min and max may swallow a NaN, so ask the vertices themselves.
    if (!is_finite3(a) || !is_finite3(b) || !is_finite3(c)) ref.lower.x = infinity();
    return ref;
}

// The next float away from x, so that rounding never cuts into the sphere.
static float outwards(float x, float away)
{
    return std::nextafter(x, away);
}

Box sphere_box(const Sphere& ball)
{
    Box box;
    for (int axis = 0; axis < 3; ++axis) {
        box.lower[axis] = outwards(ball.center[axis] - std::abs(ball.radius), -infinity()) + 0.0f;
        box.upper[axis] = outwards(ball.center[axis] + std::abs(ball.radius), infinity()) + 0.0f;
    }
    return is_finite3(box.lower) && is_finite3(box.upper) ? box : Box();
}

static PrimitiveRef sphere_ref(const PackedScene& scene, std::size_t index)
{
    const Box box = sphere_box(scene.spheres[index]);
    return make_ref(box.lower, box.upper, index, RefKind::sphere);
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
    if (box.empty()) return make_ref(vec3(infinity()), vec3(infinity()), index, RefKind::instance);
    Box world;
    float reach = 0.0f; // the largest number that takes part in the transformation
    bool finite = true;
    for (int corner = 0; corner < 8; ++corner) {
        const vec3 p((corner & 1) ? box.upper.x : box.lower.x, (corner & 2) ? box.upper.y : box.lower.y,
                     (corner & 4) ? box.upper.z : box.lower.z);
        const vec3 q = transform_point(instance.to_world, p);
        finite = finite && is_finite3(q);
        world.extend(q);
        reach = std::max(reach, max3(abs(q)));
    }
    reach = std::max(
        {reach, std::abs(instance.to_world.x.w), std::abs(instance.to_world.y.w), std::abs(instance.to_world.z.w)});
    if (!finite) world.lower.x = infinity();
    const vec3 slack(reach * 0x1p-20f);
    return make_ref(world.lower - slack, world.upper + slack, index, RefKind::instance);
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
