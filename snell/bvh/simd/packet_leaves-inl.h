// Leaves, met by a packet. Compiled once for each instruction set.
#if defined(SNELL_BVH_SIMD_PACKET_LEAVES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SNELL_BVH_SIMD_PACKET_LEAVES_INL_H
#undef SNELL_BVH_SIMD_PACKET_LEAVES_INL_H
#else
#define SNELL_BVH_SIMD_PACKET_LEAVES_INL_H
#endif

#include "snell/bvh/simd/leaves-inl.h"
#include "snell/bvh/simd/packet_rays-inl.h"

HWY_BEFORE_NAMESPACE();
namespace snell {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Lanes of `ok` where (t, number) is_better_hit(). A packet is in world space, where the instance never decides a tie
// for the newcomer.
HWY_INLINE hn::Mask<Packet::Tag> better_lanes(const Packet& p, uint first, hn::Mask<Packet::Tag> ok,
                                              hn::Vec<Packet::Tag> t, uint number)
{
    const Packet::Tag d;
    const hn::RebindToUnsigned<Packet::Tag> du;
    const auto old_t = hn::Load(d, p.t + first);
    const auto smaller = hn::VecFromMask(du, hn::Gt(hn::Load(du, p.primitive + first), hn::Set(du, number)));
    const auto wins_tie = hn::And(hn::Eq(t, old_t), hn::MaskFromVec(hn::BitCast(d, smaller)));
    return hn::And(ok, hn::Or(hn::Lt(t, old_t), wins_tie));
}

template <Query query>
HWY_INLINE void accept_lanes(Packet& p, uint first, hn::Mask<Packet::Tag> lanes, hn::Vec<Packet::Tag> t,
                             hn::Vec<Packet::Tag> u, hn::Vec<Packet::Tag> v, uint number)
{
    const Packet::Tag d;
    const hn::RebindToUnsigned<Packet::Tag> du;
    const auto put = [&](hn::Vec<Packet::Tag> x, float* to)
                         HWY_ATTR { hn::Store(hn::IfThenElse(lanes, x, hn::Load(d, to)), d, to); };
    const auto put_uint = [&](uint x, uint* to) HWY_ATTR {
        const auto set = hn::MaskFromVec(hn::BitCast(du, hn::VecFromMask(d, lanes)));
        hn::Store(hn::IfThenElse(set, hn::Set(du, x), hn::Load(du, to)), du, to);
    };
    put(t, p.t + first);
    put(u, p.u + first);
    put(v, p.v + first);
    put_uint(number, p.primitive + first);
    put_uint(none, p.instance + first);
    put(query == Query::any ? hn::Set(d, -INFINITY) : t, p.best + first);
}

// intersect_sphere(), operation by operation, on vectors of rays.
template <Query query>
HWY_INLINE void visit_sphere(Packet& p, Lanes lanes, const Sphere& ball, uint number)
{
    const Packet::Tag d;
    const auto zero = hn::Zero(d);
    const auto dot = [](auto ax, auto ay, auto az, auto bx, auto by, auto bz)
                         HWY_ATTR { return hn::Add(hn::Add(hn::Mul(ax, bx), hn::Mul(ay, by)), hn::Mul(az, bz)); };
    for_parts_of(lanes, [&](uint i) HWY_ATTR {
        const auto rx = hn::Load(d, p.direction[0] + i), ry = hn::Load(d, p.direction[1] + i);
        const auto rz = hn::Load(d, p.direction[2] + i);
        const auto longest = hn::Max(hn::Abs(rx), hn::Max(hn::Abs(ry), hn::Abs(rz)));
        const auto scale = hn::Div(hn::Set(d, 1.0f), longest);
        const auto dx = hn::Mul(rx, scale), dy = hn::Mul(ry, scale), dz = hn::Mul(rz, scale);
        const auto fx = hn::Sub(hn::Load(d, p.origin[0] + i), hn::Set(d, ball.center.x));
        const auto fy = hn::Sub(hn::Load(d, p.origin[1] + i), hn::Set(d, ball.center.y));
        const auto fz = hn::Sub(hn::Load(d, p.origin[2] + i), hn::Set(d, ball.center.z));
        const auto a = dot(dx, dy, dz, dx, dy, dz);
        const auto b = hn::Neg(dot(fx, fy, fz, dx, dy, dz));
        const auto along = hn::Div(b, a);
        const auto nx = hn::Add(fx, hn::Mul(along, dx)), ny = hn::Add(fy, hn::Mul(along, dy));
        const auto nz = hn::Add(fz, hn::Mul(along, dz));
        const auto r2 = hn::Mul(hn::Set(d, ball.radius), hn::Set(d, ball.radius));
        const auto discriminant = hn::Sub(r2, dot(nx, ny, nz, nx, ny, nz));
        const auto best = hn::Load(d, p.best + i), t_min = hn::Load(d, p.t_min + i);
        const auto met = hn::And(hn::Gt(discriminant, zero), hn::Ne(best, hn::Set(d, -INFINITY)));
        if (hn::AllFalse(d, met)) return;

        const auto root = hn::Sqrt(hn::Mul(a, discriminant));
        const auto q = hn::IfThenElse(hn::Ge(b, zero), hn::Add(b, root), hn::Sub(b, root));
        const auto c = hn::Sub(dot(fx, fy, fz, fx, fy, fz), r2);
        const auto t0 = hn::Mul(hn::Div(c, q), scale), t1 = hn::Mul(hn::Div(q, a), scale);
        const auto in_order = hn::Lt(t0, t1);
        const auto near = hn::IfThenElse(in_order, t0, t1), far = hn::IfThenElse(in_order, t1, t0);
        const auto t = hn::IfThenElse(hn::Gt(near, t_min), near, far);
        const auto ok = hn::And(met, hn::And(hn::Gt(t, t_min), hn::Le(t, best)));
        const auto better = better_lanes(p, i, ok, t, number);
        if (!hn::AllFalse(d, better)) accept_lanes<query>(p, i, better, t, zero, zero, number);
    });
}

// Triangles of a block, as bits, whose boxes some ray of the packet may meet: most of a leaf's triangles are met by
// none, and this asks for all of them at once.
HWY_INLINE uint triangles_in_bounds(const TriangleBlock& block, const PacketBounds& b, float best)
{
    const TriangleTag d;
    constexpr uint n = hn::MaxLanes(d);
    const BoundVectors bounds(d, b, best);
    uint bits = 0;
    for (uint first = 0; first < max_leaf_size; first += n) {
        const Corners corners(block, first);
        auto enter = bounds.t_min, leave = bounds.farthest;
        for (uint axis = 0; axis < 3; ++axis) {
            const auto x = corners.get(0, axis), y = corners.get(1, axis), z = corners.get(2, axis);
            auto near = hn::Min(x, hn::Min(y, z)), far = hn::Max(x, hn::Max(y, z));
            if ((b.row[axis] & 1u) != 0) std::swap(near, far);
            bounds.clip(static_cast<int>(axis), near, far, enter, leave);
        }
        bits |= mask_bits(d, hn::Le(enter, leave)) << first;
    }
    return bits & block.lanes;
}

// watertight() with vectors of rays instead of triangles. Returns the lanes that must be asked for exactly.
template <Query query>
HWY_INLINE Lanes visit_triangle(Packet& p, Lanes lanes, const TriangleBlock& block, uint triangle)
{
    const Packet::Tag d;
    const uint number = pack_primitive(kind_triangle, block.id[triangle]);
    const float* const lists[3] = {block.axis(0), block.axis(1), block.axis(2)};
    const uint at[3] = {block.corner_of(triangle, 0), block.corner_of(triangle, 1), block.corner_of(triangle, 2)};
    const auto corner = [&](int vertex, int axis) HWY_ATTR { return hn::Set(d, lists[axis][at[vertex]]); };
    Lanes all_unsure = 0;
    for_parts_of(lanes, [&](uint i) HWY_ATTR {
        const auto ox = hn::Load(d, p.origin[p.kx] + i), oy = hn::Load(d, p.origin[p.ky] + i);
        const auto oz = hn::Load(d, p.origin[p.kz] + i);
        const auto sx = hn::Load(d, p.shear[0] + i), sy = hn::Load(d, p.shear[1] + i);
        const auto az = hn::Sub(corner(0, p.kz), oz);
        const auto bz = hn::Sub(corner(1, p.kz), oz);
        const auto cz = hn::Sub(corner(2, p.kz), oz);
        const auto ax = hn::Sub(hn::Sub(corner(0, p.kx), ox), hn::Mul(sx, az));
        const auto ay = hn::Sub(hn::Sub(corner(0, p.ky), oy), hn::Mul(sy, az));
        const auto bx = hn::Sub(hn::Sub(corner(1, p.kx), ox), hn::Mul(sx, bz));
        const auto by = hn::Sub(hn::Sub(corner(1, p.ky), oy), hn::Mul(sy, bz));
        const auto cx = hn::Sub(hn::Sub(corner(2, p.kx), ox), hn::Mul(sx, cz));
        const auto cy = hn::Sub(hn::Sub(corner(2, p.ky), oy), hn::Mul(sy, cz));
        const auto w0 = hn::Sub(hn::Mul(cx, by), hn::Mul(cy, bx));
        const auto w1 = hn::Sub(hn::Mul(ax, cy), hn::Mul(ay, cx));
        const auto w2 = hn::Sub(hn::Mul(bx, ay), hn::Mul(by, ax));
        const auto side = hn::Mul(hn::Min(w0, hn::Min(w1, w2)), hn::Max(w0, hn::Max(w1, w2)));
        const auto best = hn::Load(d, p.best + i);
        const auto searching = hn::Ne(best, hn::Set(d, -INFINITY));
        const auto unsure = hn::And(hn::Eq(side, hn::Zero(d)), searching);
        const auto inside = hn::And(hn::Gt(side, hn::Zero(d)), searching);
        if (HWY_LIKELY(hn::AllFalse(d, hn::Or(inside, unsure)))) return;
        all_unsure |= packet_lanes(i, unsure);

        const auto sz = hn::Load(d, p.shear[2] + i);
        const auto det = hn::Add(hn::Add(w0, w1), w2);
        const auto weighted =
            hn::Add(hn::Add(hn::Mul(w0, hn::Mul(sz, az)), hn::Mul(w1, hn::Mul(sz, bz))), hn::Mul(w2, hn::Mul(sz, cz)));
        const auto t = hn::Div(weighted, det);
        const auto near = hn::And(hn::Gt(t, hn::Load(d, p.t_min + i)), hn::Le(t, best));
        const auto better = better_lanes(p, i, hn::And(inside, near), t, number);
        if (!hn::AllFalse(d, better)) accept_lanes<query>(p, i, better, t, hn::Div(w1, det), hn::Div(w2, det), number);
    });
    return all_unsure;
}

} // namespace HWY_NAMESPACE
} // namespace snell
HWY_AFTER_NAMESPACE();

#endif
