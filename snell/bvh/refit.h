// Refitting: a tree follows primitives that have moved, and keeps who lies beside whom.
#pragma once

#include "snell/bvh/wide.h"

namespace snell {

// Reads the corners of all triangles anew, and makes the boxes and orders of the nodes, the tree's box and its cost
// what they are for these. What is NaN or infinite is not hit, as long as that is so; if nothing is left, the box is
// empty. Not for the tree over the instances. In parallel, in time that goes with the tree's size; the result does not
// depend on the number of threads.
template <class Node>
void refit(const PackedScene& scene, WideTree<Node>& tree);

} // namespace snell
