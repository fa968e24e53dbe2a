// What a change to a scene asks of what was derived from it.
#pragma once

#include "snell/core/vec.h"

namespace snell {

// The least that is right: bits are joined.
enum SceneChange : uint
{
    change_none = 0,
    change_camera = 1,    // cameras
    change_materials = 2, // numbers and textures of materials, new materials, and whose they are: of spheres, planes
                          // and meshes that have one. Emission included: lights are listed again
    change_lights = 4,    // point, directional, spot: their numbers, and how many
    change_environment = 8,
    change_transforms = 16, // of instances, and vertices of rigged meshes: trees follow
    change_shapes = 32,     // of spheres and planes: trees follow
    change_images = 64,     // texels, and how many images there are
    change_everything = 128 // packed and built anew
};

// What pose() changes.
inline constexpr uint change_pose = change_camera | change_lights | change_transforms;

} // namespace snell
