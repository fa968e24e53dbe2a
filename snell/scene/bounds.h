// Bounds of parts of a scene. Those of all of it: scene_bounds() in scene.h.
#pragma once

#include "snell/scene/scene.h"

namespace snell {

// Makes `bounds` enclose both.
void extend(Bounds& bounds, const Bounds& other);

// Of what is in the group, moved by the transform. Vertices that are not finite, or that no triangle uses, do not
// count. In parallel.
Bounds group_bounds(const Scene& scene, const Group& group, const Transform& transform);

// Of a box that is moved; a little larger than those of its content. Corners that are not finite do not count.
Bounds transformed(const Bounds& bounds, const Transform& transform);

} // namespace snell
