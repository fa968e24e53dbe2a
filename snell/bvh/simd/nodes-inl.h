// Inner nodes: preparing a ray for a tree, the slab test, and the stack. Compiled once for each instruction set
// (Highway's way: the toggling include guard lets it be read again and again).
#if defined(SNELL_BVH_SIMD_NODES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SNELL_BVH_SIMD_NODES_INL_H
#undef SNELL_BVH_SIMD_NODES_INL_H
#else
#define SNELL_BVH_SIMD_NODES_INL_H
#endif

#include "snell/bvh/simd/ray_state.h"

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace snell {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

enum class Query
{
    closest,
    counted, // closest, and counts steps
    next,    // closest behind a given hit
    any
};

// Lanes of a mask as bits.
template <class D>
HWY_INLINE uint mask_bits(D d, hn::Mask<D> mask)
{
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, mask, bits);
    return bits[0];
}

// Prepares for a tree in the space of `ray`, which is traceable; the root's box is not empty.
HWY_INLINE void enter_space(RayState& s, const Ray& ray, const WideRoot& root, uint instance)
{
    const hn::FixedTag<float, 4> d; // x, y, z, and a lane of no meaning
    const auto origin = hn::LoadU(d, &ray.origin.x);
    const auto direction = hn::LoadU(d, &ray.direction.x);
    const auto reciprocal = hn::Div(hn::Set(d, 1.0f), direction);
    const auto lower = hn::Load(d, root.lower), upper = hn::Load(d, root.upper);
    const auto distance = hn::Max(hn::Abs(hn::Sub(lower, origin)), hn::Abs(hn::Sub(upper, origin)));
    const auto coordinate = hn::Max(hn::Abs(origin), hn::Max(hn::Abs(lower), hn::Abs(upper)));
    alignas(16) float distances[4], coordinates[4];
    hn::Store(distance, d, distances);
    hn::Store(coordinate, d, coordinates);
    const float reach = max(max(distances[0], distances[1]), distances[2]);
    const float limit = 1e36f / (max(max(coordinates[0], coordinates[1]), coordinates[2]) + 1e-2f);

    const auto relative = hn::Mul(hn::Abs(origin), hn::Set(d, 0x1p-22f));
    const auto slack = hn::Add(relative, hn::Set(d, reach * 0x1p-21f + 1e-30f));
    const auto along = hn::CopySign(slack, reciprocal);
    const auto inverse = hn::Max(hn::Min(reciprocal, hn::Set(d, limit)), hn::Set(d, -limit));
    hn::Store(inverse, d, s.inverse);
    hn::Store(hn::Mul(hn::Add(origin, along), inverse), d, s.enter_term);
    hn::Store(hn::Mul(hn::Sub(origin, along), inverse), d, s.leave_term);
    s.octant = mask_bits(d, hn::Lt(reciprocal, hn::Zero(d))) & 7u;
    s.instance = instance;
    s.ray = ray;

    // shear_ray(), from arrays: vec3's operator[] branches.
    alignas(16) float o[4], r[4], v[4];
    hn::Store(origin, d, o);
    hn::Store(reciprocal, d, r);
    hn::Store(direction, d, v);
    const int kz = longest_axis(ray.direction);
    const int kx = next_axis[kz], ky = next_axis[kx];
    s.shear = {kx, ky, kz, v[kx] / v[kz], v[ky] / v[kz], r[kz]};
    s.shear_origin[0] = o[kx];
    s.shear_origin[1] = o[ky];
    s.shear_origin[2] = o[kz];
}

// The part of the state that slab tests need, in registers.
struct SlabRay
{
    using Tag = hn::CappedTag<float, node_width>;
    using Vec = hn::Vec<Tag>;
    Vec inverse_x, inverse_y, inverse_z, enter_x, enter_y, enter_z, leave_x, leave_y, leave_z, t_min;
    SlabRows rows;
};

HWY_INLINE SlabRay load_slab_ray(const RayState& s)
{
    const SlabRay::Tag d;
    return {hn::Set(d, s.inverse[0]),    hn::Set(d, s.inverse[1]),    hn::Set(d, s.inverse[2]),
            hn::Set(d, s.enter_term[0]), hn::Set(d, s.enter_term[1]), hn::Set(d, s.enter_term[2]),
            hn::Set(d, s.leave_term[0]), hn::Set(d, s.leave_term[1]), hn::Set(d, s.leave_term[2]),
            hn::Set(d, s.t_min),         rows_by_octant[s.octant]};
}

// Where the ray enters and leaves the boxes of a node, or of half of it where vectors are short.
struct Slabs
{
    using Tag = SlabRay::Tag;
    SlabRay::Vec enter, leave;
};

HWY_INLINE Slabs test_slabs(const WideNode& node, const SlabRay& r, float best, std::size_t half)
{
    const Slabs::Tag d;
    const float* planes = &node.planes[0][0] + half;
    const auto enter_x = hn::MulSub(hn::Load(d, planes + r.rows.enter[0]), r.inverse_x, r.enter_x);
    const auto enter_y = hn::MulSub(hn::Load(d, planes + r.rows.enter[1]), r.inverse_y, r.enter_y);
    const auto enter_z = hn::MulSub(hn::Load(d, planes + r.rows.enter[2]), r.inverse_z, r.enter_z);
    const auto leave_x = hn::MulSub(hn::Load(d, planes + r.rows.leave[0]), r.inverse_x, r.leave_x);
    const auto leave_y = hn::MulSub(hn::Load(d, planes + r.rows.leave[1]), r.inverse_y, r.leave_y);
    const auto leave_z = hn::MulSub(hn::Load(d, planes + r.rows.leave[2]), r.inverse_z, r.leave_z);
    return {hn::Max(hn::Max(enter_x, enter_y), hn::Max(enter_z, r.t_min)),
            hn::Min(hn::Min(leave_x, leave_y), hn::Min(leave_z, hn::Set(d, best)))};
}

// Lane numbers in the low three bits, whatever is above.
template <class D, class V>
HWY_INLINE auto lanes_of(D d, V numbers)
{
    const hn::RebindToUnsigned<D> du;
    return hn::IndicesFromVec(d, hn::And(numbers, hn::Set(du, hn::MaxLanes(d) - 1)));
}

// Pushes the children that the ray meets, the nearest last. Returns the new number of entries.
template <Query query>
HWY_INLINE uint push_children(const WideNode& node, const RayState& s, const SlabRay& slab_ray, const Slabs& slabs,
                              std::size_t stride, uint size)
{
    const Slabs::Tag d;
    const hn::RebindToUnsigned<Slabs::Tag> du;
    constexpr std::size_t n = hn::MaxLanes(d);
    ChildWord* const words = s.stack + size;
    uint* const distances = words + stride;
    const uint order = node.order[s.octant];
    if constexpr (n == node_width) {
        const auto by_lane = hn::ShiftLeft<2>(hn::Iota(du, 0));
        const auto front_to_back = hn::Shr(hn::Set(du, order), by_lane);
        const auto children = hn::Load(du, node.child);
#if HWY_TARGET <= HWY_AVX3
        const auto enter = hn::TableLookupLanes(slabs.enter, lanes_of(d, front_to_back));
        const auto leave = hn::TableLookupLanes(slabs.leave, lanes_of(d, front_to_back));
        const auto met = hn::RebindMask(du, hn::Le(enter, leave));
        const auto sorted = hn::TableLookupLanes(children, lanes_of(du, front_to_back));
        hn::StoreU(hn::Compress(sorted, met), du, words);
        if (query != Query::any) hn::StoreU(hn::Compress(hn::BitCast(du, enter), met), du, distances);
        return size + static_cast<uint>(hn::CountTrue(du, met));
#else
        // Highway's Compress copies its table to the stack at each call when GCC 12 compiles it for AVX2.
        const auto met = hn::VecFromMask(d, hn::Le(slabs.enter, slabs.leave));
        const uint bits = mask_bits(d, hn::MaskFromVec(hn::TableLookupLanes(met, lanes_of(d, front_to_back))));
        const auto kept = hn::Shr(hn::Set(du, lane_lists.lanes[bits]), by_lane);
        const auto lanes = hn::TableLookupLanes(front_to_back, lanes_of(du, kept));
        hn::StoreU(hn::TableLookupLanes(children, lanes_of(du, lanes)), du, words);
        if (query != Query::any)
            hn::StoreU(hn::TableLookupLanes(hn::BitCast(du, slabs.enter), lanes_of(du, lanes)), du, distances);
        return size + static_cast<uint>(hwy::PopCount(bits));
#endif
    } else {
        alignas(16) uint t[node_width];
        uint met = 0;
        Slabs part = slabs;
        for (std::size_t half = 0;; part = test_slabs(node, slab_ray, s.best, half)) {
            hn::Store(hn::BitCast(du, part.enter), du, t + half);
            met |= mask_bits(d, hn::Le(part.enter, part.leave)) << half;
            half += n;
            if (half >= node_width) break;
        }
        uint count = 0;
        for (uint i = 0; i < node_width; ++i) {
            const uint lane = order >> (4 * i) & (node_width - 1);
            words[count] = node.child[lane];
            distances[count] = t[lane];
            count += met >> lane & 1u;
        }
        return size + count;
    }
}

// Stores the lanes in `set` of both vectors side by side and returns how many they are.
HWY_INLINE uint store_lanes(uint set, hn::Vec<hn::RebindToUnsigned<Slabs::Tag>> a, uint* to_a,
                            hn::Vec<hn::RebindToUnsigned<Slabs::Tag>> b, uint* to_b)
{
    const hn::RebindToUnsigned<Slabs::Tag> du;
    const auto lanes = hn::Shr(hn::Set(du, lane_lists.lanes[set]), hn::ShiftLeft<2>(hn::Iota(du, 0)));
    hn::StoreU(hn::TableLookupLanes(a, lanes_of(du, lanes)), du, to_a);
    hn::StoreU(hn::TableLookupLanes(b, lanes_of(du, lanes)), du, to_b);
    return static_cast<uint>(hwy::PopCount(set));
}

// Takes what lies beyond the nearest hit off the stack, so that popping needs no comparison.
HWY_INLINE void drop_farther(RayState& s, std::size_t stride)
{
    const Slabs::Tag d;
    const hn::RebindToUnsigned<Slabs::Tag> du;
    constexpr uint n = hn::MaxLanes(d);
    uint* const words = s.stack;
    uint* const distances = s.stack + stride;
    uint kept = 0;
    for (uint i = 0; i < s.stack_size; i += n) {
        const auto distance = hn::LoadU(du, distances + i);
        const uint all = s.stack_size - i < n ? (1u << (s.stack_size - i)) - 1 : (1u << n) - 1;
        const uint near = all & mask_bits(d, hn::Le(hn::BitCast(d, distance), hn::Set(d, s.best)));
        kept += store_lanes(near, hn::LoadU(du, words + i), words + kept, distance, distances + kept);
    }
    s.stack_size = kept;
}

} // namespace HWY_NAMESPACE
} // namespace snell
HWY_AFTER_NAMESPACE();

#endif
