#include "snell/bvh/sbvh_bins.h"

#include <optional>

namespace snell::sbvh {
namespace {

struct Points
{
    alignas(16) float at[3][4]; // the fourth numbers are 0

    Points(const PackedScene& scene, uint index)
    {
        const Triangle& tri = scene.triangles[index];
        const uint corners[3] = {tri.v0, tri.v1, tri.v2};
        for (int i = 0; i < 3; ++i) {
            const vec3& p = scene.positions[corners[i]];
            at[i][0] = p.x, at[i][1] = p.y, at[i][2] = p.z, at[i][3] = 0.0f;
        }
    }
};

// A triangle whose vertices are sorted along an axis, for moving a plane through it. Without branches where they could
// not be foreseen.
struct Sweep
{
    Vec4 low, middle, high;
    float x[3], longest, shorter[2]; // places on the axis; reciprocals of the edges' extents
    Vec4 edge, parts[2], from[2];    // low to high; low to middle and middle to high, and where these begin

    Sweep(const Points& points, int axis)
    {
        const float y[3] = {points.at[0][axis], points.at[1][axis], points.at[2][axis]};
        int a = y[1] < y[0] ? 1 : 0, c = 1 - a;
        a = y[2] < y[a] ? 2 : a;
        c = y[2] >= y[c] ? 2 : c;
        const int b = 3 - a - c;
        low = hn::Load(Lanes4(), points.at[a]);
        middle = hn::Load(Lanes4(), points.at[b]);
        high = hn::Load(Lanes4(), points.at[c]);
        x[0] = y[a], x[1] = y[b], x[2] = y[c];
        longest = 1.0f / (x[2] - x[0]);
        shorter[0] = 1.0f / (x[1] - x[0]);
        shorter[1] = 1.0f / (x[2] - x[1]);
        edge = hn::Sub(high, low);
        parts[0] = hn::Sub(middle, low);
        parts[1] = hn::Sub(high, middle);
        from[0] = low, from[1] = middle;
    }
    // An edge without extent gives its beginning: the NaN that 0 / 0 is does not survive max().
    static Vec4 point(Vec4 begin, Vec4 along, float t)
    {
        return hn::MulAdd(along, hn::Set(Lanes4(), std::min(std::max(0.0f, t), 1.0f)), begin);
    }
    // What lies in the plane.
    WideBox at(float plane) const
    {
        const int part = plane < x[1] ? 0 : 1;
        const Vec4 p = point(low, edge, (plane - x[0]) * longest);
        const Vec4 q = point(from[part], parts[part], (plane - x[part]) * shorter[part]);
        return {hn::Min(p, q), hn::Max(p, q)};
    }
};

void chop(SpatialBins& histogram, const Slabs& slabs, const Sweep& sweep, int axis, const PrimitiveRef& ref, uint begin,
          uint end)
{
    auto& row = histogram.axes[static_cast<std::size_t>(axis)];
    const Vec4 lo = load3(ref.lower), hi = load3(ref.upper);
    float plane = ref.lower[axis];
    WideBox section = {sweep.low, sweep.low};
    if (plane > sweep.x[0]) section = sweep.at(plane); // was cut before
    for (uint bin = begin; bin <= end; ++bin) {
        const float next = bin < end ? slabs.plane(axis, bin + 1) : ref.upper[axis];
        const WideBox next_section = next < sweep.x[2] ? sweep.at(next) : WideBox{sweep.high, sweep.high};
        WideBox part = section;
        part.extend(next_section);
        if (sweep.x[1] >= plane && sweep.x[1] <= next) part.extend(sweep.middle, sweep.middle);
        // An earlier cut may have taken all of this slab's part: then lower exceeds upper.
        part = {hn::Max(part.lower, lo), hn::Min(part.upper, hi)};
        if (hn::AllTrue(Lanes4(), hn::Le(part.lower, part.upper))) row[bin].extend(part);
        section = next_section;
        plane = next;
    }
}

} // namespace

void add_chopped(SpatialBins& histogram, const PackedScene& scene, std::span<const PrimitiveRef> refs,
                 const Slabs& slabs, std::size_t stride)
{
    for (std::size_t number = 0; number < refs.size(); number += stride) {
        const PrimitiveRef& ref = refs[number];
        alignas(16) std::int32_t first[4], last[4];
        const Vec4 lo = load3(ref.lower), hi = load3(ref.upper);
        if (ref.kind == RefKind::triangle) {
            slabs.find(lo, first);
            slabs.find(hi, last);
        } else { // goes to one side as a whole, so it counts where its centre is
            slabs.find(hn::Mul(hn::Add(lo, hi), hn::Set(Lanes4(), 0.5f)), first);
            std::copy_n(first, 4, last);
        }
        std::optional<Points> points;
        for (int axis = 0; axis < 3; ++axis) {
            if (!slabs.possible[axis]) continue;
            auto& row = histogram.axes[static_cast<std::size_t>(axis)];
            const auto begin = static_cast<uint>(first[axis]), end = static_cast<uint>(last[axis]);
            ++row[begin].entering;
            ++row[end].leaving;
            if (begin == end) {
                row[begin].extend({lo, hi});
            } else {
                if (!points) points.emplace(scene, ref.index);
                chop(histogram, slabs, Sweep(*points, axis), axis, ref, begin, end);
            }
        }
    }
}

} // namespace snell::sbvh
