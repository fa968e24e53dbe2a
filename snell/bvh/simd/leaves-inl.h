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

using TriangleTag = hn::CappedTag<float, max_leaf_size>;
using TriangleVec = hn::Vec<TriangleTag>;

// The three vertices of a block's triangles, or of part of them where vectors are short: looked up in the block's short
// lists of coordinates.
class Corners
{
  public:
    HWY_INLINE Corners(const TriangleBlock& from, uint first) : block_(from), first_(first)
    {
#if HWY_TARGET <= HWY_AVX2
        const auto four_bits = hn::ShiftLeft<2>(hn::Iota(Index(), 0));
        for (uint v = 0; v < 3; ++v) lanes_[v] = hn::Shr(hn::Set(Index(), from.corner[v]), four_bits);
#endif
    }

    HWY_INLINE TriangleVec get(uint vertex, uint axis) const
    {
        const TriangleTag d;
        const float* list = block_.axis(axis); // what lies behind it may be read
#if HWY_TARGET <= HWY_AVX3
        // Vectors of 512 bits would do it as well, but while they are under way the processor adds and multiplies less.
        const auto low = hn::LoadU(d, list), high = hn::LoadU(d, list + 8);
        return TriangleVec{_mm256_permutex2var_ps(low.raw, lanes_[vertex].raw, high.raw)};
#elif HWY_TARGET == HWY_AVX2
        const auto lanes = hn::IndicesFromVec(d, hn::And(lanes_[vertex], hn::Set(Index(), 7u)));
        const auto low = hn::TableLookupLanes(hn::LoadU(d, list), lanes);
        const auto high = hn::TableLookupLanes(hn::LoadU(d, list + 8), lanes);
        const auto in_high = hn::MaskFromVec(hn::BitCast(d, hn::ShiftLeft<28>(lanes_[vertex])));
        return hn::IfThenElse(in_high, high, low);
#else
        constexpr uint n = hn::MaxLanes(d);
        alignas(16) float x[n];
        const uint corners = block_.corner[vertex] >> (4 * first_);
        for (uint lane = 0; lane < n; ++lane) x[lane] = list[corners >> (4 * lane) & 15u];
        return hn::Load(d, x);
#endif
    }

  private:
    const TriangleBlock& block_;
    [[maybe_unused]] const uint first_;
#if HWY_TARGET <= HWY_AVX2
    using Index = hn::RebindToUnsigned<TriangleTag>;
    hn::Vec<Index> lanes_[3];
#endif
};

// What both triangle tests hand over: t of the lanes, and u and v times the determinant.
struct TriangleHits
{
    TriangleVec t, u, v, det;
    uint ok, unsure; // bits of lanes; unsure: the kernel function must decide, whatever ok says
};

// intersect_triangle_watertight, operation by operation, on vectors of triangles.
template <class Node>
HWY_INLINE bool watertight(const TriangleBlock& block, uint first, const RayState<Node>& s, TriangleHits& hits)
{
    const TriangleTag d;
    const Corners corners(block, first);
    const auto ox = hn::Set(d, s.shear_origin[0]), oy = hn::Set(d, s.shear_origin[1]);
    const auto oz = hn::Set(d, s.shear_origin[2]);
    const auto sx = hn::Set(d, s.shear[0]), sy = hn::Set(d, s.shear[1]);
    const uint kx = s.shear_axes[0], ky = s.shear_axes[1], kz = s.shear_axes[2];
    const auto az = hn::Sub(corners.get(0, kz), oz);
    const auto bz = hn::Sub(corners.get(1, kz), oz);
    const auto cz = hn::Sub(corners.get(2, kz), oz);
    const auto ax = hn::Sub(hn::Sub(corners.get(0, kx), ox), hn::Mul(sx, az));
    const auto ay = hn::Sub(hn::Sub(corners.get(0, ky), oy), hn::Mul(sy, az));
    const auto bx = hn::Sub(hn::Sub(corners.get(1, kx), ox), hn::Mul(sx, bz));
    const auto by = hn::Sub(hn::Sub(corners.get(1, ky), oy), hn::Mul(sy, bz));
    const auto cx = hn::Sub(hn::Sub(corners.get(2, kx), ox), hn::Mul(sx, cz));
    const auto cy = hn::Sub(hn::Sub(corners.get(2, ky), oy), hn::Mul(sy, cz));

    const auto w0 = hn::Sub(hn::Mul(cx, by), hn::Mul(cy, bx));
    const auto w1 = hn::Sub(hn::Mul(ax, cy), hn::Mul(ay, cx));
    const auto w2 = hn::Sub(hn::Mul(bx, ay), hn::Mul(by, ax));
    // Positive: all three have the same sign. 0: one is 0 or nearly so, and its sign needs a closer look (edge_function
    // in the kernel). Negative: outside.
    const auto side = hn::Mul(hn::Min(w0, hn::Min(w1, w2)), hn::Max(w0, hn::Max(w1, w2)));
    const auto det = hn::Add(hn::Add(w0, w1), w2);
    const auto sz = hn::Set(d, s.shear[2]);
    const auto weighted =
        hn::Add(hn::Add(hn::Mul(w0, hn::Mul(sz, az)), hn::Mul(w1, hn::Mul(sz, bz))), hn::Mul(w2, hn::Mul(sz, cz)));
    const auto t = hn::Div(weighted, det); // NaN where det is 0 or anything was NaN
    const auto near = hn::And(hn::Gt(t, hn::Set(d, s.t_min)), hn::Le(t, hn::Set(d, s.best)));
    const auto zero = hn::Zero(d);
    const uint used = block.lanes >> first;
    hits.ok = mask_bits(d, hn::And(hn::Gt(side, zero), near)) & used;
    hits.unsure = mask_bits(d, hn::Eq(side, zero)) & used;
    hits.t = t, hits.u = w1, hits.v = w2, hits.det = det;
    return (hits.ok | hits.unsure) != 0;
}

// The same for intersect_triangle_moller_trumbore.
template <class Node>
HWY_INLINE bool moller_trumbore(const TriangleBlock& block, uint first, const RayState<Node>& s, TriangleHits& hits)
{
    const TriangleTag d;
    const Corners corners(block, first);
    const auto vertex = [&](uint i, uint axis) HWY_ATTR { return corners.get(i, axis); };
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
    hits.ok = mask_bits(d, hn::And(hn::And(inside, near), hn::Ne(det, zero))) & block.lanes >> first;
    hits.unsure = 0;
    hits.t = t, hits.u = u_det, hits.v = v_det, hits.det = det;
    return hits.ok != 0;
}

template <class Node>
HWY_INLINE void accept(RayState<Node>& s, float t, float u, float v, uint primitive, uint instance)
{
    s.best = t;
    s.hit = {t, u, v, primitive, instance};
}

// Query::next leaves out what does not come behind the hit to go on from.
template <Query query, class Node>
HWY_INLINE bool is_wanted(const RayState<Node>& s, float t, uint primitive)
{
    return query != Query::next || is_later_hit(t, primitive, s.instance, s.after);
}

// One triangle of a block by the kernel function, for rays that meet an edge to within rounding.
template <Query query, class Node>
HWY_NOINLINE bool visit_triangle_exactly(const TriangleBlock& block, uint lane, RayState<Node>& s)
{
    const Intersection r = intersect_triangle_watertight(s.ray, shear_of(s), block.vertex(lane, 0),
                                                         block.vertex(lane, 1), block.vertex(lane, 2));
    const uint primitive = pack_primitive(kind_triangle, block.id[lane]);
    if (!r.ok || !is_wanted<query>(s, r.t, primitive) || !is_better_hit(r.t, primitive, s.instance, s.hit))
        return false;
    accept(s, r.t, r.u, r.v, primitive, s.instance);
    return true;
}

// Looks at the hits that the tests found. True if one of them counts.
template <Query query, class Node>
HWY_INLINE bool take_hits(const TriangleBlock& block, uint first, const TriangleHits& hits, RayState<Node>& s)
{
    if (query == Query::any && hits.ok != 0) {
        const auto lane = static_cast<uint>(hwy::Num0BitsBelowLS1Bit_Nonzero32(hits.ok));
        s.hit.primitive = pack_primitive(kind_triangle, block.id[first + lane]);
        return true;
    }
    const TriangleTag d;
    constexpr uint n = hn::MaxLanes(d);
    alignas(32) float t[n], u[n], v[n], det[n];
    hn::Store(hits.t, d, t);
    hn::Store(hits.u, d, u);
    hn::Store(hits.v, d, v);
    hn::Store(hits.det, d, det);
    bool improved = false;
    for (uint rest = hits.ok | hits.unsure; rest != 0; rest &= rest - 1) {
        const auto lane = static_cast<uint>(hwy::Num0BitsBelowLS1Bit_Nonzero32(rest));
        if (HWY_UNLIKELY(hits.unsure >> lane & 1u)) {
            improved = visit_triangle_exactly<query>(block, first + lane, s) || improved;
            continue;
        }
        const uint primitive = pack_primitive(kind_triangle, block.id[first + lane]);
        if (!is_wanted<query>(s, t[lane], primitive) || !is_better_hit(t[lane], primitive, s.instance, s.hit)) continue;
        accept(s, t[lane], u[lane] / det[lane], v[lane] / det[lane], primitive, s.instance);
        improved = true;
    }
    return improved;
}

template <Query query, TriangleTest test, class Node>
HWY_INLINE bool visit_triangles(const TriangleBlock* block, RayState<Node>& s)
{
    constexpr uint n = hn::MaxLanes(TriangleTag());
    bool improved = false;
    for (;; block = &block_at(reinterpret_cast<const Line*>(block), block->size())) {
        for (uint first = 0; first < max_leaf_size; first += n) {
            TriangleHits hits;
            const bool met = test == TriangleTest::watertight ? watertight(*block, first, s, hits)
                                                              : moller_trumbore(*block, first, s, hits);
            if (met) improved = take_hits<query>(*block, first, hits, s) || improved;
        }
        if (query == Query::counted) s.steps += block->count;
        if (HWY_LIKELY(!block->more) || (query == Query::any && improved)) return improved;
    }
}

// For comparisons; not inlined, to save code.
template <Query query, class Node>
HWY_NOINLINE bool visit_by_moller_trumbore(const TriangleBlock* block, RayState<Node>& s)
{
    return visit_triangles<query, TriangleTest::moller_trumbore>(block, s);
}

// The first triangle of a leaf that a ray meets, as a primitive, or none; without branches that depend on the answer.
template <class Node>
HWY_INLINE uint blocker_in(const TriangleBlock* block, RayState<Node>& s)
{
    constexpr uint n = hn::MaxLanes(TriangleTag());
    uint blocker = none;
    for (;; block = &block_at(reinterpret_cast<const Line*>(block), block->size())) {
        for (uint first = 0; first < max_leaf_size; first += n) {
            TriangleHits hits;
            watertight(*block, first, s, hits);
            const auto lane = static_cast<uint>(hwy::Num0BitsBelowLS1Bit_Nonzero32(hits.ok | 1u << (n - 1)));
            const uint id = pack_primitive(kind_triangle, block->id[first + lane]);
            blocker = hits.ok != 0 ? id : blocker;
            if (HWY_UNLIKELY(hits.unsure != 0) && take_hits<Query::any>(*block, first, hits, s))
                blocker = s.hit.primitive;
        }
        if (HWY_LIKELY(!block->more)) return blocker;
    }
}

template <Query query, class Node>
HWY_INLINE bool visit_spheres(const PackedScene& scene, const SphereBlock& block, RayState<Node>& s)
{
    bool improved = false;
    for (const uint id : block.id) {
        if (id == none) break;
        if (query == Query::counted) ++s.steps;
        const Sphere& ball = scene.spheres[id];
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
