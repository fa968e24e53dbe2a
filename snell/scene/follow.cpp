// A packed scene that follows the edits of its scene.
#include "snell/core/error.h"
#include "snell/scene/lights.h"
#include "snell/scene/repose.h"

#include <algorithm>
#include <cstring>

namespace snell {

namespace {
class Follower
{
  public:
    Follower(const Scene& scene, PackedScene& packed, MotionMap& motion, uint changes)
        : scene_(scene), packed_(packed), motion_(motion), changes_(changes)
    {
    }

    std::optional<PackedChanges> run(const MaterialOverrides& overrides);

  private:
    bool has(uint bits) const { return (changes_ & bits) != 0u; }
    bool write_materials(const MaterialOverrides& overrides);
    void compare_lights(const PackedScene& fresh);
    bool write_owners();
    void give(uint& owner, uint material);
    bool bakes_the_same() const;
    bool lamps_differ() const;

    const Scene& scene_;
    PackedScene& packed_;
    MotionMap& motion_;
    const uint changes_;
    bool lights_ = false;                // must be listed anew
    std::vector<std::uint8_t> emissive_; // by material: it shone before
};
} // namespace

// ---- materials ----

template <class T>
static bool same(const T& a, const T& b)
{
    return std::memcmp(&a, &b, sizeof(T)) == 0;
}

static bool shines(const Material& material)
{
    return !is_black(material.emission);
}

static bool looks_up_emission(const Material& material)
{
    return shines(material) && (material.emission_slot != none || material.opacity_slot != none);
}

// Whether what shines does so as before. fresh: the new materials.
void Follower::compare_lights(const PackedScene& fresh)
{
    const std::size_t count = std::min(fresh.materials.size(), packed_.materials.size());
    bool textured = false;
    for (std::size_t i = 0; i < count; ++i) {
        const Material &before = packed_.materials[i], &after = fresh.materials[i];
        if ((shines(before) || shines(after)) && !same(before, after)) lights_ = true;
        textured = textured || looks_up_emission(after);
    }
    const std::size_t slots = std::min(fresh.slots.size(), packed_.slots.size());
    if (textured && slots > 0 &&
        std::memcmp(fresh.slots.data(), packed_.slots.data(), slots * sizeof(TextureSlot)) != 0)
        lights_ = true;
}

void Follower::give(uint& owner, uint material)
{
    if (owner == material) return;
    lights_ = lights_ || emissive_[owner] != 0 || shines(packed_.materials[material]);
    owner = material;
}

// Follows what has another material. False: the layout is another.
bool Follower::write_owners()
{
    for (std::size_t i = 0; i < scene_.meshes.size(); ++i) {
        MeshPlan& plan = motion_.plan.meshes[i];
        if (!plan.planned || !scene_.meshes[i].triangle_materials.empty()) continue;
        if (plan.runs.size() != 1) return false;
        plan.runs[0].material = scene_.meshes[i].material.value;
    }
    for (const MeshPlacement& placement : motion_.plan.mesh_placements) {
        const std::vector<MaterialRun>& runs = motion_.plan.meshes[placement.mesh].runs;
        for (std::size_t r = 0; r < runs.size(); ++r)
            give(packed_.surfaces[placement.first_surface + r].material, runs[r].material);
    }
    for (std::size_t i = 0; i < packed_.spheres.size(); ++i)
        give(packed_.spheres[i].material, scene_.spheres[motion_.plan.sphere_placements[i].sphere].material.value);
    pack_planes(scene_, packed_);
    return true;
}

bool Follower::write_materials(const MaterialOverrides& overrides)
{
    PackedScene fresh;
    pack_materials(scene_, fresh);
    motion_.textured = textured_materials(fresh.materials);
    if (overrides) overrides(fresh);
    compare_lights(fresh);
    // A material that was taken away shone on something that has another one now.
    emissive_.clear();
    for (const Material& material : packed_.materials) emissive_.push_back(shines(material) ? 1 : 0);
    packed_.materials = std::move(fresh.materials);
    packed_.principled = std::move(fresh.principled);
    packed_.slots = std::move(fresh.slots);
    packed_.albedo = std::move(fresh.albedo);
    packed_.coverage = fresh.coverage;
    if (!write_owners()) return false;
    find_shining(packed_, motion_);
    return true;
}

// ---- the rest ----

bool Follower::bakes_the_same() const
{
    std::vector<std::uint8_t> stays = motion_.moving;
    return baked_instances(scene_, motion_.textured, stays) == motion_.plan.baked;
}

bool Follower::lamps_differ() const
{
    if (packed_.view().delta_light_count != scene_.lights.size()) return true;
    for (std::size_t i = 0; i < scene_.lights.size(); ++i) {
        Light light = make_light(scene_.lights[i]);
        const Light& old = packed_.lights[i];
        light.select_pdf = old.select_pdf;
        light.alias_threshold = old.alias_threshold;
        light.alias = old.alias;
        if (!same(light, old)) return true;
    }
    return false;
}

std::optional<PackedChanges> Follower::run(const MaterialOverrides& overrides)
{
    if (has(change_everything) || counts_of(scene_) != motion_.counts) return {};
    if (has(change_images)) {
        pack_images(scene_, packed_);
        motion_.environment = {};
        lights_ = true;
    }
    if (has(change_materials) && !write_materials(overrides)) return {};
    PackedChanges result;
    if (has(change_materials | change_transforms | change_shapes) && !bakes_the_same()) return {};
    if (has(change_shapes)) pack_planes(scene_, packed_);
    if (has(change_transforms | change_shapes))
        result = follow_geometry(scene_, packed_, motion_, has(change_shapes), lights_);
    if (lights_ || (has(change_lights) && lamps_differ())) {
        pack_lights(scene_, packed_);
        choose_environment(packed_);
    }
    if (has(change_environment | change_images)) pack_environment(scene_, packed_, motion_.environment);
    return result;
}

std::optional<PackedChanges> follow(const Scene& scene, PackedScene& packed, MotionMap& motion, uint changes,
                                    const MaterialOverrides& overrides)
{
    const PackPlan& plan = motion.plan;
    SNELL_CHECK_EQ(packed.positions.size(), plan.positions);
    SNELL_CHECK_EQ(packed.triangles.size(), plan.triangles);
    SNELL_CHECK_EQ(packed.spheres.size(), plan.sphere_placements.size());
    SNELL_CHECK_EQ(packed.instances.size(), plan.instances.size());
    SNELL_CHECK_EQ(packed.groups.size(), motion.boxes.size());
    return Follower(scene, packed, motion, changes).run(overrides);
}

} // namespace snell
