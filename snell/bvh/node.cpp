#include "snell/bvh/node.h"

#include "snell/bvh/child_order.h"

#include <algorithm>
#include <cmath>

namespace snell {

std::array<uint, 8> order_children(const Box* boxes, uint width)
{
    std::array<uint, 8> orders = {};
    const uint bits = width == 8 ? 3 : width == 4 ? 2 : 1;
    for (uint octant = 0; octant < 8; ++octant) {
        float key[8];
        std::uint8_t slots[8];
        for (uint i = 0; i < width; ++i) {
            key[i] = std::numeric_limits<float>::infinity();
            if (!boxes[i].empty()) {
                key[i] = 0.0f;
                for (int axis = 0; axis < 3; ++axis) {
                    const float center = 0.5f * boxes[i].lower[axis] + 0.5f * boxes[i].upper[axis];
                    key[i] += (octant >> axis & 1u) ? -center : center;
                }
            }
            // Insertion sort, stable: farthest first.
            uint at = i;
            for (; at > 0 && key[slots[at - 1]] < key[i]; --at) slots[at] = slots[at - 1];
            slots[at] = static_cast<std::uint8_t>(i);
        }
        for (uint i = 0; i < width; ++i) orders[octant] |= static_cast<uint>(slots[i]) << (bits * i);
    }
    return orders;
}

template <uint width_>
void FloatNode<width_>::set_boxes(const Box (&boxes)[width_])
{
    for (uint i = 0; i < width_; ++i)
        for (int axis = 0; axis < 3; ++axis) {
            planes[2 * axis][i] = boxes[i].lower[axis];
            planes[2 * axis + 1][i] = boxes[i].upper[axis];
        }
    if constexpr (width_ == 8) {
        order_children(*this);
    } else {
        const std::array<uint, 8> all = order_children(boxes, width_);
        for (uint octant = 0; octant < 8; ++octant) orders[octant] = static_cast<Order>(all[octant]);
    }
}
template struct FloatNode<2>;
template struct FloatNode<4>;
template struct FloatNode<8>;

// The largest number that origin + scale * number does not take beyond x: exact, for doubles hold such sums of floats
// unless their exponents are far apart, and then the last step looks at the rounded sum.
static std::uint8_t number_below(float x, float origin, float scale)
{
    double q = std::floor((double(x) - origin) / scale);
    q = std::clamp(q, 0.0, 255.0);
    while (q > 0.0 && double(origin) + q * scale > x) --q;
    return static_cast<std::uint8_t>(q);
}
static std::uint8_t number_above(float x, float origin, float scale)
{
    double q = std::ceil((double(x) - origin) / scale);
    q = std::clamp(q, 0.0, 255.0);
    while (q < 255.0 && double(origin) + q * scale < x) ++q;
    return static_cast<std::uint8_t>(q);
}

void QuantisedNode::set_boxes(const Box (&boxes)[8])
{
    Box all;
    for (const Box& box : boxes)
        if (!box.empty()) all.extend(box);
    if (all.empty()) all = {vec3(0.0f), vec3(0.0f)};
    origin = all.lower;
    for (int axis = 0; axis < 3; ++axis) {
        const double extent = double(all.upper[axis]) - all.lower[axis];
        int exponent = -126;
        if (extent > 0.0) exponent = std::max(std::ilogb(extent / 255.0), -126);
        while (exponent < 127 && double(all.lower[axis]) + 255.0 * std::ldexp(1.0, exponent) < all.upper[axis])
            ++exponent;
        scale[axis] = std::ldexp(1.0f, exponent);
    }
    for (uint i = 0; i < 8; ++i)
        for (int axis = 0; axis < 3; ++axis) {
            const bool none_there = boxes[i].empty();
            planes[2 * axis][i] = none_there ? 255 : number_below(boxes[i].lower[axis], origin[axis], scale[axis]);
            planes[2 * axis + 1][i] = none_there ? 0 : number_above(boxes[i].upper[axis], origin[axis], scale[axis]);
        }
    const std::array<uint, 8> all_orders = order_children(boxes, 8);
    for (uint octant = 0; octant < 8; ++octant)
        for (uint byte = 0; byte < 3; ++byte)
            orders[octant][byte] = static_cast<std::uint8_t>(all_orders[octant] >> (8 * byte));
}

} // namespace snell
