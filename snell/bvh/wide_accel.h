// Accelerators over wide trees.
#pragma once

#include "snell/bvh/accel.h"

namespace snell {

// Node: Node2, Node4, Node8 or QuantisedNode.
template <class Node>
std::unique_ptr<Accel> make_wide_accel(const PackedScene& scene, const AccelOptions& options);

} // namespace snell
