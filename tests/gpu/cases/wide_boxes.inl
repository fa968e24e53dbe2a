// The children of wide nodes.
#ifndef TWIN_CASES
#include "tests/gpu/draw_boxes.h"
#else

TWIN(order_child_boxes, 0.0f, 0.0f, 0.0f)
{
    uint octant = index_below(8u);
    uint size = index_below(3u);
    uint width = 2u << size;
    ChildBoxes boxes = draw_child_boxes(width);
    give(child_order_bits(width));
    give(order_child_boxes(boxes, width, octant));
}
TWIN(planes, 0.0f, 0.0f, 0.0f)
{
    float lower = range(-100.0f, 100.0f);
    float extent = magnitude(1e-6f, 1e6f);
    float part = unit();
    float upper = lower + extent;
    float x = min(lower + part * extent, upper);
    float scale = plane_scale(lower, upper);
    give(scale);
    give(plane_below(x, lower, scale));
    give(plane_above(x, lower, scale));
    give(compare_plane(lower, 3.0f * scale, x));
    give(compare_plane(lower, 0.0f, lower));
}
TWIN(quantise_boxes, 0.0f, 0.0f, 0.0f)
{
    uint octant = index_below(8u);
    ChildBoxes boxes = draw_child_boxes(octant + 1u);
    QuantisedBoxes q = quantise_boxes(boxes);
    give(q.origin);
    give(q.scale);
    give(q.planes[octant]);
    give(q.planes[11u - octant]);
}

#endif
