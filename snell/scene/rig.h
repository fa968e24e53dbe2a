// Meshes that change their shape: morph targets, then skinning.
#pragma once

#include "snell/scene/scene.h"

#include <span>

namespace snell {

// Writes the rig's mesh: rest shape plus weights[k] times target k (targets beyond the weights: 0), then, if skinned,
// carried by the weighted mean of joints, which map the mesh's space at rest to the world (linear blend skinning).
// Normals follow by the inverse transpose and stay unit, as do tangents. In parallel over the vertices.
void deform(const Rig& rig, std::span<const float> weights, std::span<const Transform> joints, Mesh& mesh);

} // namespace snell
