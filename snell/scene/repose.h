// Scenes that move: a PackedScene that follows the poses of its Scene, so that only what moved is touched.
#pragma once

#include "snell/scene/pack_plan.h"

namespace snell {

// What repose() has to know of a PackedScene, beside its arrays. Made by pack().
struct MotionMap
{
    PackPlan plan;
    std::vector<std::uint8_t> rigged; // by mesh of the Scene: it may change its shape
    std::vector<Transform> baked;     // by PackPlan::baked: the transforms that were applied
    Bounds fixed;                     // of all that lies in world space
    std::vector<Bounds> boxes;        // by packed group, in its own space
    std::vector<std::uint8_t> shines; // by packed group: it has lights
};

// As pack(scene), but what an animation can move stays in object space, if it is placed once too: groups with a mesh
// that is rigged and moves, and groups on nodes that move. They are bounded by transformed boxes, which may make
// PackedScene::radius a little larger. Fills `motion` for repose().
PackedScene pack(const Scene& scene, MotionMap& motion);

// Makes `packed`, from pack(scene, motion), what that would be now that the scene has been posed anew: the same arrays,
// bit for bit, at a cost that goes with what moved. Beside what pose() changes (transforms of instances, vertices of
// rigged meshes, lights), nothing of the scene may have changed. Groups that were moved into world space may move as
// well, and cost more. Returns what an accelerator has to follow. Throws Error as pack() does; `packed` is then of no
// use.
PackedChanges repose(const Scene& scene, PackedScene& packed, MotionMap& motion);

// Of pack(): given the plan and all geometry, fills the rest of `motion` and the bounds.
void survey_motion(const Scene& scene, PackedScene& packed, MotionMap& motion);

} // namespace snell
