// Leaves: up to eight triangles with the vertices that they share stored once, for SIMD tests of all eight.
#pragma once

#include "snell/bvh/tree.h"
#include "snell/scene/packed.h"

#include <span>
#include <vector>

namespace snell {

struct alignas(64) Line
{
    std::byte bytes[64];
};

// What a block of `capacity` vertices begins with; the vertices follow: all x, all y, all z. With 12 vertices it takes
// three cache lines, with 16 four. A leaf that has more becomes several blocks one after the other.
struct TriangleBlock
{
    uint corner[3];         // by vertex of the triangle: the numbers of the eight triangles' vertices, 4 bits each
    std::uint8_t count;     // triangles
    std::uint8_t capacity;  // 12 or 16
    std::uint8_t lanes;     // a bit for each triangle
    std::uint8_t more;      // 1: the leaf goes on with the block behind this one
    uint id[max_leaf_size]; // into PackedScene::triangles; unused lanes repeat the first triangle

    const float* axis(uint a) const { return reinterpret_cast<const float*>(this + 1) + a * capacity; }
    float* axis(uint a) { return reinterpret_cast<float*>(this + 1) + a * capacity; }
    uint corner_of(uint lane, uint vertex) const { return corner[vertex] >> (4 * lane) & 15u; }
    vec3 vertex(uint lane, uint v) const
    {
        const uint i = corner_of(lane, v);
        return vec3(axis(0)[i], axis(1)[i], axis(2)[i]);
    }
    uint size() const { return capacity == 12 ? 3 : 4; } // lines
};
static_assert(sizeof(TriangleBlock) == 48);
static_assert(max_leaf_size == 8);

inline const TriangleBlock& block_at(const Line* lines, std::size_t index)
{
    return *reinterpret_cast<const TriangleBlock*>(lines + index);
}
inline TriangleBlock& block_at(Line* lines, std::size_t index)
{
    return *reinterpret_cast<TriangleBlock*>(lines + index);
}

// Appends a leaf as one or more blocks; returns how many. At most max_leaf_size entries, all triangles; each triangle
// is taken once. Vertices are shared by number, so that they stay shared when the mesh moves.
uint append_blocks(const PackedScene& scene, std::span<const BinaryTree::Entry> entries, std::vector<Line>& lines);

// Whether one block is enough for them.
bool fit_one_block(const PackedScene& scene, std::span<const BinaryTree::Entry> entries);

// Reads the vertices of a block's triangles from the scene again; returns their box.
Box refill_block(const PackedScene& scene, TriangleBlock& block);

} // namespace snell
