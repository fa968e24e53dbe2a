// The children of a wide node: in which order rays visit them, and their boxes in 8 bits a plane.
#ifndef SNELL_KERNEL_WIDE_BOXES_H
#define SNELL_KERNEL_WIDE_BOXES_H
#include "snell/kernel/bounds.h"
SNELL_BEGIN

struct ChildBoxes
{
    Aabb at[8]; // by slot; empty: no child
};

// Bits that the number of a slot takes.
SNELL_FN uint child_order_bits(uint width)
{
    return width == 8u ? 3u : (width == 4u ? 2u : 1u);
}

// The slots from far to near, for rays of an octant (bit i: the direction is negative on axis i), as numbers of
// child_order_bits(), the farthest lowest: by the boxes' centres along the octant's diagonal, equal ones as the slots
// come. Slots without a child count as farthest. width: 2, 4 or 8.
SNELL_FN_COLD uint order_child_boxes(SNELL_IN(ChildBoxes) boxes, uint width, uint octant)
{
    float key[8];
    uint slots[8];
    for (uint i = 0u; i < width; ++i) {
        Aabb box = boxes.at[i];
        float here = infinity();
        if (!is_empty(box)) {
            vec3 center = 0.5f * box.lower + 0.5f * box.upper;
            here = 0.0f + ((octant & 1u) != 0u ? -center.x : center.x);
            here = here + ((octant & 2u) != 0u ? -center.y : center.y);
            here = here + ((octant & 4u) != 0u ? -center.z : center.z);
        }
        key[i] = here;
        // Insertion sort, stable.
        uint place = i;
        for (; place > 0u; --place) {
            if (!(key[slots[place - 1u]] < here)) break;
            slots[place] = slots[place - 1u];
        }
        slots[place] = i;
    }
    uint order = 0u;
    for (uint i = 0u; i < width; ++i) order = order | slots[i] << (child_order_bits(width) * i);
    return order;
}

// ---- planes of 8 bits: a plane is origin + scale * number, and the scale a power of two ----

// The sign of (origin + step) - x, without rounding (Knuth, volume 2, 4.2.2: the error of a sum is a float). Overflow
// counts as what it overflows to.
SNELL_FN int compare_plane(float origin, float step, float x)
{
    SNELL_PRECISE float sum = origin + step;
    SNELL_PRECISE float part = sum - origin;
    SNELL_PRECISE float rest = sum - part;
    SNELL_PRECISE float error = (origin - rest) + (step - part);
    if (sum < x) return -1;
    if (sum > x) return 1;
    return error < 0.0f ? -1 : (error > 0.0f ? 1 : 0);
}

// The finest scale, not below 2^-126, for which number 255 reaches from `lower` to `upper`, both finite and in order.
SNELL_FN float plane_scale(float lower, float upper)
{
    float extent = upper - lower;
    // A power of two that is too small, and then a few steps.
    float guess = is_finite(extent) ? extent * 0.00390625f : upper * 0.00390625f - lower * 0.00390625f;
    uint exponent = max(floatBitsToUint(guess) >> 23u & 255u, 3u) - 2u;
    float scale = uintBitsToFloat(exponent << 23u);
    for (int step = 0; step < 8; ++step) {
        if (compare_plane(lower, 255.0f * scale, upper) >= 0) break;
        scale = scale * 2.0f;
    }
    return scale;
}

// The largest number whose plane does not lie beyond x, and the smallest whose plane does not lie before it; 0 and 255
// where x is outside.
SNELL_FN uint plane_below(float x, float origin, float scale)
{
    uint number = uint(clamp((x - origin) / scale, 0.0f, 255.0f));
    for (int step = 0; step < 256; ++step) {
        if (number == 0u || compare_plane(origin, float(number) * scale, x) <= 0) break;
        number = number - 1u;
    }
    for (int step = 0; step < 256; ++step) {
        if (number == 255u || compare_plane(origin, float(number + 1u) * scale, x) > 0) break;
        number = number + 1u;
    }
    return number;
}
SNELL_FN uint plane_above(float x, float origin, float scale)
{
    uint number = uint(clamp((x - origin) / scale, 0.0f, 255.0f));
    for (int step = 0; step < 256; ++step) {
        if (number == 255u || compare_plane(origin, float(number) * scale, x) >= 0) break;
        number = number + 1u;
    }
    for (int step = 0; step < 256; ++step) {
        if (number == 0u || compare_plane(origin, float(number - 1u) * scale, x) < 0) break;
        number = number - 1u;
    }
    return number;
}

// Boxes on the grid of their node, rounded outwards. Byte i of words 4 * axis and 4 * axis + 1 is the lower plane of
// slot i, of the two words behind them the upper one; a slot without a child has 255 below 0.
struct QuantisedBoxes
{
    vec3 origin;
    vec3 scale;
    uint planes[12];
};

SNELL_FN_COLD QuantisedBoxes quantise_boxes(SNELL_IN(ChildBoxes) boxes)
{
    Aabb all = empty_aabb();
    for (uint i = 0u; i < 8u; ++i)
        if (!is_empty(boxes.at[i])) all = join(all, boxes.at[i]);
    if (is_empty(all)) {
        all.lower = vec3(0.0f);
        all.upper = vec3(0.0f);
    }
    QuantisedBoxes q;
    q.origin = all.lower;
    q.scale = vec3(plane_scale(all.lower.x, all.upper.x), plane_scale(all.lower.y, all.upper.y),
                   plane_scale(all.lower.z, all.upper.z));
    for (uint i = 0u; i < 12u; ++i) q.planes[i] = 0u;
    for (uint i = 0u; i < 8u; ++i) {
        Aabb box = boxes.at[i];
        bool is_there = !is_empty(box);
        uint word = i >> 2u;
        uint shift = (i & 3u) << 3u;
        for (uint axis = 0u; axis < 3u; ++axis) {
            uint low = 255u;
            uint high = 0u;
            if (is_there) {
                low = plane_below(box.lower[int(axis)], q.origin[int(axis)], q.scale[int(axis)]);
                high = plane_above(box.upper[int(axis)], q.origin[int(axis)], q.scale[int(axis)]);
            }
            q.planes[4u * axis + word] = q.planes[4u * axis + word] | low << shift;
            q.planes[4u * axis + 2u + word] = q.planes[4u * axis + 2u + word] | high << shift;
        }
    }
    return q;
}

SNELL_END
#endif
