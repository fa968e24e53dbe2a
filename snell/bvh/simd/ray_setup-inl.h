// Rays made ready for a tree, a vector of them at once. Compiled once for each instruction set.
#if defined(SNELL_BVH_SIMD_RAY_SETUP_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SNELL_BVH_SIMD_RAY_SETUP_INL_H
#undef SNELL_BVH_SIMD_RAY_SETUP_INL_H
#else
#define SNELL_BVH_SIMD_RAY_SETUP_INL_H
#endif

#include "snell/bvh/simd/nodes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace snell {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// The same as is_traceable(), float_before() and enter_space() for rays in the space of a tree: what a ray costs before
// its first node is a fifth of all where rays are short.
struct ReadyRays
{
    using Tag = hn::CappedTag<float, 8>;
    static constexpr std::size_t size = hn::MaxLanes(Tag());
    static_assert(size == 4 || size == 8);

    RaySetup setup[size];
    uint traceable = 0; // bits

    // The rays of pick(0), pick(1) ... pick(size - 1).
    template <uint row_bytes, class Pick>
    HWY_INLINE void prepare(const Box& box, ChildWord root, const Pick& pick)
    {
        const Tag d;
        const hn::RebindToUnsigned<Tag> du;
        const hn::RebindToSigned<Tag> di;
        const hn::FixedTag<float, 4> four;
        using Vec = hn::Vec<Tag>;

        // origin, t_min; direction, t_max
        const auto load = [&](std::size_t i, std::size_t half) HWY_ATTR {
            const auto part = [&](const Ray& ray)
                                  HWY_ATTR { return hn::LoadU(four, half == 0 ? &ray.origin.x : &ray.direction.x); };
            if constexpr (size == 8)
                return hn::Combine(d, part(pick(i + 4)), part(pick(i)));
            else
                return part(pick(i));
        };
        Vec origin[4], direction[4];
        turn(load(0, 0), load(1, 0), load(2, 0), load(3, 0), origin);
        turn(load(0, 1), load(1, 1), load(2, 1), load(3, 1), direction);
        const Vec t_min = origin[3], t_max = direction[3];

        const auto most = hn::Set(d, 1.2676506002282294e30f), largest = hn::Set(d, FLT_MAX), zero = hn::Zero(d);
        const Vec along_axis[3] = {hn::Abs(direction[0]), hn::Abs(direction[1]), hn::Abs(direction[2])};
        auto ok = hn::Lt(t_min, t_max);
        auto reach = zero, coordinate = zero, longest = zero;
        for (int axis = 0; axis < 3; ++axis) {
            const auto distance = hn::Abs(origin[axis]);
            ok = hn::And(ok, hn::And(hn::Le(along_axis[axis], most), hn::Le(distance, largest)));
            longest = hn::Max(longest, along_axis[axis]);
            const auto lower = hn::Set(d, box.lower[axis]), upper = hn::Set(d, box.upper[axis]);
            reach =
                hn::Max(reach, hn::Max(hn::Abs(hn::Sub(lower, origin[axis])), hn::Abs(hn::Sub(upper, origin[axis]))));
            coordinate = hn::Max(coordinate, hn::Max(distance, hn::Max(hn::Abs(lower), hn::Abs(upper))));
        }
        traceable = mask_bits(d, hn::And(ok, hn::Ge(longest, hn::Set(d, 7.8886090522101181e-31f))));

        const auto bits = hn::BitCast(di, t_max);
        const auto below_zero = hn::IfThenElse(hn::Lt(t_max, zero), hn::BitCast(d, hn::Add(bits, hn::Set(di, 1))),
                                               hn::BitCast(d, hn::Set(du, 0x80000001u)));
        const auto best =
            hn::IfThenElse(hn::Gt(t_max, zero), hn::BitCast(d, hn::Sub(bits, hn::Set(di, 1))), below_zero);

        const auto limit = hn::Div(hn::Set(d, 1e36f), hn::Add(coordinate, hn::Set(d, 1e-2f)));
        const auto far_slack = hn::Add(hn::Mul(reach, hn::Set(d, slack_by_reach)), hn::Set(d, 1e-30f));
        Vec inverse[3], enter[3], leave[3], reciprocal[3], row[3];
        auto octant = hn::Zero(du);
        for (int axis = 0; axis < 3; ++axis) {
            reciprocal[axis] = hn::Div(hn::Set(d, 1.0f), direction[axis]);
            const auto slack = hn::Add(hn::Mul(hn::Abs(origin[axis]), hn::Set(d, slack_by_origin)), far_slack);
            const auto along = hn::CopySign(slack, reciprocal[axis]);
            inverse[axis] = hn::Max(hn::Min(reciprocal[axis], limit), hn::Neg(limit));
            enter[axis] = hn::Mul(hn::Add(origin[axis], along), inverse[axis]);
            leave[axis] = hn::Mul(hn::Sub(origin[axis], along), inverse[axis]);
            const auto negative = hn::ShiftRight<31>(hn::BitCast(du, reciprocal[axis]));
            octant = hn::Or(octant, hn::ShiftLeftSame(negative, axis));
            const auto first = hn::Set(du, 2 * static_cast<uint>(axis) * row_bytes);
            row[axis] = hn::BitCast(d, hn::Add(first, hn::Mul(negative, hn::Set(du, row_bytes))));
        }

        // shear_ray()
        const auto is_x = hn::And(hn::Ge(along_axis[0], along_axis[1]), hn::Ge(along_axis[0], along_axis[2]));
        const auto is_y = hn::Ge(along_axis[1], along_axis[2]);
        const auto choose = [&](Vec x, Vec y, Vec z)
                                HWY_ATTR { return hn::IfThenElse(is_x, x, hn::IfThenElse(is_y, y, z)); };
        const auto& o = origin;
        const auto& v = direction;
        const auto z = choose(v[0], v[1], v[2]);
        const auto axes = choose(hn::BitCast(d, hn::Set(du, 0x000201u)), hn::BitCast(d, hn::Set(du, 0x010002u)),
                                 hn::BitCast(d, hn::Set(du, 0x020100u)));

        put(0, inverse[0], inverse[1], inverse[2], enter[0]);
        put(4, enter[1], enter[2], leave[0], leave[1]);
        put(8, leave[2], t_min, best, row[0]);
        put(12, row[1], row[2], hn::BitCast(d, octant), hn::BitCast(d, hn::Set(du, root)));
        put(16, hn::Div(choose(v[1], v[2], v[0]), z), hn::Div(choose(v[2], v[0], v[1]), z),
            choose(reciprocal[0], reciprocal[1], reciprocal[2]), choose(o[1], o[2], o[0]));
        put(20, choose(o[2], o[0], o[1]), choose(o[0], o[1], o[2]), axes, hn::BitCast(d, hn::Set(du, none)));
    }

  private:
    // Rows to columns, in each 128 bits.
    template <class V>
    static HWY_INLINE void turn(V a, V b, V c, V e, V (&columns)[4])
    {
        const Tag d;
        const auto xy_even = hn::InterleaveLower(d, a, c), zw_even = hn::InterleaveUpper(d, a, c);
        const auto xy_odd = hn::InterleaveLower(d, b, e), zw_odd = hn::InterleaveUpper(d, b, e);
        columns[0] = hn::InterleaveLower(d, xy_even, xy_odd);
        columns[1] = hn::InterleaveUpper(d, xy_even, xy_odd);
        columns[2] = hn::InterleaveLower(d, zw_even, zw_odd);
        columns[3] = hn::InterleaveUpper(d, zw_even, zw_odd);
    }

    // Four words of each ray's RaySetup.
    template <class V>
    HWY_INLINE void put(std::size_t word, V a, V b, V c, V e)
    {
        const hn::FixedTag<float, 4> four;
        V rays[4];
        turn(a, b, c, e, rays);
        for (std::size_t i = 0; i < 4; ++i) {
            const auto at = [&](std::size_t ray) { return setup[ray].inverse + word; };
            if constexpr (size == 8) {
                hn::StoreU(hn::LowerHalf(four, rays[i]), four, at(i));
                hn::StoreU(hn::UpperHalf(four, rays[i]), four, at(i + 4));
            } else {
                hn::StoreU(rays[i], four, at(i));
            }
        }
    }
};

} // namespace HWY_NAMESPACE
} // namespace snell
HWY_AFTER_NAMESPACE();

#endif
