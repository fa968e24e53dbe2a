// What every binary tree must keep to, whoever built it.
#pragma once

#include "snell/bvh/build.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <vector>

namespace snell::test {

inline bool same_tree(const BinaryTree& a, const BinaryTree& b)
{
    return a.nodes.size() == b.nodes.size() && a.order.size() == b.order.size() &&
           std::memcmp(a.nodes.data(), b.nodes.data(), a.nodes.size() * sizeof(BinaryNode)) == 0 &&
           std::memcmp(a.order.data(), b.order.data(), a.order.size() * sizeof(BinaryTree::Entry)) == 0;
}

// The depth of the deepest leaf. Depths of nodes come before those of their children, as the nodes do.
inline int tree_depth(const BinaryTree& tree)
{
    std::vector<int> depth(tree.nodes.size());
    int deepest = 0;
    for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
        deepest = std::max(deepest, depth[i]);
        if (tree.nodes[i].count > 0) continue;
        depth[i + 1] = depth[i] + 1;
        depth[tree.nodes[i].link] = depth[i] + 1;
    }
    return deepest;
}

inline double tree_cost(const BinaryTree& tree)
{
    double cost = 0;
    for (const BinaryNode& node : tree.nodes)
        cost += node.box.half_area() * (node.count > 0 ? cost_of_block : cost_of_node);
    return tree.nodes.empty() ? 0 : cost / tree.nodes.front().box.half_area();
}

// Depth first with every node and entry used once, leaves of one kind within max_leaf_size, boxes exact, depth bounded,
// and every reference there once.
inline void expect_sound_tree(const std::vector<PrimitiveRef>& refs, const BinaryTree& tree)
{
    const auto key = [](RefKind kind, uint index) { return std::pair(kind, index); };
    std::map<std::pair<RefKind, uint>, Box> boxes;
    for (const PrimitiveRef& ref : refs) boxes[key(ref.kind, ref.index)] = {ref.lower, ref.upper};
    ASSERT_EQ(boxes.size(), refs.size());
    ASSERT_EQ(tree.order.size(), refs.size());
    ASSERT_EQ(tree.nodes.empty(), refs.empty());
    ASSERT_LE(tree_depth(tree), max_tree_depth);

    std::vector<uint> parents(tree.nodes.size());
    uint next_entry = 0;
    for (uint i = 0; i < tree.nodes.size(); ++i) {
        const BinaryNode& node = tree.nodes[i];
        Box below;
        if (node.count > 0) {
            ASSERT_EQ(node.link, next_entry) << i; // leaves follow each other in the order
            next_entry += node.count;
            ASSERT_LE(next_entry, tree.order.size());
            ASSERT_LE(node.count, max_leaf_size);
            const RefKind kind = tree.order[node.link].kind;
            if (kind == RefKind::instance) {
                ASSERT_EQ(node.count, 1u);
            }
            for (uint j = 0; j < node.count; ++j) {
                const BinaryTree::Entry entry = tree.order[node.link + j];
                ASSERT_EQ(entry.kind, kind);
                const auto found = boxes.find(key(entry.kind, entry.index));
                ASSERT_NE(found, boxes.end()) << "twice, or not one of the references: " << entry.index;
                below.extend(found->second);
                boxes.erase(found);
            }
        } else {
            ASSERT_GT(node.link, i + 1);
            ASSERT_LT(node.link, tree.nodes.size());
            ++parents[i + 1];
            ++parents[node.link];
            below.extend(tree.nodes[i + 1].box);
            below.extend(tree.nodes[node.link].box);
        }
        ASSERT_EQ(below.lower, node.box.lower) << i;
        ASSERT_EQ(below.upper, node.box.upper) << i;
    }
    for (uint i = 1; i < tree.nodes.size(); ++i) ASSERT_EQ(parents[i], 1u) << i;
    EXPECT_TRUE(boxes.empty());
}

} // namespace snell::test
