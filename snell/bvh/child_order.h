// The order in which rays visit the children of a wide node, for all eight octants at once.
#pragma once

#include "snell/bvh/node.h"

#include <hwy/highway.h>

namespace snell {

// Fills node.orders from the boxes: children by their centre along the diagonal of the octant, unused ones as the
// farthest. Centres that agree but for the last three bits count as equal and come in the order of the slots, or the
// other way round.
inline void order_children(Node8& node)
{
    namespace hn = hwy::HWY_NAMESPACE;
    const hn::FixedTag<float, 4> d;
    const hn::RebindToUnsigned<decltype(d)> du;
    using Keys = hn::Vec<decltype(d)>;

    // Octants 0 to 3 and 4 to 7: lanes of the same sign of x, y and z.
    alignas(16) static constexpr uint sign_x[4] = {0, 1u << 31, 0, 1u << 31}, sign_y[4] = {0, 0, 1u << 31, 1u << 31};
    const auto flip_x = hn::BitCast(d, hn::Load(du, sign_x));
    const auto flip_y = hn::BitCast(d, hn::Load(du, sign_y));

    alignas(16) float center[3][Node8::width];
    for (uint axis = 0; axis < 3; ++axis)
        for (uint half = 0; half < Node8::width; half += 4) {
            const auto lower = hn::Load(d, node.planes[2 * axis] + half),
                       upper = hn::Load(d, node.planes[2 * axis + 1] + half);
            hn::Store(hn::Mul(hn::Set(d, 0.5f), lower) + hn::Mul(hn::Set(d, 0.5f), upper), d, center[axis] + half);
        }

    // Keys carry their slots in the last bits, and are no infinities, which would be NaN then.
    Keys near[Node8::width], far[Node8::width];
    const Keys largest = hn::Set(d, std::numeric_limits<float>::max());
    const auto with_slot = [&](Keys key, uint slot) {
        const Keys finite = hn::Max(hn::Min(key, largest), hn::Neg(largest));
        return hn::BitCast(d, hn::Or(hn::And(hn::BitCast(du, finite), hn::Set(du, ~7u)), hn::Set(du, 7u - slot)));
    };
    for (uint slot = 0; slot < Node8::width; ++slot) {
        if (!(node.planes[0][slot] <= node.planes[1][slot])) { // unused: the farthest
            near[slot] = far[slot] = with_slot(largest, slot);
            continue;
        }
        const auto x = hn::Xor(hn::Set(d, center[0][slot]), flip_x), y = hn::Xor(hn::Set(d, center[1][slot]), flip_y);
        const auto z = hn::Set(d, center[2][slot]), xy = hn::Add(x, y);
        near[slot] = with_slot(hn::Add(xy, z), slot);
        far[slot] = with_slot(hn::Sub(xy, z), slot);
    }

    // Batcher's odd-even merge sort for eight (Knuth, volume 3, 5.3.4): the largest key first.
    for (Keys* keys : {near, far}) {
        const auto sort = [keys](uint a, uint b) {
            const Keys large = hn::Max(keys[a], keys[b]);
            keys[b] = hn::Min(keys[a], keys[b]);
            keys[a] = large;
        };
        sort(0, 1), sort(2, 3), sort(4, 5), sort(6, 7);
        sort(0, 2), sort(1, 3), sort(4, 6), sort(5, 7);
        sort(1, 2), sort(5, 6);
        sort(0, 4), sort(1, 5), sort(2, 6), sort(3, 7);
        sort(2, 4), sort(3, 5);
        sort(1, 2), sort(3, 4), sort(5, 6);
        auto order = hn::Zero(du);
        const auto seven = hn::Set(du, 7u);
        for (uint i = 0; i < Node8::width; ++i)
            order =
                hn::Or(order, hn::ShiftLeftSame(hn::AndNot(hn::BitCast(du, keys[i]), seven), static_cast<int>(3 * i)));
        hn::StoreU(order, du, node.orders + (keys == near ? 0 : 4));
    }
}

} // namespace snell
