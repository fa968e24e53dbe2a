// Key frames: what an animated property is at a moment between two of them.
#pragma once

#include "snell/scene/animation.h"

#include <array>
#include <span>

namespace snell {

// The property at `seconds`, before the first key as there and after the last as there. into: as many numbers as the
// property has, which values and times must fit. The channel must have a key.
void sample_keys(const AnimationChannel& channel, float seconds, std::span<float> into);

// On the shortest great arc from a (t = 0) to b (t = 1), at constant speed. Unit quaternions x y z w.
vec4 slerp(vec4 a, vec4 b, float t);

// The unit quaternion along q; no rotation if q has no direction.
vec4 unit_quaternion(vec4 q);

// Scale first, then rotation, then translation. rotation: a unit quaternion.
Transform compose_trs(vec3 translation, vec4 rotation, vec3 scale);

} // namespace snell
