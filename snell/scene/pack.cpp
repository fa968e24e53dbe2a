// From the scene that people edit to the flat arrays that kernels read.
//
// First the plan, serially and by object: which groups move into world space, and where in the arrays each mesh of
// each run goes. Then the filling, in parallel and by element. Lights come last, from the finished primitives.
#include "snell/core/parallel.h"
#include "snell/scene/bounds.h"
#include "snell/scene/lights.h"
#include "snell/scene/pack_fill.h"
#include "snell/scene/pack_parts.h"
#include "snell/scene/repose.h"

namespace snell {

static vec3 unit(vec3 n)
{
    const glm::dvec3 v(n);
    const double size = glm::length(v);
    return size > 0.0 ? vec3(v / size) : n;
}

static void fill_geometry(const Scene& scene, const PackPlan& plan, PackedScene& packed)
{
    size_geometry(plan, packed);
    packed.world = plan.world;
    for (const GroupPlacement& group : plan.groups) packed.groups.push_back(group.packed);
    parallel_for(plan.mesh_placements.size(), [&](std::size_t i) {
        const MeshPlacement& placement = plan.mesh_placements[i];
        fill_surfaces(scene, plan, placement, packed);
        fill_triangles(scene, plan, placement, packed);
        fill_vertices(scene, placement, packed);
    });
    parallel_ranges(plan.sphere_placements.size(), 1 << 15, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            packed.spheres[i].light = none;
            fill_sphere(scene, plan, i, packed);
        }
    });
    parallel_ranges(plan.instances.size(), 1 << 12, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) fill_instance(scene, plan, i, packed);
    });
}

void pack_planes(const Scene& scene, PackedScene& packed)
{
    packed.planes.clear();
    for (std::size_t i = 0; i < scene.planes.size(); ++i) {
        const PlaneDesc& desc = scene.planes[i];
        Plane plane = {};
        plane.normal = unit(desc.normal);
        plane.offset = static_cast<float>(glm::dot(glm::dvec3(plane.normal), glm::dvec3(desc.point)));
        plane.material = desc.material.value;
        plane.object = static_cast<uint>(scene.meshes.size() + scene.spheres.size() + i);
        packed.planes.push_back(plane);
    }
}

// All but bounds, lights and environment.
static PackPlan pack_parts(const Scene& scene, const std::vector<std::uint8_t>& stays, PackedScene& packed)
{
    pack_materials(scene, packed);
    pack_images(scene, packed);
    PackPlan plan = plan_pack(scene, packed.materials, stays);
    fill_geometry(scene, plan, packed);
    pack_planes(scene, packed);
    return plan;
}

PackedScene pack(const Scene& scene)
{
    PackedScene packed;
    pack_parts(scene, std::vector<std::uint8_t>(scene.groups.size(), 0), packed);
    fill_bounds(scene_bounds(scene), packed);
    pack_lights(scene, packed);
    EnvironmentCells cells;
    pack_environment(scene, packed, cells);
    return packed;
}

PackedScene pack(const Scene& scene, MotionMap& motion)
{
    PackedScene packed;
    motion = {};
    motion.moving = moving_groups(scene);
    motion.plan = pack_parts(scene, motion.moving, packed);
    survey_motion(scene, packed, motion);
    pack_lights(scene, packed);
    pack_environment(scene, packed, motion.environment);
    return packed;
}

} // namespace snell
