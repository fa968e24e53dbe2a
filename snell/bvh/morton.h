// Primitives in the order of a curve that keeps neighbours together.
#pragma once

#include "snell/bvh/scratch.h"
#include "snell/bvh/tree.h"

#include <array>
#include <cstdint>
#include <span>

namespace snell {

// Cells of a box, numbered along a Morton curve of `bits` bits. Each bit, from the highest on, halves the cells along
// the axis where they are longest then (Vinkler, Bittner, Havran 2017, Extended Morton Codes for High Performance
// Bounding Volume Hierarchy Construction, without the bits for sizes), so that cells are near cubes in any box.
class MortonGrid
{
  public:
    MortonGrid(const Box& quarters, int bits); // quarters: of what quarter_centre() returns; bits: 1 to 63

    // Half a centre: it has no overflow, nor has the distance between two.
    static vec3 quarter_centre(const PrimitiveRef& ref) { return 0.25f * ref.lower + 0.25f * ref.upper; }

    int bits() const { return bits_; }
    std::uint64_t code(const PrimitiveRef& ref) const;

  private:
    static constexpr int bits_per_axis = 24; // more than a float between two powers of two can tell apart
    static constexpr std::size_t bytes_per_axis = bits_per_axis / 8;

    alignas(16) float origin_[4] = {}, scale_[4] = {}, last_[4] = {};
    int bits_ = 0;
    // By axis, byte of the cell's number and the byte's value: the bits of the code.
    std::array<std::array<std::array<std::uint64_t, 256>, bytes_per_axis>, 3> spread_;
};

// A sorted code; neighbours that share one are in the order of their indices.
struct MortonKey
{
    std::uint64_t code;
    std::uint32_t index; // of the reference
};

// References in the order of a Morton curve, those in the same cell by index. One of the two lists is used: `packed`
// has the code above index_bits bits of index; where cells would be too large for that, because primitives crowd in few
// places or are very many, `wide` has full codes.
struct MortonOrder
{
    Scratch<std::uint64_t> packed;
    Scratch<MortonKey> wide;
    int index_bits = 0;
    uint kinds = 0; // bit k is set where a reference has RefKind(k)

    std::size_t size() const { return packed.size() + wide.size(); }
    bool is_wide() const { return wide.size() > 0; }
    // Which reference is at place i.
    std::size_t index(std::size_t i) const
    {
        return is_wide() ? wide[i].index : packed[i] & ((std::uint64_t{1} << index_bits) - 1);
    }
};

// The same for any number of threads. Fewer than 2^30 references.
MortonOrder sort_by_morton(std::span<const PrimitiveRef> refs);

// Stable, by bits [first, first + count) of the number or code, in parallel; `scratch` has the same size, and its
// content is lost.
void radix_sort(Scratch<std::uint64_t>& keys, Scratch<std::uint64_t>& scratch, int first, int count);
void radix_sort(Scratch<MortonKey>& keys, Scratch<MortonKey>& scratch, int first, int count);

} // namespace snell
