// The rays of a packet side by side, and what they have in common. Compiled once for each instruction set.
#if defined(SNELL_BVH_SIMD_PACKET_RAYS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SNELL_BVH_SIMD_PACKET_RAYS_INL_H
#undef SNELL_BVH_SIMD_PACKET_RAYS_INL_H
#else
#define SNELL_BVH_SIMD_PACKET_RAYS_INL_H
#endif

#include "snell/bvh/simd/nodes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace snell {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr uint packet_size = 16;

// Rays side by side. Lanes without a ray, and those that have found what they looked for, have best = -infinity: no
// box and no triangle is as near as that.
struct alignas(64) Packet
{
    using Tag = hn::CappedTag<float, packet_size>;

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
// slab test with these, on the eight children of a node at once, leaves out most of those that no ray meets.
// Distances are taken as (plane - origin) * inverse here: as a difference of two products they would be as uncertain
// as the slopes times the distance from the world's origin. The roundings are then those of the difference, the
// product and the reciprocal, 3 u reach in the terms of RayState, and 2 u |origin|; the slack is twice that of single
// rays.
template <class Node>
struct PacketBounds
{
    using Tag = NodeTag<Node>;
    using Vec = hn::Vec<Tag>;
    Vec enter_from[3], leave_from[3]; // the origins, moved back or forth, that enter first and leave last
    Vec least[3], most[3];            // of inverse
    Vec t_min;
    uint row[3]; // of planes where the rays enter
};

template <class Part>
HWY_INLINE void for_parts(const Part& part)
{
    constexpr uint n = hn::MaxLanes(Packet::Tag());
    for (uint i = 0; i < packet_size; i += n) part(i);
}

// Bits of 16 lanes from masks that arrive in parts.
HWY_INLINE uint packet_bits(uint first, hn::Mask<Packet::Tag> mask)
{
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(Packet::Tag(), mask, bits);
    return (bits[0] | static_cast<uint>(bits[1]) << 8) << first;
}

HWY_INLINE float least_of(const float (&x)[packet_size])
{
    const Packet::Tag d;
    auto r = hn::Load(d, x);
    for_parts([&](uint i) HWY_ATTR { r = hn::Min(r, hn::Load(d, x + i)); });
    return hn::GetLane(hn::MinOfLanes(d, r));
}

HWY_INLINE float most_of(const float (&x)[packet_size])
{
    const Packet::Tag d;
    auto r = hn::Load(d, x);
    for_parts([&](uint i) HWY_ATTR { r = hn::Max(r, hn::Load(d, x + i)); });
    return hn::GetLane(hn::MaxOfLanes(d, r));
}

// The same as enter_space() for the rays that are in the packet, in world space.
template <class Node>
HWY_INLINE PacketBounds<Node> enter_world(Packet& p, const Box& box)
{
    const Packet::Tag d;
    alignas(64) float enter_from[3][packet_size], leave_from[3][packet_size];
    for_parts([&](uint i) HWY_ATTR {
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
    const NodeTag<Node> dn;
    PacketBounds<Node> b;
    b.t_min = hn::Set(dn, least_of(p.t_min));
    for (int axis = 0; axis < 3; ++axis) {
        const bool negative = (p.octant >> axis & 1u) != 0;
        b.row[axis] = 2 * static_cast<uint>(axis) + negative;
        b.enter_from[axis] = hn::Set(dn, negative ? least_of(enter_from[axis]) : most_of(enter_from[axis]));
        b.leave_from[axis] = hn::Set(dn, negative ? most_of(leave_from[axis]) : least_of(leave_from[axis]));
        b.least[axis] = hn::Set(dn, least_of(p.inverse[axis]));
        b.most[axis] = hn::Set(dn, most_of(p.inverse[axis]));
    }
    return b;
}

// Children, as bits from far to near in the node's order, that some ray of the packet may meet.
template <class Node>
HWY_INLINE uint children_in_bounds(const Node& node, uint order, const PacketBounds<Node>& b, float best)
{
    const NodeTag<Node> d;
    constexpr std::size_t n = hn::MaxLanes(d);
    uint bits = 0;
    for (std::size_t first = 0; first < Node::width; first += n) {
        auto enter = b.t_min, leave = hn::Set(d, best);
        for (int axis = 0; axis < 3; ++axis) {
            const auto x = hn::Sub(load_planes(d, node, b.row[axis], first), b.enter_from[axis]);
            const auto y = hn::Sub(load_planes(d, node, b.row[axis] ^ 1u, first), b.leave_from[axis]);
            enter = hn::Max(enter, hn::Min(hn::Mul(x, b.least[axis]), hn::Mul(x, b.most[axis])));
            leave = hn::Min(leave, hn::Max(hn::Mul(y, b.least[axis]), hn::Mul(y, b.most[axis])));
        }
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

} // namespace HWY_NAMESPACE
} // namespace snell
HWY_AFTER_NAMESPACE();

#endif
