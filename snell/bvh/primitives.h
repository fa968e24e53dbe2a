// From the packed scene to primitive references.
#pragma once

#include "snell/bvh/tree.h"
#include "snell/scene/packed.h"

namespace snell {

// References to the triangles and spheres of a group, in the order of the scene's arrays. Primitives with a NaN or
// infinite bound are left out: no ray hits them.
std::vector<PrimitiveRef> collect_primitives(const PackedScene& scene, const PackedGroup& group);

// The box of a sphere, a little larger, so that rounding never cuts into it; empty if it is not finite.
Box sphere_box(const Sphere& sphere);

// Appends references to all instances whose group has something to hit. group_boxes: by Instance::group, in object
// space. The boxes are a little larger than the transformed ones, for the rounding of the ray's own transformation.
void collect_instances(const PackedScene& scene, const std::vector<Box>& group_boxes, std::vector<PrimitiveRef>& refs);

} // namespace snell
