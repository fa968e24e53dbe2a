// How good a binary tree is.
#pragma once

#include "snell/bvh/tree.h"
#include "snell/scene/packed.h"

namespace snell {

struct TreeQuality
{
    std::size_t nodes = 0, leaves = 0; // nodes: inner ones
    std::size_t references = 0;        // entries of leaves; more than primitives where some were split
    int depth = 0;                     // of the deepest leaf; the root has 0
    double mean_leaf_depth = 0, mean_leaf_size = 0;
    double sah = 0; // expected cost of a random ray that meets the root's box, with cost_of_node and cost_of_block
    double epo = 0; // end-point overlap, in the same units; 0 if there are no triangles
};

// EPO (Aila, Karras, Laine 2013, On Quality Metrics of Bounding Volume Hierarchies): the surface that lies in a node's
// box without belonging to its subtree, weighted by the node's cost and relative to the whole surface. Triangles only,
// clipped exactly; in parallel. with_epo: false leaves it out, for it takes as long as a build.
TreeQuality measure_quality(const PackedScene& scene, const BinaryTree& tree, bool with_epo = true);

} // namespace snell
