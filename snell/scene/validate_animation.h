// The part of validate() that looks at what moves.
#pragma once

#include "snell/scene/scene.h"

namespace snell {

// Throws Error on what has no meaning: an index out of range, lists of lengths that do not fit, a node that is its own
// ancestor, two rigs for one mesh. Takes time for each node, key list and rig, not for each key or vertex.
void check_animation(const Scene& scene);

// check_animation(), and mends: numbers in nodes that are not finite; channels whose times do not ascend, whose numbers
// are not finite or that move a node with a matrix (dropped); weights of joints that are negative or do not sum to 1;
// joints out of range of vertices (Error); normals of rigs without direction. What was mended is noted.
void validate_animation(Scene& scene);

} // namespace snell
