// Scenes that move and are edited: a PackedScene that follows its Scene, so that only what changed is touched.
#pragma once

#include "snell/scene/change.h"
#include "snell/scene/pack_parts.h"
#include "snell/scene/pack_plan.h"

#include <functional>
#include <optional>

namespace snell {

// What follow() has to know of a PackedScene, beside its arrays. Made by pack().
struct MotionMap
{
    PackPlan plan;
    std::vector<std::uint8_t> moving;    // by group of the Scene: moving_groups()
    std::vector<std::uint8_t> rigged;    // by mesh of the Scene: it may change its shape
    std::vector<Transform> baked;        // by PackPlan::baked: the transforms that were applied
    std::vector<Bounds> baked_boxes;     // likewise: how much room that takes in world space
    std::vector<Bounds> boxes;           // by packed group, in its own space
    std::vector<std::uint8_t> shines;    // by packed group: it has lights
    std::vector<std::uint8_t> textured;  // by material, see textured_materials()
    std::array<std::size_t, 4> counts{}; // of the scene's meshes, spheres, groups and instances
    EnvironmentCells environment;
};

// As pack(scene), but what an animation can move stays in object space, if it is placed once too: groups with a mesh
// that is rigged and moves, and groups on nodes that move. They are bounded by transformed boxes, which may make
// PackedScene::radius a little larger. Fills `motion` for follow().
PackedScene pack(const Scene& scene, MotionMap& motion);

// Makes `packed`, from pack(scene, motion), what that would be now that the scene has been posed anew: the same arrays,
// bit for bit, at a cost that goes with what moved. Beside what pose() changes (transforms of instances, vertices of
// rigged meshes, lights), nothing of the scene may have changed. Groups that were moved into world space may move as
// well, and cost more. Returns what an accelerator has to follow. Throws Error as pack() does; `packed` is then of no
// use.
PackedChanges repose(const Scene& scene, PackedScene& packed, MotionMap& motion);

// Changes packed materials into what is to be rendered instead; not their emission, coverage or what they tell
// textured_materials().
using MaterialOverrides = std::function<void(PackedScene&)>;

// As repose(), for whatever else has changed since: `changes` are SceneChange bits that name it. The arrays are then,
// bit for bit, what pack(scene, motion), overrides(packed) and pack_lights() would give. Nothing if that has another
// layout (or change_everything is asked for): pack anew, `packed` and `motion` are then of no use. A layout changes
// with the numbers of meshes, spheres, groups and instances, with the materials of a mesh that has several, and where a
// sphere becomes an ellipsoid.
std::optional<PackedChanges> follow(const Scene& scene, PackedScene& packed, MotionMap& motion, uint changes,
                                    const MaterialOverrides& overrides = {});

// Of follow(): writes all geometry anew that has changed. shapes: spheres may have changed as well. lights becomes true
// if they must be listed anew.
PackedChanges follow_geometry(const Scene& scene, PackedScene& packed, MotionMap& motion, bool shapes, bool& lights);

// Of pack() and follow(): for MotionMap::counts.
std::array<std::size_t, 4> counts_of(const Scene& scene);

// Of follow(): fills MotionMap::shines.
void find_shining(const PackedScene& packed, MotionMap& motion);

// Of pack(): given the plan and all geometry, fills the rest of `motion` and the bounds.
void survey_motion(const Scene& scene, PackedScene& packed, MotionMap& motion);

} // namespace snell
