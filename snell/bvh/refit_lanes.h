// Vectors of four floats for refitting, and the blocks of triangles that they fill.
#pragma once

#include "snell/bvh/triangle_block.h"
#include "snell/core/error.h"

#include <hwy/highway.h>

#include <limits>

namespace snell::lanes {

namespace hn = hwy::HWY_NAMESPACE;
using Four = hn::FixedTag<float, 4>;
using Vec = hn::Vec<Four>;

// The same coordinate of four points, for x, y and z.
struct Rows
{
    Vec x, y, z;
};

// A box in two vectors, whose fourth lanes mean nothing. A new one is empty.
struct Corners
{
    Vec lower = hn::Set(Four(), std::numeric_limits<float>::infinity());
    Vec upper = hn::Set(Four(), -std::numeric_limits<float>::infinity());

    HWY_INLINE void extend(const Corners& c)
    {
        lower = hn::Min(lower, c.lower);
        upper = hn::Max(upper, c.upper);
    }
    Box box() const
    {
        alignas(16) float lo[4], hi[4];
        hn::Store(lower, Four(), lo);
        hn::Store(upper, Four(), hi);
        return {vec3(lo[0], lo[1], lo[2]), vec3(hi[0], hi[1], hi[2])};
    }
};

inline Corners corners_of(const Box& box)
{
    alignas(16) const float lower[4] = {box.lower.x, box.lower.y, box.lower.z, 0.0f};
    alignas(16) const float upper[4] = {box.upper.x, box.upper.y, box.upper.z, 0.0f};
    return {hn::Load(Four(), lower), hn::Load(Four(), upper)};
}

HWY_INLINE Rows transpose(Vec p0, Vec p1, Vec p2, Vec p3)
{
    const Four d;
    const Vec a = hn::InterleaveLower(d, p0, p2), b = hn::InterleaveLower(d, p1, p3);
    const Vec z0 = hn::InterleaveUpper(d, p0, p2), z1 = hn::InterleaveUpper(d, p1, p3);
    return {hn::InterleaveLower(d, a, b), hn::InterleaveUpper(d, a, b), hn::InterleaveLower(d, z0, z1)};
}

// The smallest or largest x, y and z of the four.
template <class Choose>
HWY_INLINE Vec reduce(const Rows& r, Choose choose)
{
    const Four d;
    const Vec xz = choose(hn::InterleaveLower(d, r.x, r.z), hn::InterleaveUpper(d, r.x, r.z));
    const Vec yy = choose(hn::InterleaveLower(d, r.y, r.y), hn::InterleaveUpper(d, r.y, r.y));
    return choose(hn::InterleaveLower(d, xz, yy), hn::InterleaveUpper(d, xz, yy));
}

// The positions of a scene; there is at least one.
class Positions
{
  public:
    explicit Positions(const std::vector<vec3>& positions) : at_(positions.data()), last_(positions.size() - 1) {}

    HWY_INLINE Vec operator[](uint vertex) const
    {
        const float* p = &at_[vertex].x;
        if (HWY_LIKELY(vertex < last_)) return hn::LoadU(Four(), p); // reads into the next vertex
        alignas(16) const float three[4] = {p[0], p[1], p[2], 0.0f};
        return hn::Load(Four(), three);
    }

  private:
    const vec3* at_;
    std::size_t last_;
};

// Says again which vertex of which triangle is where in a block: for triangles whose corners have changed places.
inline void number_corners(const std::vector<Triangle>& triangles, TriangleBlock& block, uint (&numbers)[16])
{
    uint used = 0;
    for (uint v = 0; v < 3; ++v) block.corner[v] = 0;
    for (uint lane = 0; lane < max_leaf_size; ++lane) {
        const Triangle& triangle = triangles[block.id[lane]];
        const uint vertex[3] = {triangle.v0, triangle.v1, triangle.v2};
        for (uint v = 0; v < 3; ++v) {
            uint at = 0;
            while (at < used && numbers[at] != vertex[v]) ++at;
            SNELL_CHECK_LT(at, uint{block.capacity});
            if (at == used) numbers[used++] = vertex[v];
            block.corner[v] |= at << (4 * lane);
        }
    }
    for (uint i = used; i < 16; ++i) numbers[i] = numbers[0];
}

// x, y and z of four vertices go to their places in a block, and extend the box.
template <bool all_finite>
HWY_INLINE void put_four(const Rows& r, float* const (&to)[3], uint at, Rows& lower, Rows& upper)
{
    const Four d;
    if constexpr (all_finite) {
        hn::Store(r.x, d, to[0] + at);
        hn::Store(r.y, d, to[1] + at);
        hn::Store(r.z, d, to[2] + at);
        lower = {hn::Min(lower.x, r.x), hn::Min(lower.y, r.y), hn::Min(lower.z, r.z)};
        upper = {hn::Max(upper.x, r.x), hn::Max(upper.y, r.y), hn::Max(upper.z, r.z)};
        return;
    }
    const auto zero_if_finite = [](Vec v) { return hn::Sub(v, v); };
    const Vec zero = hn::Add(hn::Add(zero_if_finite(r.x), zero_if_finite(r.y)), zero_if_finite(r.z)); // else NaN
    const auto seen = hn::Eq(zero, hn::Zero(d));
    const Vec nan = hn::Set(d, std::numeric_limits<float>::quiet_NaN());
    hn::Store(hn::IfThenElse(seen, r.x, nan), d, to[0] + at);
    hn::Store(hn::IfThenElse(seen, r.y, nan), d, to[1] + at);
    hn::Store(hn::IfThenElse(seen, r.z, nan), d, to[2] + at);
    const auto low = [&](Vec v, Vec old) { return hn::IfThenElse(seen, hn::Min(v, old), old); };
    const auto high = [&](Vec v, Vec old) { return hn::IfThenElse(seen, hn::Max(v, old), old); };
    lower = {low(r.x, lower.x), low(r.y, lower.y), low(r.z, lower.z)};
    upper = {high(r.x, upper.x), high(r.y, upper.y), high(r.z, upper.z)};
}

// Reads the vertices of a block's triangles from the scene again; returns the box of those that are finite. The others
// become NaN, which no ray hits.
HWY_INLINE Corners refill(const std::vector<Triangle>& triangles, const Positions& positions, TriangleBlock& block)
{
    const Four d;
    const hn::RebindToUnsigned<Four> du;
    alignas(16) uint numbers[16]; // of the vertices, by place in the block
    for (uint i = 0; i < 16; i += 4) hn::Store(hn::Set(du, none), du, numbers + i);
    uint corner[3] = {block.corner[0], block.corner[1], block.corner[2]};
    bool agree = true;
    for (const uint id : block.id) { // unused ones repeat the first
        const Triangle& triangle = triangles[id];
        const uint vertex[3] = {triangle.v0, triangle.v1, triangle.v2};
        for (uint v = 0; v < 3; ++v) {
            uint& number = numbers[corner[v] & 15u];
            agree &= (number == none) | (number == vertex[v]);
            number = vertex[v];
            corner[v] >>= 4;
        }
    }
    if (HWY_UNLIKELY(!agree)) number_corners(triangles, block, numbers);

    const uint groups = block.capacity / 4u;
    Rows rows[4];
    Vec zero = hn::Zero(d); // NaN where a vertex is not finite
    for (uint g = 0; g < groups; ++g) {
        Vec p[4];
        for (uint k = 0; k < 4; ++k) {
            const uint number = numbers[4 * g + k];
            p[k] = positions[number != none ? number : numbers[0]];
        }
        rows[g] = transpose(p[0], p[1], p[2], p[3]);
        for (const Vec v : {rows[g].x, rows[g].y, rows[g].z}) zero = hn::Add(zero, hn::Sub(v, v));
    }
    const bool all_finite = hn::AllTrue(d, hn::Eq(zero, hn::Zero(d)));
    float* const to[3] = {block.axis(0), block.axis(1), block.axis(2)};
    const Corners empty;
    Rows lower = {empty.lower, empty.lower, empty.lower}, upper = {empty.upper, empty.upper, empty.upper};
    if (HWY_LIKELY(all_finite)) {
        for (uint g = 0; g < groups; ++g) put_four<true>(rows[g], to, 4 * g, lower, upper);
    } else {
        for (uint g = 0; g < groups; ++g) put_four<false>(rows[g], to, 4 * g, lower, upper);
    }
    const auto smaller = [](Vec a, Vec b) { return hn::Min(a, b); };
    const auto larger = [](Vec a, Vec b) { return hn::Max(a, b); };
    // Adding 0 turns -0 into +0, as builders do: min and max of the two depend on the order.
    return {hn::Add(reduce(lower, smaller), hn::Zero(d)), hn::Add(reduce(upper, larger), hn::Zero(d))};
}

} // namespace snell::lanes
