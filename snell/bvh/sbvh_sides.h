// Dividing a set of references in two: who goes where, and writing them there. For sbvh.cpp.
#pragma once

#include "snell/bvh/clip.h"
#include "snell/bvh/sbvh_bins.h"

namespace snell::sbvh {

struct WeighedExtents : Extents
{
    double weight = 0; // the surfaces of the references

    void extend(const PrimitiveRef& ref)
    {
        Extents::extend(ref);
        weight += double(half_area(WideBox{load3(ref.lower), load3(ref.upper)}));
    }
    void extend(const WeighedExtents& e)
    {
        Extents::extend(e);
        weight += e.weight;
    }
};

enum class Side
{
    left,
    right,
    both
};

// Ways to say on which side a reference goes, by itself and its number in the set.
struct ByNumber
{
    std::size_t left_count;
    bool operator()(const PrimitiveRef&, std::size_t number) const { return number < left_count; }
};

struct ByCentre
{
    const Slabs& slabs;
    const Split& split;
    bool operator()(const PrimitiveRef& ref, std::size_t) const
    {
        alignas(16) std::int32_t bin[4];
        slabs.find(hn::Add(load3(ref.lower), load3(ref.upper)), bin);
        return bin[split.axis] < static_cast<std::int32_t>(split.bin);
    }
};

// Cuts triangles at a plane, or leaves them whole where that is cheaper.
class ByPlane
{
  public:
    ByPlane(const PackedScene& packed, const Split& best, float where)
        : scene(packed), split(best), plane(where), left_area(half_area(split.left)),
          right_area(half_area(split.right)), left_count(static_cast<float>(split.left_count)),
          right_count(static_cast<float>(split.right_count))
    {
    }

    // left and right are the reference's parts, where they are on that side.
    Side operator()(const PrimitiveRef& ref, PrimitiveRef& left, PrimitiveRef& right) const
    {
        left = right = ref;
        const int axis = split.axis;
        if (ref.upper[axis] <= plane) return Side::left;
        if (ref.lower[axis] >= plane) return Side::right;
        if (ref.kind != RefKind::triangle)
            return 0.5f * ref.lower[axis] + 0.5f * ref.upper[axis] < plane ? Side::left : Side::right;

        // Reference unsplitting. By what the bins said of the sides, whatever becomes of other references, so that
        // their order does not matter.
        const Vec4 lo = load3(ref.lower), hi = load3(ref.upper);
        WideBox with_left = split.left, with_right = split.right;
        with_left.extend(lo, hi);
        with_right.extend(lo, hi);
        const float both = left_area * left_count + right_area * right_count;
        const float only_left = half_area(with_left) * left_count + right_area * (right_count - 1.0f);
        const float only_right = left_area * (left_count - 1.0f) + half_area(with_right) * right_count;
        if (std::min(only_left, only_right) < both) return only_left <= only_right ? Side::left : Side::right;

        const Triangle& tri = scene.triangles[ref.index];
        const vec3 v[3] = {scene.positions[tri.v0], scene.positions[tri.v1], scene.positions[tri.v2]};
        const CutBoxes cut = cut_triangle(v, axis, plane);
        const Box whole = {ref.lower, ref.upper};
        const Box below = intersection(cut.below, whole), above = intersection(cut.above, whole);
        // Where earlier cuts have left nothing of one part, the other is all there is.
        if (above.empty()) return Side::left;
        if (below.empty()) return Side::right;
        left.lower = below.lower, left.upper = below.upper;
        right.lower = above.lower, right.upper = above.upper;
        return Side::both;
    }

  private:
    const PackedScene& scene;
    const Split& split;
    float plane, left_area, right_area, left_count, right_count;
};

// Both ends of a region that is being filled.
struct Ends
{
    PrimitiveRef* left;  // where the next one goes
    PrimitiveRef* right; // one past where the next one goes
    WeighedExtents left_extents, right_extents;
};

inline constexpr std::size_t block_size = 256; // so few that they are still in the first-level cache for the extents

// Writes the references to either end. first: the number of the first one in their set.
template <class IsLeft>
bool write_sides(std::span<const PrimitiveRef> refs, std::size_t first, const IsLeft& is_left, Ends& ends)
{
    for (std::size_t i = 0; i < refs.size();) {
        const PrimitiveRef *left = ends.left, *right = ends.right;
        for (const std::size_t stop = std::min(i + block_size, refs.size()); i < stop; ++i) {
            // No branch: which side it is nobody can foresee.
            const std::ptrdiff_t is = is_left(refs[i], first + i) ? 1 : 0;
            PrimitiveRef* const to[2] = {ends.right - 1, ends.left};
            *to[is] = refs[i];
            ends.left += is;
            ends.right -= 1 - is;
        }
        for (; left < ends.left; ++left) ends.left_extents.extend(*left);
        for (; right > ends.right; --right) ends.right_extents.extend(right[-1]);
    }
    return true;
}

// The same with cuts. False if the ends would cross.
inline bool write_sides(std::span<const PrimitiveRef> refs, std::size_t, const ByPlane& side_of, Ends& ends)
{
    PrimitiveRef left, right;
    for (const PrimitiveRef& ref : refs) {
        const Side side = side_of(ref, left, right);
        if (ends.right - ends.left < (side == Side::both ? 2 : 1)) return false;
        if (side != Side::right) *ends.left++ = left, ends.left_extents.extend(left);
        if (side != Side::left) *--ends.right = right, ends.right_extents.extend(right);
    }
    return true;
}

struct Counts
{
    std::size_t left = 0, right = 0;
};

template <class IsLeft>
Counts count_sides(std::span<const PrimitiveRef> refs, std::size_t first, const IsLeft& is_left)
{
    std::size_t left = 0;
    for (std::size_t i = 0; i < refs.size(); ++i) left += is_left(refs[i], first + i) ? 1 : 0;
    return {left, refs.size() - left};
}

inline Counts count_sides(std::span<const PrimitiveRef> refs, std::size_t, const ByPlane& side_of)
{
    Counts counts;
    PrimitiveRef left, right;
    for (const PrimitiveRef& ref : refs) {
        const Side side = side_of(ref, left, right);
        counts.left += side != Side::right;
        counts.right += side != Side::left;
    }
    return counts;
}

} // namespace snell::sbvh
