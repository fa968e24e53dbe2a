#include "snell/bvh/sbvh_bins.h"

#include <utility>

namespace snell::sbvh {
namespace {

Vec load_vertex(const vec3& v)
{
    alignas(16) const float x[4] = {v.x, v.y, v.z, 0.0f};
    return hn::Load(Lanes(), x);
}

// A triangle whose vertices are sorted along an axis, for moving a plane through it.
struct Sweep
{
    Vec v[3], along, first, second; // edges 0 to 2, 0 to 1, 1 to 2
    float x[3];

    Sweep(const Vec (&vertices)[3], const vec3 (&points)[3], int axis)
    {
        int a = 0, b = 1, c = 2;
        if (points[a][axis] > points[b][axis]) std::swap(a, b);
        if (points[b][axis] > points[c][axis]) std::swap(b, c);
        if (points[a][axis] > points[b][axis]) std::swap(a, b);
        v[0] = vertices[a], v[1] = vertices[b], v[2] = vertices[c];
        x[0] = points[a][axis], x[1] = points[b][axis], x[2] = points[c][axis];
        along = hn::Sub(v[2], v[0]);
        first = hn::Sub(v[1], v[0]);
        second = hn::Sub(v[2], v[1]);
    }
    static Vec point(Vec from, Vec edge, float distance, float length)
    {
        const float t = length > 0.0f ? std::min(std::max(distance / length, 0.0f), 1.0f) : 0.0f;
        return hn::MulAdd(edge, hn::Set(Lanes(), t), from);
    }
    // What lies in the plane.
    WideBox at(float plane) const
    {
        const Vec p = point(v[0], along, plane - x[0], x[2] - x[0]);
        const Vec q = plane < x[1] ? point(v[0], first, plane - x[0], x[1] - x[0])
                                   : point(v[1], second, plane - x[1], x[2] - x[1]);
        return {hn::Min(p, q), hn::Max(p, q)};
    }
};

} // namespace

void add_chopped(SpatialBins& histogram, const PackedScene& scene, std::span<const PrimitiveRef> refs,
                 const Slabs& slabs)
{
    for (const PrimitiveRef& ref : refs) {
        alignas(16) std::int32_t first[4], last[4];
        const Vec lo = load3(ref.lower), hi = load3(ref.upper);
        if (ref.kind == RefKind::triangle) {
            slabs.find(lo, first);
            slabs.find(hi, last);
        } else { // goes to one side as a whole, so it counts where its centre is
            slabs.find(hn::Mul(hn::Add(lo, hi), hn::Set(Lanes(), 0.5f)), first);
            std::copy_n(first, 4, last);
        }
        bool loaded = false;
        vec3 points[3];
        Vec vertices[3];
        for (int axis = 0; axis < 3; ++axis) {
            auto& row = histogram.axes[static_cast<std::size_t>(axis)];
            const auto begin = static_cast<uint>(first[axis]), end = static_cast<uint>(last[axis]);
            ++row[begin].entering;
            ++row[end].leaving;
            if (begin == end) {
                row[begin].box.extend(lo, hi);
                continue;
            }
            if (!loaded) {
                const Triangle& tri = scene.triangles[ref.index];
                const uint corners[3] = {tri.v0, tri.v1, tri.v2};
                for (int i = 0; i < 3; ++i) {
                    points[i] = scene.positions[corners[i]];
                    vertices[i] = load_vertex(points[i]);
                }
                loaded = true;
            }
            const Sweep sweep(vertices, points, axis);
            float plane = ref.lower[axis];
            WideBox section = sweep.at(plane);
            for (uint bin = begin; bin <= end; ++bin) {
                const float next = bin < end ? slabs.plane(axis, bin + 1) : ref.upper[axis];
                const WideBox next_section = sweep.at(next);
                WideBox part = section;
                part.extend(next_section);
                if (sweep.x[1] >= plane && sweep.x[1] <= next) part.extend(sweep.v[1], sweep.v[1]);
                // An earlier cut may have taken all of this slab's part: then lower exceeds upper.
                part = {hn::Max(part.lower, lo), hn::Min(part.upper, hi)};
                if (hn::AllTrue(Lanes(), hn::Le(part.lower, part.upper))) row[bin].box.extend(part);
                section = next_section;
                plane = next;
            }
        }
    }
}

} // namespace snell::sbvh
