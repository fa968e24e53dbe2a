// Axis-aligned boxes of primitives and instances, as trees are built over them.
#ifndef SNELL_KERNEL_BOUNDS_H
#define SNELL_KERNEL_BOUNDS_H
#include "snell/kernel/scene_view.h"
SNELL_BEGIN

// Empty: lower > upper on some axis; only empty_aabb() is meant to be.
struct Aabb
{
    vec3 lower;
    vec3 upper;
};
SNELL_LAYOUT(Aabb, 24)

SNELL_FN Aabb empty_aabb()
{
    Aabb b = {vec3(infinity()), vec3(-infinity())};
    return b;
}

SNELL_FN bool is_empty(Aabb b)
{
    return !(b.lower.x <= b.upper.x && b.lower.y <= b.upper.y && b.lower.z <= b.upper.z);
}

SNELL_FN Aabb join(Aabb a, Aabb b)
{
    Aabb both = {min(a.lower, b.lower), max(a.upper, b.upper)};
    return both;
}

// Half the surface of a box that is scaled by `scale`; 0 if it is empty. Scaled so that the largest box of a tree has
// sides of about 1, no box overflows.
SNELL_FN float half_area(Aabb b, float scale)
{
    if (is_empty(b)) return 0.0f;
    vec3 e = (b.upper - b.lower) * scale;
    return e.x * (e.y + e.z) + e.y * e.z;
}

// The nearest floats below and above x, which is neither NaN nor the infinity that is meant to be left behind.
SNELL_FN float float_before(float x)
{
    uint bits = floatBitsToUint(x);
    if (x > 0.0f) return uintBitsToFloat(bits - 1u);
    return x < 0.0f ? uintBitsToFloat(bits + 1u) : uintBitsToFloat(0x80000001u);
}
SNELL_FN float float_after(float x)
{
    return -float_before(-x);
}

// -0 becomes +0: min and max of the two depend on the order, and trees must not. (Adding 0 does that too, but not where
// a driver leaves such additions out.)
SNELL_FN vec3 plain_zero(vec3 v)
{
    return vec3(v.x == 0.0f ? 0.0f : v.x, v.y == 0.0f ? 0.0f : v.y, v.z == 0.0f ? 0.0f : v.z);
}

// The box of a triangle; empty if a vertex is not finite.
SNELL_FN Aabb triangle_bounds(vec3 a, vec3 b, vec3 c)
{
    if (!is_finite3(a) || !is_finite3(b) || !is_finite3(c)) return empty_aabb();
    Aabb box = {plain_zero(min(a, min(b, c))), plain_zero(max(a, max(b, c)))};
    return box;
}

// The box of a sphere, a little larger, so that rounding never cuts into it; empty if it is not finite.
SNELL_FN Aabb sphere_bounds(vec3 center, float radius)
{
    float r = abs(radius);
    vec3 low = center - r;
    vec3 high = center + r;
    if (!is_finite3(low) || !is_finite3(high)) return empty_aabb();
    Aabb box = {plain_zero(vec3(float_before(low.x), float_before(low.y), float_before(low.z))),
                plain_zero(vec3(float_after(high.x), float_after(high.y), float_after(high.z)))};
    if (!is_finite3(box.lower) || !is_finite3(box.upper)) return empty_aabb();
    return box;
}

// The box in world space of an instance of a group whose box is `group`; a little larger than the transformed one, for
// the rounding of the ray's own transformation. Empty if the group's is, or if it is not finite.
SNELL_FN Aabb instance_bounds(Transform to_world, Aabb group)
{
    if (is_empty(group)) return empty_aabb();
    Aabb box = empty_aabb();
    // The largest number that takes part in the transformation.
    float reach = max(abs(to_world.x.w), max(abs(to_world.y.w), abs(to_world.z.w)));
    for (uint corner = 0u; corner < 8u; ++corner) {
        vec3 p = vec3((corner & 1u) != 0u ? group.upper.x : group.lower.x,
                      (corner & 2u) != 0u ? group.upper.y : group.lower.y,
                      (corner & 4u) != 0u ? group.upper.z : group.lower.z);
        vec3 q = transform_point(to_world, p);
        if (!is_finite3(q)) return empty_aabb();
        box.lower = min(box.lower, q);
        box.upper = max(box.upper, q);
        reach = max(reach, max3(abs(q)));
    }
    vec3 slack = vec3(reach * 9.5367431640625e-7f); // 2^-20
    box.lower = plain_zero(box.lower - slack);
    box.upper = plain_zero(box.upper + slack);
    if (!is_finite3(box.lower) || !is_finite3(box.upper)) return empty_aabb();
    return box;
}

SNELL_END
#endif
