// What traversal keeps of a ray on its way through the tree.
#pragma once

#include "snell/bvh/wide.h"
#include "snell/kernel/bounds.h"
#include "snell/kernel/intersect.h"

#include <cfloat>
#include <cmath>

namespace snell {

// The slab test takes the planes through which a ray enters and leaves a box: t = plane * inverse - origin * inverse.
// It must never miss a box in which a primitive test would find a hit, rounding or not. Instead of stretching t (Ize
// 2013, Robust BVH Ray Traversal), which leaves out negative t and axes along which the ray does not move, each axis
// has two origins, a little apart: seen from them every box is larger by some units in the last place of the lengths
// that take part. With u = 2^-24 and reach the largest distance to any plane of the tree, that is
//  - 10 u reach: the triangle test accepts rays that pass the sheared vertices within 5 u of the largest distance; the
//    reciprocal and the slab's last rounding add 2 u, the decoding of a quantised plane 1 u;
//  - 5 u |origin|: the roundings of origin +- slack and of its product with the reciprocal, and of the decoding.
// A reciprocal is held below 1e36 over the largest coordinate, so that no product overflows. For a direction component
// of 0 it is that number: the slack times it is beyond any t, so the slab of a box that contains the ray's coordinate
// is entered at about -infinity and left at +infinity; and no 0 * infinity, no NaN, ever comes up.
inline constexpr float slack_by_reach = 10.0f * 0x1p-24f, slack_by_origin = 5.0f * 0x1p-24f;

// What follows from the ray and the tree alone.
struct alignas(32) RaySetup
{
    // What inner nodes need, in one cache line.
    float inverse[3];
    float enter_term[3], leave_term[3]; // origin * inverse, for the planes where the ray enters and leaves
    float t_min;
    float best;        // hits at t <= best are of interest: the float before t_max, then that of the nearest hit
    uint enter_row[3]; // bytes to the planes where the ray enters boxes; where it leaves: Node::row_bytes turned
    uint octant;       // bit i: the direction is negative on axis i
    ChildWord current; // what to visit next

    // What leaves need.
    float shear[3];             // sx, sy, sz of ShearedRay
    float shear_origin[3];      // the origin's components kx, ky, kz
    std::uint8_t shear_axes[4]; // kx, ky, kz
    uint instance;              // none: world space
};
static_assert(sizeof(RaySetup) == 96);

template <class Node>
struct alignas(64) RayState : RaySetup
{
    ChildWord* top;            // of the stack: behind the last entry
    const std::byte* parts[2]; // of the tree that is being traversed: its lines and its nodes
    ChildWord* stack;          // see Stacks

    const Node* nodes() const { return reinterpret_cast<const Node*>(parts[1]); }
    const Line* lines() const { return reinterpret_cast<const Line*>(parts[0]); }

    Hit hit;
    uint ray_index; // in the batch
    uint steps;
    const WideTree<Node>* tree;
    Ray ray;   // in the space of the tree
    Hit after; // Query::next: what the hit must come behind
};

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

} // namespace snell
