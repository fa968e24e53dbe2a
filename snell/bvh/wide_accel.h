// Accelerators over wide trees.
#pragma once

#include "snell/bvh/accel.h"

namespace snell {

// Node: Node2, Node4, Node8 or QuantisedNode.
template <class Node>
std::unique_ptr<Accel> make_wide_accel(const PackedScene& scene, const AccelOptions& options);

template <class Node>
struct TraceInput;

// The trees of such an accelerator, valid until its next update(); nullptr: it is another one.
template <class Node>
const TraceInput<Node>* find_wide_trees(const Accel& accel);

} // namespace snell
