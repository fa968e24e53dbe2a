#include "snell/scene/repose.h"

#include "snell/core/error.h"
#include "snell/core/parallel.h"
#include "snell/scene/bounds.h"
#include "snell/scene/pack_fill.h"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <mutex>

namespace snell {

static bool same(const Transform& a, const Transform& b)
{
    return std::memcmp(&a, &b, sizeof(Transform)) == 0;
}

// ---- bounds ----

static Bounds box_of(const Scene& scene, uint baked)
{
    const InstanceDesc& instance = scene.instances[baked];
    return group_bounds(scene, scene.groups[instance.group.value], instance.transform);
}

static Bounds box_of(const Scene& scene, const GroupPlacement& group)
{
    return group_bounds(scene, scene.groups[group.group], identity_transform());
}

static Bounds bounds_of_all(const PackedScene& packed, const MotionMap& motion)
{
    Bounds all;
    for (const Bounds& box : motion.baked_boxes) extend(all, box);
    std::mutex mutex;
    parallel_ranges(packed.instances.size(), 1 << 12, [&](std::size_t begin, std::size_t end) {
        Bounds some;
        for (std::size_t i = begin; i < end; ++i)
            extend(some, transformed(motion.boxes[packed.instances[i].group], packed.instances[i].to_world));
        const std::lock_guard lock(mutex);
        extend(all, some);
    });
    return all;
}

// ---- the first time ----

static bool has_lights(const PackedScene& packed, const MotionMap& motion, const MeshPlacement& placement)
{
    const std::size_t count = motion.plan.meshes[placement.mesh].runs.size();
    const auto first = packed.surfaces.begin() + placement.first_surface;
    return std::any_of(first, first + static_cast<std::ptrdiff_t>(count),
                       [&](const Surface& s) { return !is_black(packed.materials[s.material].emission); });
}

static bool has_lights(const PackedScene& packed, const Sphere& sphere)
{
    return !is_black(packed.materials[sphere.material].emission);
}

void survey_motion(const Scene& scene, PackedScene& packed, MotionMap& motion)
{
    const PackPlan& plan = motion.plan;
    motion.rigged.assign(scene.meshes.size(), 0);
    for (const Rig& rig : scene.rigs) motion.rigged[rig.mesh.value] = 1;
    motion.textured = textured_materials(packed.materials);
    motion.counts = counts_of(scene);
    for (const uint i : plan.baked) {
        motion.baked.push_back(scene.instances[i].transform);
        motion.baked_boxes.push_back(box_of(scene, i));
    }
    for (const GroupPlacement& group : plan.groups) motion.boxes.push_back(box_of(scene, group));
    fill_bounds(bounds_of_all(packed, motion), packed);
    find_shining(packed, motion);
}

std::array<std::size_t, 4> counts_of(const Scene& scene)
{
    return {scene.meshes.size(), scene.spheres.size(), scene.groups.size(), scene.instances.size()};
}

void find_shining(const PackedScene& packed, MotionMap& motion)
{
    motion.shines.assign(motion.plan.groups.size(), 0);
    for (const MeshPlacement& placement : motion.plan.mesh_placements)
        if (placement.group != none && has_lights(packed, motion, placement)) motion.shines[placement.group] = 1;
    for (std::size_t g = 0; g < packed.groups.size(); ++g) {
        const auto first = packed.spheres.begin() + packed.groups[g].first_sphere;
        if (std::any_of(first, first + packed.groups[g].sphere_count,
                        [&](const Sphere& sphere) { return has_lights(packed, sphere); }))
            motion.shines[g] = 1;
    }
}

// ---- what has changed ----

namespace {
class Reposer
{
  public:
    Reposer(const Scene& scene, PackedScene& packed, MotionMap& motion)
        : scene_(scene), packed_(packed), motion_(motion), moved_(scene.instances.size(), 0),
          groups_(packed.groups.size(), 0)
    {
    }

    PackedChanges run(bool shapes, bool& lights)
    {
        find_moved();
        write_meshes();
        write_world_spheres(shapes);
        if (shapes) write_group_spheres();
        write_instances();
        for (std::size_t g = 0; g < groups_.size(); ++g)
            if (groups_[g] != 0) changes_.groups.push_back(static_cast<uint>(g));
        write_bounds();
        lights |= lights_change_;
        return changes_;
    }

  private:
    void find_moved();
    void write_meshes();
    void write_world_spheres(bool all);
    void write_group_spheres();
    void write_instances();
    void write_bounds();

    const Scene& scene_;
    PackedScene& packed_;
    MotionMap& motion_;
    PackedChanges changes_;
    std::vector<std::uint8_t> moved_;  // by instance of the scene: it lies in world space, and otherwise than before
    std::vector<std::uint8_t> groups_; // by packed group: it has changed its shape
    bool some_moved_ = false, lights_change_ = false;
};
} // namespace

void Reposer::find_moved()
{
    for (std::size_t i = 0; i < motion_.plan.baked.size(); ++i) {
        const uint instance = motion_.plan.baked[i];
        const Transform& transform = scene_.instances[instance].transform;
        if (same(transform, motion_.baked[i])) continue;
        motion_.baked[i] = transform;
        moved_[instance] = 1;
        some_moved_ = true;
    }
}

void Reposer::write_meshes()
{
    const PackPlan& plan = motion_.plan;
    std::vector<uint> suspects; // placements
    for (uint i = 0; i < plan.mesh_placements.size(); ++i) {
        const MeshPlacement& p = plan.mesh_placements[i];
        if (motion_.rigged[p.mesh] != 0 || (p.baked != none && moved_[p.baked] != 0)) suspects.push_back(i);
    }
    // Placements in object space share their vertices: one writes them, and all have to know.
    std::vector<VertexChanges> found(suspects.size()), shared(scene_.meshes.size());
    parallel_for(suspects.size(), [&](std::size_t i) {
        const MeshPlacement& p = plan.mesh_placements[suspects[i]];
        found[i] = fill_vertices(scene_, p, packed_);
        if (p.baked == none && p.writes_vertices) shared[p.mesh] = found[i];
    });
    std::vector<std::uint8_t> changed(suspects.size(), 0);
    parallel_for(suspects.size(), [&](std::size_t i) {
        const MeshPlacement& p = plan.mesh_placements[suspects[i]];
        const VertexChanges vertices = p.baked == none ? shared[p.mesh] : found[i];
        bool shape = vertices.positions;
        // The winding follows the normals, and mirrors.
        if (shape || vertices.normals || p.baked != none) shape |= fill_triangles(scene_, plan, p, packed_);
        if (shape) changed[i] = 1;
    });
    for (std::size_t i = 0; i < suspects.size(); ++i) {
        if (changed[i] == 0) continue;
        const MeshPlacement& p = plan.mesh_placements[suspects[i]];
        if (p.group == none)
            changes_.world = true, moved_[p.baked] = 1;
        else
            groups_[p.group] = 1;
        lights_change_ |= has_lights(packed_, motion_, p);
    }
}

void Reposer::write_world_spheres(bool all)
{
    if (!some_moved_ && !all) return;
    for (std::size_t i = 0; i < packed_.world.sphere_count; ++i) {
        const uint baked = motion_.plan.sphere_placements[i].baked;
        if (moved_[baked] == 0 && !all) continue;
        if (!fill_sphere(scene_, motion_.plan, i, packed_)) continue;
        changes_.world = true;
        moved_[baked] = 1;
        lights_change_ |= has_lights(packed_, packed_.spheres[i]);
    }
}

void Reposer::write_group_spheres()
{
    for (std::size_t g = 0; g < packed_.groups.size(); ++g)
        for (uint i = 0; i < packed_.groups[g].sphere_count; ++i) {
            const uint number = packed_.groups[g].first_sphere + i;
            if (!fill_sphere(scene_, motion_.plan, number, packed_)) continue;
            groups_[g] = 1;
            lights_change_ |= has_lights(packed_, packed_.spheres[number]);
        }
}

void Reposer::write_instances()
{
    std::atomic<bool> moved = false, shining = false;
    parallel_ranges(packed_.instances.size(), 1 << 12, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            if (!fill_instance(scene_, motion_.plan, i, packed_)) continue;
            moved = true;
            if (motion_.shines[packed_.instances[i].group] != 0) shining = true;
        }
    });
    changes_.instances = moved;
    lights_change_ |= shining;
}

void Reposer::write_bounds()
{
    if (!changes_.any()) return;
    for (std::size_t i = 0; i < motion_.plan.baked.size(); ++i)
        if (moved_[motion_.plan.baked[i]] != 0) motion_.baked_boxes[i] = box_of(scene_, motion_.plan.baked[i]);
    for (const uint g : changes_.groups) motion_.boxes[g] = box_of(scene_, motion_.plan.groups[g]);
    const float radius = packed_.radius;
    fill_bounds(bounds_of_all(packed_, motion_), packed_);
    if (packed_.radius == radius) return;
    // What is infinitely far away lights the more, the larger the scene is.
    const auto is_directional = [](const LightDesc& light) { return light.kind == light_directional; };
    lights_change_ |= std::any_of(scene_.lights.begin(), scene_.lights.end(), is_directional);
}

PackedChanges follow_geometry(const Scene& scene, PackedScene& packed, MotionMap& motion, bool shapes, bool& lights)
{
    return Reposer(scene, packed, motion).run(shapes, lights);
}

PackedChanges repose(const Scene& scene, PackedScene& packed, MotionMap& motion)
{
    const std::optional<PackedChanges> changes = follow(scene, packed, motion, change_pose);
    SNELL_CHECK_EQ(changes.has_value(), true);
    return *changes;
}

} // namespace snell
