#include "snell/bvh/simd/neighbours.h"

#include "snell/bvh/tree.h"

#define HWY_DISABLE_PCLMUL_AES
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "snell/bvh/simd/neighbours.cpp"
#include <hwy/foreach_target.h>

#include <hwy/highway.h>

#include <algorithm>

HWY_BEFORE_NAMESPACE();
namespace snell {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::CappedTag<float, 16>;
using Codes = hn::RebindToUnsigned<Floats>;
using Vec = hn::Vec<Floats>;
using Code = hn::Vec<Codes>;

struct Boxes
{
    Vec plane[7];
};

HWY_INLINE Boxes load(const ClusterPlanes& planes, std::size_t i)
{
    Boxes boxes;
    for (std::size_t p = 0; p < 7; ++p) boxes.plane[p] = hn::LoadU(Floats(), planes[p] + i);
    return boxes;
}

HWY_INLINE Code surface_key(const Boxes& a, const Boxes& b, Code who)
{
    const Floats df;
    const Codes du;
    Vec e[3];
    for (int axis = 0; axis < 3; ++axis)
        e[axis] = hn::Sub(hn::Max(a.plane[axis + 3], b.plane[axis + 3]), hn::Min(a.plane[axis], b.plane[axis]));
    const Vec area = hn::Add(hn::Mul(e[0], hn::Add(e[1], e[2])), hn::Mul(e[1], e[2]));
    const Vec count = hn::Add(a.plane[6], b.plane[6]);
    const auto is_node = hn::Gt(count, hn::Set(df, static_cast<float>(max_leaf_size)));
    const Vec cost = hn::IfThenElse(is_node, hn::Mul(area, hn::Set(df, full_leaf_factor)), area);
    // Not negative; the sign bit goes, for the NaN of an overflow may have one.
    return hn::Or(hn::And(hn::BitCast(du, cost), hn::Set(du, 0x7fffffffu & ~neighbour_mask)), who);
}

// ends: some of these clusters are so near to an end of the row that it has not all neighbours.
template <bool ends>
HWY_INLINE Code best_keys(const ClusterPlanes& planes, std::size_t i, std::size_t count)
{
    const Codes du;
    const Boxes self = load(planes, i);
    const Code index = hn::Iota(du, static_cast<std::uint32_t>(i));
    const Code one = hn::Set(du, 1), none = hn::Set(du, no_neighbour);
    Code best = none;
    for (std::size_t d = 1; d <= neighbour_radius; ++d) {
        if (ends && d >= count) break;
        const Code distance = hn::Set(du, static_cast<std::uint32_t>((d - 1) << 1));
        const Code side = hn::And(hn::ShiftRightSame(index, std::countr_zero(d)), one);
        Code after = surface_key(self, load(planes, i + d), hn::Or(distance, side));
        Code before = surface_key(self, load(planes, i - d), hn::Or(distance, hn::Xor(side, one)));
        if (ends) {
            const Code last = hn::Set(du, static_cast<std::uint32_t>(count - d));
            after = hn::IfThenElse(hn::Lt(index, last), after, none);
            before = hn::IfThenElse(hn::Lt(index, hn::Set(du, static_cast<std::uint32_t>(d))), none, before);
        }
        best = hn::Min(best, hn::Min(after, before));
    }
    return best;
}

void find(const ClusterPlanes& planes, std::size_t begin, std::size_t end, std::size_t count, std::uint32_t* wanted)
{
    const Codes du;
    const std::size_t lanes = hn::Lanes(du);
    for (std::size_t i = begin; i < end; i += lanes) {
        const bool inside = i >= neighbour_radius && i + lanes + neighbour_radius <= count;
        const Code best = inside ? best_keys<false>(planes, i, count) : best_keys<true>(planes, i, count);
        if (i + lanes <= end) {
            hn::StoreU(best, du, wanted + i);
        } else {
            HWY_ALIGN std::uint32_t last[16];
            hn::Store(best, du, last);
            std::copy_n(last, end - i, wanted + i);
        }
    }
}

} // namespace
} // namespace HWY_NAMESPACE
} // namespace snell
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace snell {

HWY_EXPORT(find);

void find_neighbours(const ClusterPlanes& planes, std::size_t begin, std::size_t end, std::size_t count,
                     std::uint32_t* wanted)
{
    static_assert(cluster_margin >= 16 + neighbour_radius);
    HWY_DYNAMIC_DISPATCH(find)(planes, begin, end, count, wanted);
}

} // namespace snell
#endif
