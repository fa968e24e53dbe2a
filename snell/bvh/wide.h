// The layout that the SIMD traversal reads: 8-wide nodes and blocks of primitives, two levels in one set of arrays.
#pragma once

#include "snell/bvh/big_pages.h"
#include "snell/bvh/build.h"
#include "snell/bvh/cache.h"
#include "snell/scene/packed.h"

#include <span>

namespace snell {

// A child of a node: kind << 30 | index. Kind 0 is an inner node, else a RefKind: a block of triangles, a block of
// spheres, an instance.
using ChildWord = uint;
inline constexpr uint child_index_mask = 0x3fffffffu;
// Two words that only the traversal's stack holds; no tree can have an instance of such a number.
inline constexpr ChildWord word_done = 0xffffffffu;
inline constexpr ChildWord word_leave_instance = 0xfffffffeu;

inline ChildWord make_child(uint kind, std::size_t index)
{
    return kind << 30 | static_cast<uint>(index);
}

inline constexpr uint node_width = 8;

// Four cache lines. Unused children have an empty box (+inf to -inf), which no ray enters.
struct alignas(64) WideNode
{
    float planes[6][node_width]; // lower x, y, z, upper x, y, z
    ChildWord child[node_width];
    uint
        order[8]; // by octant (bit i: direction negative on axis i): children from far to near, 4 bits each, far lowest
};
static_assert(sizeof(WideNode) == 256);

struct alignas(64) TriangleBlock
{
    float v[3][3][max_leaf_size]; // vertex, axis, lane; unused lanes are NaN and so never hit
    uint id[max_leaf_size];       // into PackedScene::triangles; none: unused
    uint pad[8];
};
static_assert(sizeof(TriangleBlock) == 192);

struct SphereBlock
{
    uint id[max_leaf_size]; // into PackedScene::spheres; used ones first, then none
};

// A tree of its own space: world, or that of one group.
struct alignas(16) WideRoot
{
    float lower[4] = {}, upper[4] = {}; // of the box; the fourth components are 0
    ChildWord word = word_done;         // word_done: nothing to hit
};

struct WideBvh
{
    BigVector<WideNode> nodes;
    BigVector<TriangleBlock> triangles;
    BigVector<SphereBlock> spheres;
    WideRoot world;
    std::vector<WideRoot> groups; // by Instance::group

    // Entries of the traversal's stack that no ray can exceed, computed from this very tree (see wide.cpp).
    uint stack_size = 0;
    double sah_cost = 0; // of the world's tree, an instance counting as its group's tree
    std::size_t leaves = 0;

    std::size_t bytes() const;
};

// Trees by group and the world's, whose leaves may be instances.
WideBvh make_wide(const PackedScene& scene, const BinaryTree& world, std::span<const BinaryTree> groups);

// Collects, builds and converts all of a scene; trees that the cache has are not built.
WideBvh build_wide(const PackedScene& scene, const BuildOptions& options = {}, const TreeCache& cache = {},
                   CacheUse* use = nullptr);

} // namespace snell
