#include "snell/scene/repose.h"

#include "snell/core/error.h"
#include "snell/core/parallel.h"
#include "snell/scene/bounds.h"
#include "snell/scene/lights.h"
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

static Bounds fixed_bounds(const Scene& scene, const PackPlan& plan)
{
    Bounds bounds;
    for (const uint i : plan.baked) {
        const InstanceDesc& instance = scene.instances[i];
        extend(bounds, group_bounds(scene, scene.groups[instance.group.value], instance.transform));
    }
    return bounds;
}

static Bounds box_of(const Scene& scene, const GroupPlacement& group)
{
    return group_bounds(scene, scene.groups[group.group], identity_transform());
}

static Bounds bounds_of_all(const PackedScene& packed, const MotionMap& motion)
{
    Bounds all = motion.fixed;
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
    for (const uint i : plan.baked) motion.baked.push_back(scene.instances[i].transform);

    motion.fixed = fixed_bounds(scene, plan);
    for (const GroupPlacement& group : plan.groups) motion.boxes.push_back(box_of(scene, group));
    fill_bounds(bounds_of_all(packed, motion), packed);

    motion.shines.assign(plan.groups.size(), 0);
    for (const MeshPlacement& placement : plan.mesh_placements)
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

    PackedChanges run()
    {
        find_moved();
        write_meshes();
        write_spheres();
        write_instances();
        for (std::size_t g = 0; g < groups_.size(); ++g)
            if (groups_[g] != 0) changes_.groups.push_back(static_cast<uint>(g));
        write_bounds();
        if (lights_change_ || lamps_have_moved()) pack_lights(scene_, packed_);
        return changes_;
    }

  private:
    void find_moved();
    void write_meshes();
    void write_spheres();
    void write_instances();
    void write_bounds();
    bool lamps_have_moved() const;

    const Scene& scene_;
    PackedScene& packed_;
    MotionMap& motion_;
    PackedChanges changes_;
    std::vector<std::uint8_t> moved_;  // by instance of the scene: it lies in world space, and elsewhere than before
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
            changes_.world = true;
        else
            groups_[p.group] = 1;
        lights_change_ |= has_lights(packed_, motion_, p);
    }
}

void Reposer::write_spheres()
{
    if (!some_moved_) return;
    for (std::size_t i = 0; i < packed_.world.sphere_count; ++i) {
        if (moved_[motion_.plan.sphere_placements[i].baked] == 0) continue;
        if (!fill_sphere(scene_, motion_.plan, i, packed_)) continue;
        changes_.world = true;
        lights_change_ |= has_lights(packed_, packed_.spheres[i]);
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
    if (changes_.world) motion_.fixed = fixed_bounds(scene_, motion_.plan);
    for (const uint g : changes_.groups) motion_.boxes[g] = box_of(scene_, motion_.plan.groups[g]);
    const float radius = packed_.radius;
    fill_bounds(bounds_of_all(packed_, motion_), packed_);
    if (packed_.radius == radius) return;
    // What is infinitely far away lights the more, the larger the scene is.
    const auto is_directional = [](const LightDesc& light) { return light.kind == light_directional; };
    lights_change_ |= std::any_of(scene_.lights.begin(), scene_.lights.end(), is_directional);
}

bool Reposer::lamps_have_moved() const
{
    for (std::size_t i = 0; i < scene_.lights.size(); ++i) {
        Light light = make_light(scene_.lights[i]);
        const Light& old = packed_.lights[i];
        light.select_pdf = old.select_pdf;
        light.alias_threshold = old.alias_threshold;
        light.alias = old.alias;
        if (std::memcmp(&light, &old, sizeof(Light)) != 0) return true;
    }
    return false;
}

PackedChanges repose(const Scene& scene, PackedScene& packed, MotionMap& motion)
{
    const PackPlan& plan = motion.plan;
    SNELL_CHECK_EQ(scene.meshes.size(), plan.meshes.size());
    SNELL_CHECK_EQ(scene.meshes.size(), motion.rigged.size());
    SNELL_CHECK_EQ(packed.positions.size(), plan.positions);
    SNELL_CHECK_EQ(packed.triangles.size(), plan.triangles);
    SNELL_CHECK_EQ(packed.instances.size(), plan.instances.size());
    SNELL_CHECK_EQ(packed.groups.size(), motion.boxes.size());
    SNELL_CHECK_LE(scene.lights.size(), packed.lights.size());
    return Reposer(scene, packed, motion).run();
}

} // namespace snell
