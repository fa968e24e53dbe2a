// How much room a scene and its parts take.
#include "snell/scene/bounds.h"

#include "snell/core/parallel.h"

#include <cmath>
#include <mutex>
#include <optional>

namespace snell {

void extend(Bounds& bounds, const Bounds& other)
{
    bounds.lower = min(bounds.lower, other.lower);
    bounds.upper = max(bounds.upper, other.upper);
}

static Bounds mesh_bounds(const Mesh& mesh, const Transform& transform)
{
    Bounds all;
    std::mutex mutex;
    // By triangle: vertices that no triangle uses are not seen.
    parallel_ranges(mesh.triangles.size(), 1 << 14, [&](std::size_t begin, std::size_t end) {
        Bounds some;
        for (std::size_t i = begin; i < end; ++i) {
            const uvec3 triangle = mesh.triangles[i];
            for (int k = 0; k < 3; ++k) {
                if (triangle[k] >= mesh.positions.size()) continue;
                const vec3 p = transform_point(transform, mesh.positions[triangle[k]]);
                if (is_finite3(p)) some.extend(p);
            }
        }
        const std::lock_guard lock(mutex);
        extend(all, some);
    });
    return all;
}

static Bounds sphere_bounds(const SphereDesc& sphere, const Transform& m)
{
    Bounds bounds;
    const vec3 center = transform_point(m, sphere.center);
    const vec3 half =
        std::abs(sphere.radius) *
        vec3(length(vec3(m.x.x, m.x.y, m.x.z)), length(vec3(m.y.x, m.y.y, m.y.z)), length(vec3(m.z.x, m.z.y, m.z.z)));
    if (!is_finite3(center) || !is_finite3(half)) return bounds;
    bounds.extend(center - half);
    bounds.extend(center + half);
    return bounds;
}

Bounds group_bounds(const Scene& scene, const Group& group, const Transform& transform)
{
    Bounds bounds;
    for (const Index<Mesh> mesh : group.meshes)
        if (mesh.value < scene.meshes.size()) extend(bounds, mesh_bounds(scene.meshes[mesh.value], transform));
    for (const Index<SphereDesc> sphere : group.spheres)
        if (sphere.value < scene.spheres.size()) extend(bounds, sphere_bounds(scene.spheres[sphere.value], transform));
    return bounds;
}

Bounds transformed(const Bounds& bounds, const Transform& transform)
{
    Bounds result;
    if (bounds.empty()) return result;
    for (int corner = 0; corner < 8; ++corner) {
        const vec3 p(corner & 1 ? bounds.upper.x : bounds.lower.x, corner & 2 ? bounds.upper.y : bounds.lower.y,
                     corner & 4 ? bounds.upper.z : bounds.lower.z);
        const vec3 q = transform_point(transform, p);
        if (is_finite3(q)) result.extend(q);
    }
    return result;
}

Bounds scene_bounds(const Scene& scene)
{
    std::vector<std::size_t> uses(scene.groups.size(), 0);
    for (const InstanceDesc& instance : scene.instances)
        if (instance.group.value < uses.size()) ++uses[instance.group.value];

    // A group that is placed so often that visiting each of its primitives each time would take long is bounded by
    // its transformed box, which is a little larger.
    constexpr std::size_t visits = 1 << 22;
    std::vector<std::optional<Bounds>> boxes(scene.groups.size());
    for (std::size_t g = 0; g < scene.groups.size(); ++g) {
        if (uses[g] < 2) continue;
        std::size_t size = 1 + scene.groups[g].spheres.size();
        for (const Index<Mesh> mesh : scene.groups[g].meshes)
            if (mesh.value < scene.meshes.size()) size += 1 + scene.meshes[mesh.value].triangles.size();
        if (size > visits / uses[g]) boxes[g] = group_bounds(scene, scene.groups[g], identity_transform());
    }

    Bounds bounds;
    for (const InstanceDesc& instance : scene.instances) {
        const uint g = instance.group.value;
        if (g >= scene.groups.size()) continue;
        extend(bounds, boxes[g] ? transformed(*boxes[g], instance.transform)
                                : group_bounds(scene, scene.groups[g], instance.transform));
    }
    return bounds;
}

} // namespace snell
