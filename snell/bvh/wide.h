// The layouts that traversal reads: trees of wide nodes over blocks of primitives, converted from binary trees.
#pragma once

#include "snell/bvh/big_pages.h"
#include "snell/bvh/build.h"
#include "snell/bvh/cache.h"
#include "snell/bvh/node.h"
#include "snell/bvh/tree.h"
#include "snell/bvh/triangle_block.h"
#include "snell/scene/packed.h"

#include <span>

namespace snell {

// What a ray's visit costs, in visits of nodes: measured, a node takes about 36 cycles, and a block, however full, 100
// to 130. Trees are collapsed for it, and their sah_cost is in these units.
inline constexpr float wide_node_cost = 1.0f;
inline constexpr float wide_block_cost = 3.2f;

struct SphereBlock
{
    uint id[max_leaf_size]; // into PackedScene::spheres; used ones first, then none
};

// A tree of its own space: the world's, that of one group, or the one over the instances.
template <class Node>
struct WideTree
{
    RawVector<Node> nodes; // children after their parents
    RawVector<Line> lines; // triangle blocks, and one line that may be read but means nothing
    std::vector<SphereBlock> spheres;
    Box box;                    // of the root
    ChildWord root = word_done; // word_done: nothing to hit
    // What nodes have in the place of children that are not there: the block without triangles. Their boxes are empty,
    // but far from a box of 8 bits a plane rounding may take a ray there.
    ChildWord no_child = word_done;
    // Entries of the traversal's stack that may be waiting while anything below the root is visited, at most; computed
    // from this very tree.
    uint stack_size = 0;
    double sah_cost = 0; // expected cost of a ray that enters the box, in visits of nodes
    std::size_t leaves = 0;
    std::size_t left_out = 0; // primitives that are not in the tree, for they were not finite when it was built

    std::size_t bytes() const
    {
        return sizeof(Node) * nodes.capacity() + sizeof(Line) * lines.capacity() +
               sizeof(SphereBlock) * spheres.capacity();
    }
};

// Two levels. Without instances rays begin in `world`, else in `top`, whose leaves are instances and the whole world
// tree (word_world).
template <class Node>
struct WideBvh
{
    WideTree<Node> world, top;
    std::vector<WideTree<Node>> groups; // by Instance::group

    bool has_instances() const { return top.root != word_done; }
    const WideTree<Node>& first() const { return has_instances() ? top : world; }
    // Entries of the traversal's stack that no ray can exceed.
    uint stack_size() const;
    double sah_cost() const { return first().sah_cost; } // an instance counts as its group's tree
    std::size_t bytes() const;
    std::size_t nodes() const;
    std::size_t leaves() const;
};

// By Collapse, in parallel; the same for any number of threads. Slots hold the children that are likeliest to block a
// ray, for the time they take, last; an order for closest hits each node has beside that. Costs and stacks of what
// instance leaves lead to: by group, and last those of the world; empty for trees without instances.
struct Below
{
    double cost = 0;
    uint stack = 0;
};
template <class Node>
WideTree<Node> make_wide_tree(const PackedScene& scene, const BinaryTree& tree, std::span<const Below> below = {});

// The tree over the instances of a scene and the world's tree, once the others are there.
template <class Node>
WideTree<Node> make_top_tree(const PackedScene& scene, const WideBvh<Node>& bvh, const BuildOptions& options);

// The options for a tree over instances that is built for each frame: the default builder takes four times as long as
// binned, for a tree over instances that is hardly better.
BuildOptions for_each_frame(BuildOptions options);

// The tree of a group or the world, of what is in it now.
template <class Node>
WideTree<Node> make_group_tree(const PackedScene& scene, const PackedGroup& group, const BuildOptions& options,
                               const TreeCache& cache = {}, CacheUse* use = nullptr);

// Collects, builds and converts all of a scene; trees that the cache has are not built.
template <class Node>
WideBvh<Node> make_wide(const PackedScene& scene, const BuildOptions& options = {}, const TreeCache& cache = {},
                        CacheUse* use = nullptr);

} // namespace snell
