// The rays of a packet side by side, and what they have in common. Compiled once for each instruction set.
#if defined(SNELL_BVH_SIMD_PACKET_RAYS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SNELL_BVH_SIMD_PACKET_RAYS_INL_H
#undef SNELL_BVH_SIMD_PACKET_RAYS_INL_H
#else
#define SNELL_BVH_SIMD_PACKET_RAYS_INL_H
#endif

#include "snell/bvh/simd/nodes-inl.h"

#include <utility>

HWY_BEFORE_NAMESPACE();
namespace snell {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr uint packet_size = 64;

// A lane for each ray, as bits.
using Lanes = std::uint64_t;

// Rays side by side. Lanes without a ray, and those that have found what they looked for, have best = -infinity: no
// box and no triangle is as near as that.
struct alignas(64) Packet
{
    using Tag = hn::CappedTag<float, 16>;

    float origin[3][packet_size], direction[3][packet_size];                     // x, y, z
    float inverse[3][packet_size], enter[3][packet_size], leave[3][packet_size]; // as in RayState
    float shear[3][packet_size];                                                 // sx, sy, sz of ShearedRay
    float t_min[packet_size], best[packet_size];
    float t[packet_size], u[packet_size], v[packet_size]; // with the next two: Hit
    uint primitive[packet_size], instance[packet_size];
    uint ray_index[packet_size]; // in the batch
    uint count;                  // lanes with a ray, the first ones
    uint octant;                 // of all rays
    int kx, ky, kz;              // of all rays
};

// What all rays of a packet have in common, as intervals: from where to where they start and how steep they are. One
// slab test with these, on the eight children of a node or the eight triangles of a leaf at once, leaves out most of
// those that no ray meets. Distances are taken as (plane - origin) * inverse here: as a difference of two products they
// would be as uncertain as the slopes times the distance from the world's origin. The roundings are then those of the
// difference, the product and the reciprocal, 3 u reach in the terms of RayState, and 2 u |origin|; the slack is twice
// that of single rays.
struct PacketBounds
{
    float enter_from[3], leave_from[3]; // the origins, moved back or forth, that enter first and leave last
    float least[3], most[3];            // of inverse
    float t_min;
    uint row[3]; // of planes where the rays enter
};

// Runs part(first lane) for each vector of the packet that holds a ray.
template <class Part>
HWY_INLINE void for_parts(const Packet& p, const Part& part)
{
    constexpr uint n = hn::MaxLanes(Packet::Tag());
    for (uint i = 0; i < p.count; i += n) part(i);
}

// Likewise for each vector that holds one of these lanes.
template <class Part>
HWY_INLINE void for_parts_of(Lanes lanes, const Part& part)
{
    constexpr uint n = hn::MaxLanes(Packet::Tag());
    while (lanes != 0) {
        const uint i = static_cast<uint>(hwy::Num0BitsBelowLS1Bit_Nonzero64(lanes)) / n * n;
        lanes &= ~(((Lanes{1} << n) - 1) << i);
        part(i);
    }
}

HWY_INLINE Lanes all_lanes(const Packet& p)
{
    return ~Lanes{0} >> (packet_size - p.count);
}

// The lanes of a vector that begins at `first`.
HWY_INLINE Lanes packet_lanes(uint first, hn::Mask<Packet::Tag> mask)
{
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(Packet::Tag(), mask, bits);
    return static_cast<Lanes>(bits[0] | static_cast<uint>(bits[1]) << 8) << first;
}

HWY_INLINE float least_of(const Packet& p, const float (&x)[packet_size])
{
    const Packet::Tag d;
    auto r = hn::Load(d, x);
    for_parts(p, [&](uint i) HWY_ATTR { r = hn::Min(r, hn::Load(d, x + i)); });
    return hn::GetLane(hn::MinOfLanes(d, r));
}

HWY_INLINE float most_of(const Packet& p, const float (&x)[packet_size])
{
    const Packet::Tag d;
    auto r = hn::Load(d, x);
    for_parts(p, [&](uint i) HWY_ATTR { r = hn::Max(r, hn::Load(d, x + i)); });
    return hn::GetLane(hn::MaxOfLanes(d, r));
}

// Puts four rays side by side.
HWY_INLINE void put_four(Packet& p, uint first, const Ray* const (&rays)[4])
{
    const hn::FixedTag<float, 4> d;
    const auto turn = [&](auto load, float* x, float* y, float* z, float* w) HWY_ATTR {
        const auto a = load(0), b = load(1), c = load(2), e = load(3);
        const auto xy_even = hn::InterleaveLower(a, c), zw_even = hn::InterleaveUpper(d, a, c);
        const auto xy_odd = hn::InterleaveLower(b, e), zw_odd = hn::InterleaveUpper(d, b, e);
        hn::Store(hn::InterleaveLower(xy_even, xy_odd), d, x + first);
        hn::Store(hn::InterleaveUpper(d, xy_even, xy_odd), d, y + first);
        hn::Store(hn::InterleaveLower(zw_even, zw_odd), d, z + first);
        hn::Store(hn::InterleaveUpper(d, zw_even, zw_odd), d, w + first);
    };
    turn([&](int i) HWY_ATTR { return hn::LoadU(d, &rays[i]->origin.x); }, p.origin[0], p.origin[1], p.origin[2],
         p.t_min);
    turn([&](int i) HWY_ATTR { return hn::LoadU(d, &rays[i]->direction.x); }, p.direction[0], p.direction[1],
         p.direction[2], p.t);
}

// What rays must agree on to travel together: three times the octant and the longest axis. Rays that are not
// traceable: no_kind.
constexpr uint no_kind = 24;
HWY_INLINE void kinds_of(const Packet& p, uint (&kinds)[packet_size])
{
    const Packet::Tag d;
    const hn::RebindToUnsigned<Packet::Tag> du;
    for_parts(p, [&](uint i) HWY_ATTR {
        const auto x = hn::Load(d, p.direction[0] + i), y = hn::Load(d, p.direction[1] + i);
        const auto z = hn::Load(d, p.direction[2] + i);
        const auto ax = hn::Abs(x), ay = hn::Abs(y), az = hn::Abs(z);
        // is_traceable()
        const auto most = hn::Set(d, 1.2676506002282294e30f), limit = hn::Set(d, FLT_MAX);
        auto ok = hn::And(hn::And(hn::Le(ax, most), hn::Le(ay, most)), hn::Le(az, most));
        ok = hn::And(ok, hn::Ge(hn::Max(ax, hn::Max(ay, az)), hn::Set(d, 7.8886090522101181e-31f)));
        for (int axis = 0; axis < 3; ++axis) ok = hn::And(ok, hn::Le(hn::Abs(hn::Load(d, p.origin[axis] + i)), limit));
        ok = hn::And(ok, hn::Lt(hn::Load(d, p.t_min + i), hn::Load(d, p.t + i)));
        const auto sign = [&](auto v) HWY_ATTR { return hn::ShiftRight<31>(hn::BitCast(du, v)); };
        const auto octant = hn::Or(sign(x), hn::Or(hn::ShiftLeft<1>(sign(y)), hn::ShiftLeft<2>(sign(z))));
        // longest_axis()
        const auto is_x = hn::And(hn::Ge(ax, ay), hn::Ge(ax, az));
        const auto axis =
            hn::IfThenElse(hn::RebindMask(du, is_x), hn::Zero(du),
                           hn::IfThenElse(hn::RebindMask(du, hn::Ge(ay, az)), hn::Set(du, 1), hn::Set(du, 2)));
        const auto kind = hn::Add(hn::Add(octant, hn::ShiftLeft<1>(octant)), axis);
        hn::Store(hn::IfThenElse(hn::RebindMask(du, ok), kind, hn::Set(du, no_kind)), du, kinds + i);
    });
}

HWY_INLINE bool is_all_one(const Packet& p, const uint (&kinds)[packet_size])
{
    const hn::RebindToUnsigned<Packet::Tag> du;
    bool same = true;
    const auto first = hn::Set(du, kinds[0]);
    for_parts(p, [&](uint i) HWY_ATTR { same = hn::AllTrue(du, hn::Eq(hn::Load(du, kinds + i), first)) && same; });
    return same;
}

// What lanes have found before they begin: t is their t_max.
HWY_INLINE void set_missed(Packet& p)
{
    const Packet::Tag d;
    const hn::RebindToUnsigned<Packet::Tag> du;
    const hn::RebindToSigned<Packet::Tag> di;
    for_parts(p, [&](uint i) HWY_ATTR {
        const auto t = hn::Load(d, p.t + i);
        const auto bits = hn::BitCast(di, t);
        const auto zero = hn::Zero(d);
        const auto below_zero = hn::IfThenElse(hn::Lt(t, zero), hn::BitCast(d, hn::Add(bits, hn::Set(di, 1))),
                                               hn::BitCast(d, hn::Set(du, 0x80000001u)));
        // float_before()
        const auto before = hn::IfThenElse(hn::Gt(t, zero), hn::BitCast(d, hn::Sub(bits, hn::Set(di, 1))), below_zero);
        hn::Store(hn::IfThenElse(hn::FirstN(d, p.count - i), before, hn::Set(d, -INFINITY)), d, p.best + i);
        hn::Store(zero, d, p.u + i);
        hn::Store(zero, d, p.v + i);
        hn::Store(hn::Set(du, none), du, p.primitive + i);
        hn::Store(hn::Set(du, none), du, p.instance + i);
    });
}

// The same as enter_space() for the rays that are in the packet, in world space.
HWY_INLINE PacketBounds enter_world(Packet& p, const Box& box)
{
    const Packet::Tag d;
    alignas(64) float enter_from[3][packet_size], leave_from[3][packet_size];
    for_parts(p, [&](uint i) HWY_ATTR {
        auto reach = hn::Zero(d), coordinate = hn::Zero(d);
        for (int axis = 0; axis < 3; ++axis) {
            const auto origin = hn::Load(d, p.origin[axis] + i);
            const auto lower = hn::Set(d, box.lower[axis]), upper = hn::Set(d, box.upper[axis]);
            reach = hn::Max(reach, hn::Max(hn::Abs(hn::Sub(lower, origin)), hn::Abs(hn::Sub(upper, origin))));
            coordinate = hn::Max(coordinate, hn::Max(hn::Abs(origin), hn::Max(hn::Abs(lower), hn::Abs(upper))));
        }
        const auto limit = hn::Div(hn::Set(d, 1e36f), hn::Add(coordinate, hn::Set(d, 1e-2f)));
        const auto far_slack = hn::Add(hn::Mul(reach, hn::Set(d, slack_by_reach)), hn::Set(d, 1e-30f));
        for (int axis = 0; axis < 3; ++axis) {
            const auto origin = hn::Load(d, p.origin[axis] + i);
            const auto reciprocal = hn::Div(hn::Set(d, 1.0f), hn::Load(d, p.direction[axis] + i));
            const auto slack = hn::Add(hn::Mul(hn::Abs(origin), hn::Set(d, slack_by_origin)), far_slack);
            const auto along = hn::CopySign(slack, reciprocal);
            const auto inverse = hn::Max(hn::Min(reciprocal, limit), hn::Neg(limit));
            hn::Store(inverse, d, p.inverse[axis] + i);
            hn::Store(hn::Mul(hn::Add(origin, along), inverse), d, p.enter[axis] + i);
            hn::Store(hn::Mul(hn::Sub(origin, along), inverse), d, p.leave[axis] + i);
            hn::Store(hn::Add(origin, hn::Add(along, along)), d, enter_from[axis] + i);
            hn::Store(hn::Sub(origin, hn::Add(along, along)), d, leave_from[axis] + i);
        }
        const auto z = hn::Load(d, p.direction[p.kz] + i);
        hn::Store(hn::Div(hn::Load(d, p.direction[p.kx] + i), z), d, p.shear[0] + i);
        hn::Store(hn::Div(hn::Load(d, p.direction[p.ky] + i), z), d, p.shear[1] + i);
        hn::Store(hn::Div(hn::Set(d, 1.0f), z), d, p.shear[2] + i);
    });
    PacketBounds b;
    b.t_min = least_of(p, p.t_min);
    for (int axis = 0; axis < 3; ++axis) {
        const bool negative = (p.octant >> axis & 1u) != 0;
        b.row[axis] = 2 * static_cast<uint>(axis) + negative;
        b.enter_from[axis] = negative ? least_of(p, enter_from[axis]) : most_of(p, enter_from[axis]);
        b.leave_from[axis] = negative ? most_of(p, leave_from[axis]) : least_of(p, leave_from[axis]);
        b.least[axis] = least_of(p, p.inverse[axis]);
        b.most[axis] = most_of(p, p.inverse[axis]);
    }
    return b;
}

// The same bounds in every lane.
template <class D>
struct BoundVectors
{
    using Vec = hn::Vec<D>;
    HWY_INLINE BoundVectors(D d, const PacketBounds& b, float best)
        : enter_from{hn::Set(d, b.enter_from[0]), hn::Set(d, b.enter_from[1]), hn::Set(d, b.enter_from[2])},
          leave_from{hn::Set(d, b.leave_from[0]), hn::Set(d, b.leave_from[1]), hn::Set(d, b.leave_from[2])},
          least{hn::Set(d, b.least[0]), hn::Set(d, b.least[1]), hn::Set(d, b.least[2])}, most{hn::Set(d, b.most[0]),
                                                                                              hn::Set(d, b.most[1]),
                                                                                              hn::Set(d, b.most[2])},
          t_min(hn::Set(d, b.t_min)), farthest(hn::Set(d, best))
    {
    }

    // Where the first ray may enter and the last may leave a box, which is entered and left through these planes.
    HWY_INLINE void clip(int axis, Vec near, Vec far, Vec& enter, Vec& leave) const
    {
        const auto x = hn::Sub(near, enter_from[axis]), y = hn::Sub(far, leave_from[axis]);
        enter = hn::Max(enter, hn::Min(hn::Mul(x, least[axis]), hn::Mul(x, most[axis])));
        leave = hn::Min(leave, hn::Max(hn::Mul(y, least[axis]), hn::Mul(y, most[axis])));
    }

    const Vec enter_from[3], leave_from[3], least[3], most[3], t_min, farthest;
};

// Children, as bits from far to near in the node's order, that some ray of the packet may meet; and, by child, where
// the first may enter.
template <class Node>
HWY_INLINE uint children_in_bounds(const Node& node, uint order, const PacketBounds& b, float best,
                                   float (&enters)[Node::width])
{
    const NodeTag<Node> d;
    constexpr std::size_t n = hn::MaxLanes(d);
    const BoundVectors bounds(d, b, best);
    uint bits = 0;
    for (std::size_t first = 0; first < Node::width; first += n) {
        auto enter = bounds.t_min, leave = bounds.farthest;
        for (int axis = 0; axis < 3; ++axis)
            bounds.clip(axis, load_planes(d, node, Node::row_bytes * b.row[axis], first),
                        load_planes(d, node, Node::row_bytes * (b.row[axis] ^ 1u), first), enter, leave);
        hn::Store(enter, d, enters + first);
        const auto met = hn::Le(enter, leave);
        if constexpr (n == Node::width) {
            const hn::RebindToUnsigned<NodeTag<Node>> du;
            const auto front_to_back = hn::Shr(hn::Set(du, order), order_shifts<Node>());
            const auto sorted = hn::TableLookupLanes(hn::VecFromMask(d, met), lanes_of(d, front_to_back));
            return mask_bits(d, hn::MaskFromVec(sorted));
        }
        const uint part = mask_bits(d, met) << first;
        for (uint i = 0; i < Node::width; ++i)
            bits |= (part >> (order >> (Node::order_bits * i) & (Node::width - 1)) & 1u) << i;
    }
    return bits;
}

// One plane of a child, the same number as load_planes() gives.
template <uint width>
HWY_INLINE float plane_of(const FloatNode<width>& node, uint row, uint child)
{
    return node.planes[row][child];
}
HWY_INLINE float plane_of(const QuantisedNode& node, uint row, uint child)
{
    return (&node.origin.x)[row / 2] + (&node.scale.x)[row / 2] * static_cast<float>(node.planes[row][child]);
}

// Those of `lanes` whose ray meets the box of a child.
template <class Node>
HWY_INLINE Lanes lanes_in_box(const Packet& p, const PacketBounds& bounds, const Node& node, uint child, Lanes lanes)
{
    const Packet::Tag d;
    hn::Vec<Packet::Tag> near[3], far[3];
    for (int axis = 0; axis < 3; ++axis) {
        near[axis] = hn::Set(d, plane_of(node, bounds.row[axis], child));
        far[axis] = hn::Set(d, plane_of(node, bounds.row[axis] ^ 1u, child));
    }
    Lanes met = 0;
    for_parts_of(lanes, [&](uint i) HWY_ATTR {
        auto enter = hn::Load(d, p.t_min + i), leave = hn::Load(d, p.best + i);
        for (int axis = 0; axis < 3; ++axis) {
            const auto inverse = hn::Load(d, p.inverse[axis] + i);
            enter = hn::Max(enter, hn::MulSub(near[axis], inverse, hn::Load(d, p.enter[axis] + i)));
            leave = hn::Min(leave, hn::MulSub(far[axis], inverse, hn::Load(d, p.leave[axis] + i)));
        }
        met |= packet_lanes(i, hn::Le(enter, leave));
    });
    return met & lanes;
}

} // namespace HWY_NAMESPACE
} // namespace snell
HWY_AFTER_NAMESPACE();

#endif
