// What is seen in a pixel.
#pragma once

#include "snell/render/render.h"

#include <optional>

namespace snell::view {

struct PickedSurface
{
    uint material = none;
    uint instance = none; // of the Scene; none: of a plane, or of what lies in world space
    uint object = none;   // numbered through meshes, spheres and planes
    float distance = 0.0f;
};

// The first surface that the camera sees through the centre of a pixel; nothing: none. Where a surface has holes, it
// may be either.
std::optional<PickedSurface> pick_surface(const Prepared& prepared, const CameraDesc& camera,
                                          const RenderSettings& settings, int x, int y);

} // namespace snell::view
