// Leaves: blocks of triangles and spheres. Compiled once for each instruction set.
#if defined(SNELL_BVH_SIMD_LEAVES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SNELL_BVH_SIMD_LEAVES_INL_H
#undef SNELL_BVH_SIMD_LEAVES_INL_H
#else
#define SNELL_BVH_SIMD_LEAVES_INL_H
#endif

#include "snell/bvh/simd/nodes-inl.h"
#include "snell/bvh/simd/traverse.h"

HWY_BEFORE_NAMESPACE();
namespace snell {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// What both triangle tests hand over: t of the four lanes, and u and v times the determinant.
struct FourTriangles
{
    hn::Vec<hn::FixedTag<float, 4>> t, u, v, det;
    hn::Mask<hn::FixedTag<float, 4>> ok, unsure; // unsure: the kernel function must decide, whatever ok says
};

// intersect_triangle_watertight, operation by operation, on four triangles.
HWY_INLINE FourTriangles watertight(const TriangleBlock& block, const RayState& s)
{
    const hn::FixedTag<float, 4> d;
    const auto ox = hn::Set(d, s.shear_origin[0]), oy = hn::Set(d, s.shear_origin[1]);
    const auto oz = hn::Set(d, s.shear_origin[2]);
    const auto sx = hn::Set(d, s.shear.sx), sy = hn::Set(d, s.shear.sy), sz = hn::Set(d, s.shear.sz);
    const int kx = s.shear.kx, ky = s.shear.ky, kz = s.shear.kz;
    const auto az = hn::Sub(hn::Load(d, block.v[0][kz]), oz);
    const auto bz = hn::Sub(hn::Load(d, block.v[1][kz]), oz);
    const auto cz = hn::Sub(hn::Load(d, block.v[2][kz]), oz);
    const auto ax = hn::Sub(hn::Sub(hn::Load(d, block.v[0][kx]), ox), hn::Mul(sx, az));
    const auto ay = hn::Sub(hn::Sub(hn::Load(d, block.v[0][ky]), oy), hn::Mul(sy, az));
    const auto bx = hn::Sub(hn::Sub(hn::Load(d, block.v[1][kx]), ox), hn::Mul(sx, bz));
    const auto by = hn::Sub(hn::Sub(hn::Load(d, block.v[1][ky]), oy), hn::Mul(sy, bz));
    const auto cx = hn::Sub(hn::Sub(hn::Load(d, block.v[2][kx]), ox), hn::Mul(sx, cz));
    const auto cy = hn::Sub(hn::Sub(hn::Load(d, block.v[2][ky]), oy), hn::Mul(sy, cz));

    const auto w0 = hn::Sub(hn::Mul(cx, by), hn::Mul(cy, bx));
    const auto w1 = hn::Sub(hn::Mul(ax, cy), hn::Mul(ay, cx));
    const auto w2 = hn::Sub(hn::Mul(bx, ay), hn::Mul(by, ax));
    // Positive: all three have the same sign. 0: one is 0 or nearly so, and its sign needs a closer look (edge_function
    // in the kernel). Negative: outside.
    const auto side = hn::Mul(hn::Min(w0, hn::Min(w1, w2)), hn::Max(w0, hn::Max(w1, w2)));
    const auto det = hn::Add(hn::Add(w0, w1), w2);
    const auto weighted =
        hn::Add(hn::Add(hn::Mul(w0, hn::Mul(sz, az)), hn::Mul(w1, hn::Mul(sz, bz))), hn::Mul(w2, hn::Mul(sz, cz)));
    const auto t = hn::Div(weighted, det); // NaN where det is 0 or anything was NaN
    const auto inside = hn::And(hn::Gt(t, hn::Set(d, s.t_min)), hn::Le(t, hn::Set(d, s.best)));
    const auto zero = hn::Zero(d);
    return {t, w1, w2, det, hn::And(hn::Gt(side, zero), inside), hn::Eq(side, zero)};
}

// The same for intersect_triangle_moller_trumbore.
HWY_INLINE FourTriangles moller_trumbore(const TriangleBlock& block, const RayState& s)
{
    const hn::FixedTag<float, 4> d;
    const auto vertex = [&](int i, int axis) HWY_ATTR { return hn::Load(d, block.v[i][axis]); };
    const auto cross_term = [](auto a, auto b, auto c, auto e)
                                HWY_ATTR { return hn::Sub(hn::Mul(a, b), hn::Mul(c, e)); };
    const auto e1x = hn::Sub(vertex(1, 0), vertex(0, 0)), e2x = hn::Sub(vertex(2, 0), vertex(0, 0));
    const auto e1y = hn::Sub(vertex(1, 1), vertex(0, 1)), e2y = hn::Sub(vertex(2, 1), vertex(0, 1));
    const auto e1z = hn::Sub(vertex(1, 2), vertex(0, 2)), e2z = hn::Sub(vertex(2, 2), vertex(0, 2));
    const auto dx = hn::Set(d, s.ray.direction.x), sx = hn::Sub(hn::Set(d, s.ray.origin.x), vertex(0, 0));
    const auto dy = hn::Set(d, s.ray.direction.y), sy = hn::Sub(hn::Set(d, s.ray.origin.y), vertex(0, 1));
    const auto dz = hn::Set(d, s.ray.direction.z), sz = hn::Sub(hn::Set(d, s.ray.origin.z), vertex(0, 2));
    const auto px = cross_term(dy, e2z, dz, e2y), qx = cross_term(sy, e1z, sz, e1y);
    const auto py = cross_term(dz, e2x, dx, e2z), qy = cross_term(sz, e1x, sx, e1z);
    const auto pz = cross_term(dx, e2y, dy, e2x), qz = cross_term(sx, e1y, sy, e1x);
    const auto dot = [](auto ax, auto bx, auto ay, auto by, auto az, auto bz)
                         HWY_ATTR { return hn::Add(hn::Add(hn::Mul(ax, bx), hn::Mul(ay, by)), hn::Mul(az, bz)); };
    const auto det = dot(e1x, px, e1y, py, e1z, pz);
    const auto u_det = dot(sx, px, sy, py, sz, pz);
    const auto v_det = dot(dx, qx, dy, qy, dz, qz);
    const auto u = hn::Div(u_det, det), v = hn::Div(v_det, det);
    const auto t = hn::Div(dot(e2x, qx, e2y, qy, e2z, qz), det);
    const auto zero = hn::Zero(d);
    const auto inside = hn::And(hn::And(hn::Ge(u, zero), hn::Ge(v, zero)), hn::Le(hn::Add(u, v), hn::Set(d, 1.0f)));
    const auto near = hn::And(hn::Gt(t, hn::Set(d, s.t_min)), hn::Le(t, hn::Set(d, s.best)));
    return {t, u_det, v_det, det, hn::And(hn::And(inside, near), hn::Ne(det, zero)), hn::FirstN(d, 0)};
}

HWY_INLINE void accept(RayState& s, float t, float u, float v, uint primitive, uint instance)
{
    s.best = t;
    s.hit = {t, u, v, primitive, instance};
}

// Query::next leaves out what does not come behind the hit to go on from.
template <Query query>
HWY_INLINE bool is_wanted(const RayState& s, float t, uint primitive)
{
    return query != Query::next || is_later_hit(t, primitive, s.instance, s.after);
}

// One triangle of a block by the kernel function, for rays that meet an edge to within rounding.
template <Query query>
HWY_NOINLINE bool visit_triangle_exactly(const TriangleBlock& block, uint lane, RayState& s)
{
    vec3 v[3];
    for (int vertex = 0; vertex < 3; ++vertex)
        for (int axis = 0; axis < 3; ++axis) v[vertex][axis] = block.v[vertex][axis][lane];
    const Intersection r = intersect_triangle_watertight(s.ray, s.shear, v[0], v[1], v[2]);
    const uint primitive = pack_primitive(kind_triangle, block.id[lane]);
    if (!r.ok || !is_wanted<query>(s, r.t, primitive) || !is_better_hit(r.t, primitive, s.instance, s.hit))
        return false;
    accept(s, r.t, r.u, r.v, primitive, s.instance);
    return true;
}

template <Query query, TriangleTest test>
HWY_INLINE bool visit_triangles(const TriangleBlock& block, RayState& s)
{
    const hn::FixedTag<float, 4> d;
    const FourTriangles r = test == TriangleTest::watertight ? watertight(block, s) : moller_trumbore(block, s);
    if (query == Query::counted)
        for (const uint id : block.id) s.steps += id != none;
    if (HWY_LIKELY(hn::AllFalse(d, hn::Or(r.ok, r.unsure)))) return false;
    const uint ok = mask_bits(d, r.ok);
    if (query == Query::any && ok != 0) return true;
    const uint unsure = mask_bits(d, r.unsure);

    alignas(16) float t[4], u[4], v[4], det[4];
    hn::Store(r.t, d, t);
    hn::Store(r.u, d, u);
    hn::Store(r.v, d, v);
    hn::Store(r.det, d, det);
    bool improved = false;
    for (uint rest = ok | unsure; rest != 0; rest &= rest - 1) {
        const auto lane = static_cast<uint>(hwy::Num0BitsBelowLS1Bit_Nonzero32(rest));
        if (HWY_UNLIKELY(unsure >> lane & 1u)) {
            improved = visit_triangle_exactly<query>(block, lane, s) || improved;
            continue;
        }
        const uint primitive = pack_primitive(kind_triangle, block.id[lane]);
        if (!is_wanted<query>(s, t[lane], primitive) || !is_better_hit(t[lane], primitive, s.instance, s.hit)) continue;
        accept(s, t[lane], u[lane] / det[lane], v[lane] / det[lane], primitive, s.instance);
        improved = true;
    }
    return improved;
}

template <Query query>
HWY_INLINE bool visit_spheres(const TraceInput& input, const SphereBlock& block, RayState& s)
{
    bool improved = false;
    for (const uint id : block.id) {
        if (id == none) break;
        if (query == Query::counted) ++s.steps;
        const Sphere& ball = input.scene->spheres[id];
        Intersection r = intersect_sphere(s.ray, ball.center, ball.radius);
        const uint primitive = pack_primitive(kind_sphere, id);
        if (query == Query::next && r.ok && !is_wanted<query>(s, r.t, primitive)) { // the far side may be
            Ray onward = s.ray;
            onward.t_min = r.t;
            r = intersect_sphere(onward, ball.center, ball.radius);
        }
        if (!r.ok || !is_better_hit(r.t, primitive, s.instance, s.hit)) continue;
        accept(s, r.t, 0.0f, 0.0f, primitive, s.instance);
        improved = true;
        if (query == Query::any) break;
    }
    return improved;
}

} // namespace HWY_NAMESPACE
} // namespace snell
HWY_AFTER_NAMESPACE();

#endif
