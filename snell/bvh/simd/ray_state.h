// What traversal keeps of a ray on its way through the tree.
#pragma once

#include "snell/bvh/wide.h"
#include "snell/kernel/intersect.h"

#include <cfloat>
#include <cmath>

namespace snell {

// The slab test takes the planes through which a ray enters and leaves a box: t = plane * inverse - origin * inverse.
// It must never miss a box in which a primitive test would find a hit, rounding or not. Instead of stretching t (Ize
// 2013, Robust BVH Ray Traversal), which leaves out negative t and axes along which the ray does not move, each axis
// has two origins, a little apart: seen from them every box is larger by some units in the last place of the lengths
// that take part. With u = 2^-24 and reach the largest distance to any plane of the tree, that is
//  - 8 u reach: the triangle test accepts rays that pass the sheared vertices within 5 u of the largest distance; the
//    reciprocal and the slab's last rounding add 2 u;
//  - 4 u |origin|: the roundings of origin +- slack and of its product with the reciprocal.
// A reciprocal is held below 1e36 over the largest coordinate, so that no product overflows. For a direction component
// of 0 it is that number: the slack times it is beyond any t, so the slab of a box that contains the ray's coordinate
// is entered at about -infinity and left at +infinity; and no 0 * infinity, no NaN, ever comes up.
struct alignas(64) RayState
{
    float inverse[4];                   // the fourth components mean nothing
    float enter_term[4], leave_term[4]; // origin * inverse, for the planes where the ray enters and leaves
    float t_min;
    float best;    // hits at t <= best are of interest: the float before t_max, then that of the nearest hit
    uint octant;   // bit i: the direction is negative on axis i
    uint instance; // none: world space

    ChildWord* stack;  // see Stacks
    uint stack_size;   // entries in use
    ChildWord current; // what to visit next
    ShearedRay shear;
    float shear_origin[3]; // the origin's components kx, ky, kz
    uint ray_index;        // in the batch
    uint steps;
    Ray ray; // in the space of the tree that is being traversed
    Hit hit;
    Hit after; // Query::next: what the hit must come behind
};

// Rows of WideNode::planes, as offsets in floats, through which rays of an octant enter and leave a box.
struct SlabRows
{
    uint enter[3], leave[3];
};
constexpr SlabRows slab_rows(uint octant)
{
    SlabRows rows = {};
    for (uint axis = 0; axis < 3; ++axis) {
        const bool negative = (octant >> axis & 1u) != 0;
        rows.enter[axis] = (negative ? 3 + axis : axis) * node_width;
        rows.leave[axis] = (negative ? axis : 3 + axis) * node_width;
    }
    return rows;
}
inline constexpr SlabRows rows_by_octant[8] = {slab_rows(0), slab_rows(1), slab_rows(2), slab_rows(3),
                                               slab_rows(4), slab_rows(5), slab_rows(6), slab_rows(7)};

// For each set of lanes: their numbers in ascending order, 4 bits each, the first lowest.
struct LaneLists
{
    uint lanes[256];
};
constexpr LaneLists list_lanes()
{
    LaneLists lists = {};
    for (uint set = 0; set < 256; ++set)
        for (uint lane = 0, count = 0; lane < 8; ++lane)
            if (set >> lane & 1u) lists.lanes[set] |= lane << (4 * count++);
    return lists;
}
inline constexpr LaneLists lane_lists = list_lanes();

inline constexpr int next_axis[3] = {1, 2, 0};

// The largest float below x, which is not NaN or -infinity.
inline float float_before(float x)
{
    const uint bits = floatBitsToUint(x);
    if (x > 0.0f) return uintBitsToFloat(bits - 1);
    return x < 0.0f ? uintBitsToFloat(bits + 1) : uintBitsToFloat(0x80000001u);
}

} // namespace snell
