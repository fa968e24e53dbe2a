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

template <class Node>
HWY_INLINE void set_tree(RayState<Node>& s, const Ray& ray, const WideTree<Node>& tree)
{
    s.parts[0] = reinterpret_cast<const std::byte*>(tree.lines.data());
    s.parts[1] = reinterpret_cast<const std::byte*>(tree.nodes.data());
    s.tree = &tree;
    s.ray = ray;
}

// Prepares for a tree in the space of `ray`, which is traceable; the tree is not empty.
template <class Node>
HWY_INLINE void enter_space(RayState<Node>& s, const Ray& ray, const WideTree<Node>& tree, uint instance)
{
    const hn::FixedTag<float, 4> d; // x, y, z, and a lane of no meaning
    const auto origin = hn::LoadU(d, &ray.origin.x);
    const auto direction = hn::LoadU(d, &ray.direction.x);
    const auto reciprocal = hn::Div(hn::Set(d, 1.0f), direction);
    const auto lower = hn::LoadU(d, &tree.box.lower.x), upper = hn::LoadU(d, &tree.box.upper.x - 1);
    const auto upper_xyz = hn::Shuffle0321(upper); // what lies behind the box is not ours to read
    const auto distance = hn::Max(hn::Abs(hn::Sub(lower, origin)), hn::Abs(hn::Sub(upper_xyz, origin)));
    const auto coordinate = hn::Max(hn::Abs(origin), hn::Max(hn::Abs(lower), hn::Abs(upper_xyz)));
    alignas(16) float distances[4], coordinates[4];
    hn::Store(distance, d, distances);
    hn::Store(coordinate, d, coordinates);
    const float reach = max(max(distances[0], distances[1]), distances[2]);
    const float limit = 1e36f / (max(max(coordinates[0], coordinates[1]), coordinates[2]) + 1e-2f);

    const auto relative = hn::Mul(hn::Abs(origin), hn::Set(d, slack_by_origin));
    const auto slack = hn::Add(relative, hn::Set(d, reach * slack_by_reach + 1e-30f));
    const auto along = hn::CopySign(slack, reciprocal);
    const auto inverse = hn::Max(hn::Min(reciprocal, hn::Set(d, limit)), hn::Set(d, -limit));
    // Each store overwrites the lane of no meaning that the one before it left.
    hn::StoreU(inverse, d, s.inverse);
    hn::StoreU(hn::Mul(hn::Add(origin, along), inverse), d, s.enter_term);
    hn::StoreU(hn::Mul(hn::Sub(origin, along), inverse), d, s.leave_term);
    s.t_min = ray.t_min;
    const uint octant = mask_bits(d, hn::Lt(reciprocal, hn::Zero(d))) & 7u;
    s.octant = octant;
    for (uint axis = 0; axis < 3; ++axis) s.enter_row[axis] = Node::row_bytes * (2 * axis + (octant >> axis & 1u));
    s.instance = instance;
    set_tree(s, ray, tree);

    // shear_ray(), from arrays: vec3's operator[] branches.
    alignas(16) float o[4], r[4], v[4];
    hn::Store(origin, d, o);
    hn::Store(reciprocal, d, r);
    hn::Store(direction, d, v);
    const int kz = longest_axis(ray.direction);
    const int kx = next_axis[kz], ky = next_axis[kx];
    s.shear_axes[0] = static_cast<std::uint8_t>(kx);
    s.shear_axes[1] = static_cast<std::uint8_t>(ky);
    s.shear_axes[2] = static_cast<std::uint8_t>(kz);
    s.shear[0] = v[kx] / v[kz];
    s.shear[1] = v[ky] / v[kz];
    s.shear[2] = r[kz];
    s.shear_origin[0] = o[kx];
    s.shear_origin[1] = o[ky];
    s.shear_origin[2] = o[kz];
}

template <class Node>
HWY_INLINE ShearedRay shear_of(const RayState<Node>& s)
{
    return {s.shear_axes[0], s.shear_axes[1], s.shear_axes[2], s.shear[0], s.shear[1], s.shear[2]};
}

// A vector for the children of a node, or for part of them where vectors are short.
template <class Node>
using NodeTag = hn::CappedTag<float, Node::width>;

// row: in bytes from the first plane; see RayState::enter_row.
template <uint width, class D>
HWY_INLINE hn::Vec<D> load_planes(D d, const FloatNode<width>& node, std::size_t row, std::size_t first)
{
    const auto* const bytes = reinterpret_cast<const std::byte*>(node.planes) + row;
    return hn::Load(d, reinterpret_cast<const float*>(bytes) + first);
}

template <class D>
HWY_INLINE hn::Vec<D> load_planes(D d, const QuantisedNode& node, std::size_t row, std::size_t first)
{
    const hn::Rebind<std::uint8_t, D> d8;
    const hn::RebindToSigned<D> di;
    const auto number = hn::ConvertTo(d, hn::PromoteTo(di, hn::LoadU(d8, &node.planes[0][0] + row + first)));
    const std::size_t axis = row / (2 * QuantisedNode::row_bytes);
    return hn::MulAdd(number, hn::Set(d, (&node.scale.x)[axis]), hn::Set(d, (&node.origin.x)[axis]));
}

// The part of the state that slab tests need, in registers.
template <class Node>
struct SlabRay
{
    using Vec = hn::Vec<NodeTag<Node>>;
    Vec inverse[3], enter[3], leave[3], t_min;
    std::size_t row[3];
};

template <class Node>
HWY_INLINE SlabRay<Node> load_slab_ray(const RayState<Node>& s)
{
    const NodeTag<Node> d;
    return {{hn::Set(d, s.inverse[0]), hn::Set(d, s.inverse[1]), hn::Set(d, s.inverse[2])},
            {hn::Set(d, s.enter_term[0]), hn::Set(d, s.enter_term[1]), hn::Set(d, s.enter_term[2])},
            {hn::Set(d, s.leave_term[0]), hn::Set(d, s.leave_term[1]), hn::Set(d, s.leave_term[2])},
            hn::Set(d, s.t_min),
            {s.enter_row[0], s.enter_row[1], s.enter_row[2]}};
}

// Where the ray enters and leaves the boxes of a node, or of part of it.
template <class Node>
struct Slabs
{
    hn::Vec<NodeTag<Node>> enter, leave;
};

template <class Node>
HWY_INLINE Slabs<Node> test_slabs(const Node& node, const SlabRay<Node>& r, float best, std::size_t first)
{
    const NodeTag<Node> d;
    const auto enter_x = hn::MulSub(load_planes(d, node, r.row[0], first), r.inverse[0], r.enter[0]);
    const auto enter_y = hn::MulSub(load_planes(d, node, r.row[1], first), r.inverse[1], r.enter[1]);
    const auto enter_z = hn::MulSub(load_planes(d, node, r.row[2], first), r.inverse[2], r.enter[2]);
    const auto leave_x = hn::MulSub(load_planes(d, node, r.row[0] ^ Node::row_bytes, first), r.inverse[0], r.leave[0]);
    const auto leave_y = hn::MulSub(load_planes(d, node, r.row[1] ^ Node::row_bytes, first), r.inverse[1], r.leave[1]);
    const auto leave_z = hn::MulSub(load_planes(d, node, r.row[2] ^ Node::row_bytes, first), r.inverse[2], r.leave[2]);
    return {hn::Max(hn::Max(enter_x, enter_y), hn::Max(enter_z, r.t_min)),
            hn::Min(hn::Min(leave_x, leave_y), hn::Min(leave_z, hn::Set(d, best)))};
}

// Lane numbers in the low bits, whatever is above.
template <class D, class V>
HWY_INLINE auto lanes_of(D d, V numbers)
{
#if HWY_TARGET <= HWY_AVX2
    if constexpr (hn::MaxLanes(d) == 8)
        return hn::Indices256<hn::TFromD<D>>{numbers.raw}; // it looks at those bits only
#endif
    const hn::RebindToUnsigned<D> du;
    return hn::IndicesFromVec(d, hn::And(numbers, hn::Set(du, hn::MaxLanes(d) - 1)));
}

// The order for any hit: slot after slot, see make_wide_tree().
template <class Node>
constexpr uint order_of_slots()
{
    uint order = 0;
    for (uint i = 0; i < Node::width; ++i) order |= i << (Node::order_bits * i);
    return order;
}

// Bits to shift a node's order by, for each lane.
template <class Node>
HWY_INLINE auto order_shifts()
{
    alignas(64) static constexpr uint shifts[8] = {0,
                                                   Node::order_bits,
                                                   2 * Node::order_bits,
                                                   3 * Node::order_bits,
                                                   4 * Node::order_bits,
                                                   5 * Node::order_bits,
                                                   6 * Node::order_bits,
                                                   7 * Node::order_bits};
    return hn::Load(hn::RebindToUnsigned<NodeTag<Node>>(), shifts);
}

// Pushes the children that the ray meets, the nearest last, from `words` on. Returns the new top of the stack.
template <Query query, class Node>
HWY_INLINE ChildWord* push_children(const Node& node, const RayState<Node>& s, const SlabRay<Node>& slab_ray,
                                    const Slabs<Node>& slabs, std::size_t stride, ChildWord* words)
{
    const NodeTag<Node> d;
    const hn::RebindToUnsigned<NodeTag<Node>> du;
    constexpr std::size_t n = hn::MaxLanes(d);
    uint* const distances = words + stride;
#if HWY_TARGET <= HWY_AVX3
    if constexpr (query == Query::any && n == Node::width) {
        const auto met = hn::RebindMask(du, hn::Le(slabs.enter, slabs.leave));
        hn::StoreU(hn::Compress(hn::LoadU(du, node.child), met), du, words);
        return words + hn::CountTrue(du, met);
    }
#endif
    const uint order = query == Query::any ? order_of_slots<Node>() : node.order(s.octant);
    if constexpr (n == Node::width) {
        const auto front_to_back = hn::Shr(hn::Set(du, order), order_shifts<Node>());
        const auto children = hn::LoadU(du, node.child); // not aligned in quantised nodes
#if HWY_TARGET <= HWY_AVX3
        const auto enter = hn::TableLookupLanes(slabs.enter, lanes_of(d, front_to_back));
        const auto leave = hn::TableLookupLanes(slabs.leave, lanes_of(d, front_to_back));
        const auto met = hn::RebindMask(du, hn::Le(enter, leave));
        const auto sorted = hn::TableLookupLanes(children, lanes_of(du, front_to_back));
        hn::StoreU(hn::Compress(sorted, met), du, words);
        if (query != Query::any) hn::StoreU(hn::Compress(hn::BitCast(du, enter), met), du, distances);
        return words + hn::CountTrue(du, met);
#else
        // Highway's Compress copies its table to the stack at each call when GCC 12 compiles it for AVX2.
        const auto met = hn::VecFromMask(d, hn::Le(slabs.enter, slabs.leave));
        const uint bits = mask_bits(d, hn::MaskFromVec(hn::TableLookupLanes(met, lanes_of(d, front_to_back))));
        const auto kept = hn::Shr(hn::Set(du, lane_lists.lanes[bits]), hn::ShiftLeft<2>(hn::Iota(du, 0)));
        const auto lanes = hn::TableLookupLanes(front_to_back, lanes_of(du, kept));
        hn::StoreU(hn::TableLookupLanes(children, lanes_of(du, lanes)), du, words);
        if (query != Query::any)
            hn::StoreU(hn::TableLookupLanes(hn::BitCast(du, slabs.enter), lanes_of(du, lanes)), du, distances);
        return words + hwy::PopCount(bits);
#endif
    } else {
        alignas(16) uint t[Node::width];
        uint met = 0;
        Slabs<Node> part = slabs;
        for (std::size_t first = 0;; part = test_slabs(node, slab_ray, s.best, first)) {
            hn::Store(hn::BitCast(du, part.enter), du, t + first);
            met |= mask_bits(d, hn::Le(part.enter, part.leave)) << first;
            first += n;
            if (first >= Node::width) break;
        }
        uint count = 0;
        for (uint i = 0; i < Node::width; ++i) {
            const uint lane = order >> (Node::order_bits * i) & (Node::width - 1);
            words[count] = node.child[lane];
            distances[count] = t[lane];
            count += met >> lane & 1u;
        }
        return words + count;
    }
}

// Stores the lanes in `set` of both vectors side by side and returns how many they are.
template <class DU>
HWY_INLINE uint store_lanes(DU du, uint set, hn::Vec<DU> a, uint* to_a, hn::Vec<DU> b, uint* to_b)
{
    const auto lanes = hn::Shr(hn::Set(du, lane_lists.lanes[set]), hn::ShiftLeft<2>(hn::Iota(du, 0)));
    hn::StoreU(hn::TableLookupLanes(a, lanes_of(du, lanes)), du, to_a);
    hn::StoreU(hn::TableLookupLanes(b, lanes_of(du, lanes)), du, to_b);
    return static_cast<uint>(hwy::PopCount(set));
}

// Takes what lies beyond the nearest hit off the stack, so that popping needs no comparison.
template <class Node>
HWY_INLINE void drop_farther(RayState<Node>& s, std::size_t stride)
{
    uint* const words = s.stack;
    uint* const distances = s.stack + stride;
    const auto size = static_cast<uint>(s.top - s.stack);
    uint kept = 0;
#if HWY_TARGET <= HWY_AVX3
    // Most stacks are one vector long: no branch that depends on the ray.
    const hn::FixedTag<float, 16> d;
    const hn::RebindToUnsigned<decltype(d)> du;
    uint i = 0;
    do {
        const auto distance = hn::LoadU(du, distances + i);
        const auto near = hn::And(hn::FirstN(d, size - i), hn::Le(hn::BitCast(d, distance), hn::Set(d, s.best)));
        const auto keep = hn::RebindMask(du, near);
        hn::StoreU(hn::Compress(hn::LoadU(du, words + i), keep), du, words + kept);
        hn::StoreU(hn::Compress(distance, keep), du, distances + kept);
        kept += static_cast<uint>(hn::CountTrue(du, keep));
        i += 16;
    } while (HWY_UNLIKELY(i < size));
#else
    const hn::CappedTag<float, 8> d;
    const hn::RebindToUnsigned<decltype(d)> du;
    constexpr uint n = hn::MaxLanes(d);
    for (uint i = 0; i < size; i += n) {
        const auto distance = hn::LoadU(du, distances + i);
        const uint all = size - i < n ? (1u << (size - i)) - 1 : (1u << n) - 1;
        const uint near = all & mask_bits(d, hn::Le(hn::BitCast(d, distance), hn::Set(d, s.best)));
        kept += store_lanes(du, near, hn::LoadU(du, words + i), words + kept, distance, distances + kept);
    }
#endif
    s.top = s.stack + kept;
}

} // namespace HWY_NAMESPACE
} // namespace snell
HWY_AFTER_NAMESPACE();

#endif
