#include "snell/bvh/node.h"

#include "snell/bvh/child_order.h"
#include "snell/kernel/wide_boxes.h"

#include <bit>
#include <cstring>

namespace snell {

static ChildBoxes to_kernel(const Box* boxes, uint width)
{
    ChildBoxes children;
    for (uint i = 0; i < width; ++i) children.at[i] = {boxes[i].lower, boxes[i].upper};
    return children;
}

std::array<uint, 8> order_children(const Box* boxes, uint width)
{
    std::array<uint, 8> orders;
    const ChildBoxes children = to_kernel(boxes, width);
    for (uint octant = 0; octant < 8; ++octant) orders[octant] = order_child_boxes(children, width, octant);
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

void QuantisedNode::set_boxes(const Box (&boxes)[8])
{
    const QuantisedBoxes q = quantise_boxes(to_kernel(boxes, 8));
    origin = q.origin;
    scale = q.scale;
    static_assert(std::endian::native == std::endian::little);
    std::memcpy(planes, q.planes, sizeof(planes));
    const std::array<uint, 8> all_orders = order_children(boxes, 8);
    for (uint octant = 0; octant < 8; ++octant)
        for (uint byte = 0; byte < 3; ++byte)
            orders[octant][byte] = static_cast<std::uint8_t>(all_orders[octant] >> (8 * byte));
}

} // namespace snell
