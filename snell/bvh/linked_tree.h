// Trees that are not in depth-first order yet, as bottom-up builders and optimisers make them.
#pragma once

#include "snell/bvh/tree.h"

#include <span>

namespace snell {

struct LinkedNode
{
    Box box;
    uint left = 0;  // inner node: index of a child; leaf: first entry of the order
    uint right = 0; // inner node: index of the other child
    uint count = 0; // entries of a leaf; 0: inner node
};

// The same tree depth first, children after parents, in parallel. Subtrees of up to max_leaf_size entries of one kind
// (never instances) become one leaf where that costs no more than they do. What lies below max_tree_depth is arranged
// anew, halved by number. order: what leaves refer to, in any order; the result's follows the leaves.
// Every node but the root is the child of exactly one other.
BinaryTree make_depth_first(std::span<const LinkedNode> nodes, uint root, std::span<const BinaryTree::Entry> order);

// The other way round: node i of the result is node i of the tree.
std::vector<LinkedNode> make_linked(const BinaryTree& tree);

} // namespace snell
