// Boxes in registers, for builders that look at every reference again and again.
#pragma once

#include "snell/bvh/tree.h"

#include <hwy/highway.h>

namespace snell {

namespace hn = hwy::HWY_NAMESPACE;
using Lanes4 = hn::FixedTag<float, 4>;
using Vec4 = hn::Vec<Lanes4>;

// A reference's fourth lane is an integer in disguise; it becomes 0, so that no arithmetic meets a denormal or a NaN.
inline Vec4 load3(const vec3& v)
{
    alignas(16) static constexpr uint mask[4] = {~0u, ~0u, ~0u, 0u};
    const hn::RebindToUnsigned<Lanes4> du;
    return hn::And(hn::Load(Lanes4(), &v.x), hn::BitCast(Lanes4(), hn::Load(du, mask)));
}

// Twice the centre of a reference's box: what builders sort by.
inline Vec4 centre2(const PrimitiveRef& ref)
{
    return hn::Add(load3(ref.lower), load3(ref.upper));
}
inline float centre2(const PrimitiveRef& ref, int axis)
{
    return ref.lower[axis] + ref.upper[axis];
}

// A box; a new one is empty. The fourth lanes are 0 once something is in it.
struct WideBox
{
    Vec4 lower = hn::Set(Lanes4(), std::numeric_limits<float>::infinity());
    Vec4 upper = hn::Set(Lanes4(), -std::numeric_limits<float>::infinity());

    void extend(Vec4 lo, Vec4 hi) { lower = hn::Min(lower, lo), upper = hn::Max(upper, hi); }
    void extend(const WideBox& b) { extend(b.lower, b.upper); }
    Box box() const
    {
        alignas(16) float lo[4], hi[4];
        hn::Store(lower, Lanes4(), lo);
        hn::Store(upper, Lanes4(), hi);
        return {vec3(lo[0], lo[1], lo[2]), vec3(hi[0], hi[1], hi[2])};
    }
};

struct Extents
{
    WideBox box;    // of the primitives
    WideBox centre; // of twice their centres

    void extend(const PrimitiveRef& ref)
    {
        const Vec4 lo = load3(ref.lower), hi = load3(ref.upper), c = hn::Add(lo, hi);
        box.extend(lo, hi);
        centre.extend(c, c);
    }
    void extend(const Extents& e)
    {
        box.extend(e.box);
        centre.extend(e.centre);
    }
};

} // namespace snell
