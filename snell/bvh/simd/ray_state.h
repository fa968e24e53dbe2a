// What traversal keeps of a ray on its way through the tree.
#pragma once

#include "snell/bvh/wide.h"
#include "snell/kernel/intersect.h"

#include <cfloat>
#include <cmath>

namespace snell {

// The slab test of a ray against a node takes the planes where the ray enters and leaves, (plane - origin) / direction.
// It must never miss a box in which a primitive test would find a hit, rounding or not. Instead of stretching t (Ize
// 2013, Robust BVH Ray Traversal), which leaves out negative t and axes along which the ray does not move, each axis
// has two origins, a little apart: seen from them every box is larger by some units in the last place of the longest
// distance that takes part. That covers
//  - the slab test: the subtraction, the reciprocal and the product, 3 u |plane - origin| with u = 2^-24;
//  - the triangle test, which accepts rays that pass the sheared vertices within 5 u of the largest distance;
//  - the rounding of the two origins themselves, u |origin|.
// A direction component of 0 gets the reciprocal +-FLT_MAX: since the two origins differ, no plane of a box that
// contains the ray's coordinate is at distance 0, so the slab is entered at about -infinity and left at +infinity, and
// no 0 * infinity, no NaN, ever comes up.
struct alignas(64) RayState
{
    float enter_origin[3], leave_origin[3];
    float inverse[3];
    uint enter_row[3]; // first float of the row of planes through which the ray enters; the other is 24 away
    uint octant;
    float t_min;
    float best; // hits at t <= best are of interest: the float before t_max, then that of the nearest hit

    ShearedRay shear;
    float shear_origin[3]; // the origin's components kx, ky, kz
    Ray ray;               // in the space of the tree that is being traversed
    Hit hit;
    uint instance;   // none: world space
    uint ray_index;  // in the batch
    uint stack_size; // entries in use
    ChildWord current;
    uint steps;
};

// The largest float below x.
inline float float_before(float x)
{
    return std::nextafter(x, -INFINITY);
}

// Prepares for a tree in the space of `ray`. The ray is traceable and the root's box not empty.
inline void enter_space(RayState& state, const Ray& ray, const WideRoot& root, uint instance)
{
    state.ray = ray;
    state.instance = instance;
    float reach = 0.0f;
    for (int axis = 0; axis < 3; ++axis)
        reach = std::fmax(reach, std::fmax(std::fabs(root.box.lower[axis] - ray.origin[axis]),
                                           std::fabs(root.box.upper[axis] - ray.origin[axis])));
    state.octant = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const float slack = reach * 0x1p-21f + std::fabs(ray.origin[axis]) * 0x1p-22f + 1e-30f;
        const float reciprocal = 1.0f / ray.direction[axis];
        const bool negative = std::signbit(reciprocal);
        state.inverse[axis] = std::fmin(std::fmax(reciprocal, -FLT_MAX), FLT_MAX);
        state.enter_origin[axis] = ray.origin[axis] + (negative ? -slack : slack);
        state.leave_origin[axis] = ray.origin[axis] - (negative ? -slack : slack);
        state.enter_row[axis] = static_cast<uint>(axis) * node_width + (negative ? 3 * node_width : 0);
        state.octant |= (negative ? 1u : 0u) << axis;
    }
    state.shear = shear_ray(ray);
    state.shear_origin[0] = ray.origin[state.shear.kx];
    state.shear_origin[1] = ray.origin[state.shear.ky];
    state.shear_origin[2] = ray.origin[state.shear.kz];
}

} // namespace snell
