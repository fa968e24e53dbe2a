// How a camera moves: pure functions, without window and input. Angles in radians, lengths in scene units.
#pragma once

#include "snell/scene/scene.h"

#include <span>

namespace snell::view {

// Axes of the picture: right, up and forward, of unit length. The camera's `up` need not be perpendicular to its view.
struct CameraAxes
{
    vec3 right, up, forward;
};
CameraAxes camera_axes(const CameraDesc& camera);

// Eye and target go along: right and forward as the picture shows them, up along CameraDesc::up.
CameraDesc fly(CameraDesc camera, float right, float up, float forward);

// Looks further to the right and up; the eye stays. It stops short of straight up and down.
CameraDesc turn(CameraDesc camera, float right, float up);

// The camera goes around the pivot so that what it sees turns to the right and up, as if it were held by the hand.
CameraDesc orbit(CameraDesc camera, vec3 pivot, float right, float up);

// Moves in the picture's plane.
CameraDesc pan(CameraDesc camera, float right, float up);

// Moves the eye towards the pivot: factor 0.5 leaves half the distance. The target keeps its distance ahead.
CameraDesc dolly(CameraDesc camera, vec3 pivot, float factor);

// Keeps the direction and puts the eye where all of the box is seen. aspect: width over height.
CameraDesc frame(CameraDesc camera, const Bounds& box, float aspect);

// A speed at which the box is crossed in some seconds; 1 for an empty one.
float natural_speed(const Bounds& box);

// A smooth path through views: centripetal Catmull-Rom splines (Barry and Goldman 1988) through eyes and targets. t in
// [0, 1] from the first to the last; views.size() >= 1.
CameraDesc along(std::span<const CameraDesc> views, float t);

} // namespace snell::view
