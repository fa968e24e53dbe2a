// Nodes of the wide trees: float boxes of 2, 4 or 8 children, or 8 quantised ones.
#pragma once

#include "snell/bvh/tree.h"

#include <array>
#include <cstdint>
#include <type_traits>

namespace snell {

// A child of a node: kind << 30 | index. Kind 0 is an inner node, else a RefKind: a block of triangles (the index
// counts lines), a block of spheres, an instance.
using ChildWord = uint;
inline constexpr uint child_index_mask = 0x3fffffffu;
// Words that no tree has as an ordinary instance. The first two only the traversal's stack holds.
inline constexpr ChildWord word_done = 0xffffffffu;
inline constexpr ChildWord word_leave_instance = 0xfffffffeu;
inline constexpr ChildWord word_world = 0xfffffffdu; // the world's own tree, among the instances

inline ChildWord make_child(uint kind, std::size_t index)
{
    return kind << 30 | static_cast<uint>(index);
}

// Slots of children from far to near for each octant (bit i: direction negative on axis i), as numbers of `bits` bits,
// the farthest lowest: by their centres along the octant's diagonal. Slots without a child (empty boxes) count as
// farthest.
std::array<uint, 8> order_children(const Box* boxes, uint width);

// Rows of planes: 2 * axis for lower ones, 2 * axis + 1 for upper ones. Children without a primitive have an empty box,
// which no ray enters.
template <uint width_>
struct alignas(width_ * 32) FloatNode
{
    static constexpr uint width = width_;
    static constexpr uint order_bits = width_ == 8 ? 3 : width_ == 4 ? 2 : 1;
    static constexpr uint row_bytes = width_ * sizeof(float); // of planes
    static constexpr bool empty_is_empty =
        true; // infinite planes: no rounding lets a ray meet a child that is not there
    using Order = std::conditional_t<width_ == 8, std::uint32_t, std::uint8_t>;

    float planes[6][width_];
    ChildWord child[width_];
    Order orders[8];

    void set_boxes(const Box (&boxes)[width_]);
    uint order(uint octant) const { return orders[octant]; }
};
using Node2 = FloatNode<2>;
using Node4 = FloatNode<4>;
using Node8 = FloatNode<8>;
static_assert(sizeof(Node2) == 64 && sizeof(Node4) == 128 && sizeof(Node8) == 256);

// Boxes on a grid of 8 bits over the node's own box, rounded outwards: half the size of a Node8 (after Ylitie, Karras,
// Laine 2017, Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs).
struct alignas(128) QuantisedNode
{
    static constexpr uint width = 8;
    static constexpr uint order_bits = 3;
    static constexpr uint row_bytes = 8;
    static constexpr bool empty_is_empty = false; // the planes of an empty box are 255 steps apart: little for far rays

    vec3 origin;
    vec3 scale; // powers of two; a plane is origin + scale * number
    std::uint8_t planes[6][8];
    ChildWord child[8];
    std::uint8_t orders[8][3];

    void set_boxes(const Box (&boxes)[8]);
    uint order(uint octant) const
    {
        return orders[octant][0] | static_cast<uint>(orders[octant][1]) << 8 |
               static_cast<uint>(orders[octant][2]) << 16;
    }
};
static_assert(sizeof(QuantisedNode) == 128);

} // namespace snell
