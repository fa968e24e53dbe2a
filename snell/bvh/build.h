// Builders: from primitive references to the binary tree.
#pragma once

#include "snell/bvh/tree.h"

namespace snell {

// Binned surface area heuristic (Wald 2007, On fast Construction of SAH-based Bounding Volume Hierarchies), in
// parallel. Leaves hold up to max_leaf_size primitives and cost as one block, however full. The tree is the same for
// any number of threads. Its depth is at most 96, whatever the input (fewer than 2^30 references). All references must
// have finite bounds.
BinaryTree build_binned_sah(std::vector<PrimitiveRef> refs);

} // namespace snell
