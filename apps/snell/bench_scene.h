// Scenes as benchmarks take them.
#pragma once

#include "camera_choice.h"
#include "scene_choice.h"

#include "snell/scene/camera_models.h"
#include "snell/scene/packed.h"

#include <string>

namespace snell::app {

struct BenchScene
{
    PackedScene packed;
    ReadyCamera camera; // of a square picture of ray_set_side(rays) pixels
    CameraDesc camera_desc;
};

// Opens a scene, puts it into a room if asked to, chooses the camera and packs it.
BenchScene open_bench_scene(const std::string& name, const SceneChoice& choice, const CameraChoice& camera, bool room,
                            std::size_t rays);

// A closed box of matt walls with a lamp below its ceiling, around the scene and all its cameras, so that light that
// leaves the scene comes back. The scene must have a camera.
void add_room(Scene& scene);

} // namespace snell::app
