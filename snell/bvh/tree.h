// The one binary tree that every builder makes and every layout is converted from.
#pragma once

#include "snell/core/vec.h"

#include <limits>
#include <vector>

namespace snell {

// An axis-aligned box; a new one is empty.
struct Box
{
    vec3 lower{std::numeric_limits<float>::infinity()};
    vec3 upper{-std::numeric_limits<float>::infinity()};

    void extend(vec3 p) { lower = min(lower, p), upper = max(upper, p); }
    void extend(const Box& b) { lower = min(lower, b.lower), upper = max(upper, b.upper); }
    bool empty() const { return !(lower.x <= upper.x && lower.y <= upper.y && lower.z <= upper.z); }
    vec3 extent() const { return upper - lower; }
    // Half the surface; 0 if empty. In double: the extents of hostile scenes overflow a float when squared.
    double half_area() const
    {
        if (empty()) return 0;
        const double x = double(upper.x) - lower.x, y = double(upper.y) - lower.y, z = double(upper.z) - lower.z;
        return x * y + y * z + z * x;
    }
};

// What a tree may hold; the numbers are those of the child words in node.h.
enum class RefKind : uint
{
    triangle = 1,
    sphere = 2,
    instance = 3
};

// A primitive as builders see it: finite bounds and who it is. 32 bytes, two SIMD loads.
struct alignas(16) PrimitiveRef
{
    vec3 lower;
    uint index; // into the scene's array of that kind
    vec3 upper;
    RefKind kind;
};
static_assert(sizeof(PrimitiveRef) == 32);

struct BinaryNode
{
    Box box;
    uint link = 0;  // inner node: the right child (the left one follows its parent); leaf: first entry of `order`
    uint count = 0; // entries of a leaf, all of one kind; 0: inner node
};

// Most primitives in a leaf: what one SIMD block holds. An instance always has a leaf of its own.
inline constexpr uint max_leaf_size = 8;

// Node 0 is the root; no nodes: nothing to hit. Children come after their parents.
struct BinaryTree
{
    struct Entry
    {
        uint index;
        RefKind kind;
    };
    std::vector<BinaryNode> nodes;
    std::vector<Entry> order;
};

} // namespace snell
