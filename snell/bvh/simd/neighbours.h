// Which neighbour on a curve a cluster of primitives would best be joined with.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace snell {

inline constexpr std::size_t neighbour_radius = 10; // how far along the curve
inline constexpr float full_leaf_factor = 1.5f;     // how much dearer a surface is that is more than a leaf

// The neighbour that a cluster wants is a number: the surface of the two together, less its last bits, which hold who
// it is as seen from the lower one of the two, `d` before the other: d - 1 and, in the last bit, its side(). Both of a
// pair see the same number. Among equal surfaces near ones come first, and of those at the same distance every other
// one: whole rows of equals pair up in one round. (With ties to the lower index such a row would merge a pair a round.)
inline constexpr std::uint32_t neighbour_mask = 31, no_neighbour = ~0u;
static_assert(2 * neighbour_radius <= neighbour_mask + 1);

// Differs between i and i - d, for any i.
constexpr std::uint32_t neighbour_side(std::size_t i, std::size_t d)
{
    return static_cast<std::uint32_t>(i >> std::countr_zero(d)) & 1;
}

constexpr std::size_t wanted_neighbour(std::size_t i, std::uint32_t key)
{
    const std::size_t d = ((key & neighbour_mask) >> 1) + 1;
    return neighbour_side(i, d) == (key & 1) ? i + d : i - d;
}

// Boxes as lower x, y, z, upper x, y, z, then the number of primitives, where all above max_leaf_size are as good as
// each other. From cluster_margin before the first one to as much behind the last one there must be memory to read.
using ClusterPlanes = std::array<const float*, 7>;
inline constexpr std::size_t cluster_margin = 32;

// wanted[i] becomes the number for cluster i, for i in [begin, end), of `count` clusters in all. The same on every
// instruction set.
void find_neighbours(const ClusterPlanes& planes, std::size_t begin, std::size_t end, std::size_t count,
                     std::uint32_t* wanted);

} // namespace snell
