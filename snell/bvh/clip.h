// Cutting triangles at planes, so that nothing of them is lost to rounding.
#pragma once

#include "snell/bvh/tree.h"

#include <cmath>

namespace snell {

// The two sides of a cut, their common edge in both. A side without points is empty.
struct CutBoxes
{
    Box below, above;
};

// The next float downwards or upwards, unless x is one already.
inline float round_down(double x)
{
    const auto nearest = static_cast<float>(x);
    return double(nearest) <= x ? nearest : std::nextafter(nearest, -std::numeric_limits<float>::infinity());
}
inline float round_up(double x)
{
    const auto nearest = static_cast<float>(x);
    return double(nearest) >= x ? nearest : std::nextafter(nearest, std::numeric_limits<float>::infinity());
}

// Boxes around the parts of triangle v on either side of the plane x[axis] = plane, at most a rounding larger than
// they: the points of the plane are computed in double, with a bound on the error, and rounded outwards. Finite
// vertices, of any size.
inline CutBoxes cut_triangle(const vec3 (&v)[3], int axis, float plane)
{
    CutBoxes cut;
    for (int i = 0; i < 3; ++i) {
        const vec3 &a = v[i], &b = v[(i + 1) % 3];
        if (a[axis] <= plane) cut.below.extend(a);
        if (a[axis] >= plane) cut.above.extend(a);
        if (!((a[axis] < plane && b[axis] > plane) || (a[axis] > plane && b[axis] < plane))) continue;
        const double t = (double(plane) - a[axis]) / (double(b[axis]) - a[axis]);
        vec3 lower, upper;
        for (int k = 0; k < 3; ++k) {
            const double reach = std::max(std::abs(double(a[k])), std::abs(double(b[k])));
            const double at = a[k] + t * (double(b[k]) - a[k]);
            const double error = reach * 0x1p-49; // 13 roundings, none larger than 2^-53 of it
            lower[k] = round_down(at - error);
            upper[k] = round_up(at + error);
        }
        lower[axis] = upper[axis] = plane;
        // Never outside of the edge itself.
        lower = max(lower, min(a, b));
        upper = min(upper, max(a, b));
        for (Box* side : {&cut.below, &cut.above}) {
            side->extend(lower);
            side->extend(upper);
        }
    }
    return cut;
}

inline Box intersection(const Box& a, const Box& b)
{
    return {max(a.lower, b.lower), min(a.upper, b.upper)};
}

} // namespace snell
