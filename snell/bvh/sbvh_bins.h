// What object and spatial splits of a set of references would cost, estimated over bins. For sbvh.cpp.
#pragma once

#include "snell/bvh/tree.h"
#include "snell/kernel/lang.h"
#include "snell/scene/packed.h"

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <span>

namespace snell::sbvh {

namespace hn = hwy::HWY_NAMESPACE;
using Lanes = hn::FixedTag<float, 4>;
using Vec = hn::Vec<Lanes>;

inline constexpr uint object_bins = 32;
inline constexpr uint spatial_bins = 16;

// The fourth lane of a reference's half is an integer in disguise; it becomes 0, so that no arithmetic meets a denormal
// or a NaN.
inline Vec load3(const vec3& v)
{
    alignas(16) static constexpr uint mask[4] = {~0u, ~0u, ~0u, 0u};
    const hn::RebindToUnsigned<Lanes> du;
    return hn::And(hn::Load(Lanes(), &v.x), hn::BitCast(Lanes(), hn::Load(du, mask)));
}

// A box in registers; the fourth lane means nothing.
struct WideBox
{
    Vec lower = hn::Set(Lanes(), std::numeric_limits<float>::infinity());
    Vec upper = hn::Set(Lanes(), -std::numeric_limits<float>::infinity());

    void extend(Vec lo, Vec hi) { lower = hn::Min(lower, lo), upper = hn::Max(upper, hi); }
    void extend(const WideBox& b) { extend(b.lower, b.upper); }
    Box box() const
    {
        alignas(16) float lo[4], hi[4];
        hn::Store(lower, Lanes(), lo);
        hn::Store(upper, Lanes(), hi);
        return {vec3(lo[0], lo[1], lo[2]), vec3(hi[0], hi[1], hi[2])};
    }
    // Half the surface of a box that is not empty; infinite for an overflow, which only makes a split unattractive.
    float half_area() const
    {
        alignas(16) float x[4];
        hn::Store(hn::Sub(upper, lower), Lanes(), x);
        return x[0] * x[1] + x[1] * x[2] + x[2] * x[0];
    }
};

struct Extents
{
    WideBox box;       // of the references
    WideBox centroid;  // of twice their centres
    double weight = 0; // of their surfaces together

    void extend(const PrimitiveRef& ref)
    {
        const Vec lo = load3(ref.lower), hi = load3(ref.upper), c = hn::Add(lo, hi);
        box.extend(lo, hi);
        centroid.extend(c, c);
        weight += double(WideBox{lo, hi}.half_area());
    }
    void extend(const Extents& e)
    {
        box.extend(e.box);
        centroid.extend(e.centroid);
        weight += e.weight;
    }
};

inline float blocks(uint count)
{
    return static_cast<float>((count + max_leaf_size - 1) / max_leaf_size);
}

// Cuts each axis of a box into equal slabs.
struct Slabs
{
    Vec origin, scale;
    float start[3], width[3]; // of one slab
    uint bins;
    bool possible[3] = {};

    Slabs(const Box& box, uint count) : bins(count)
    {
        alignas(16) float o[4] = {}, s[4] = {};
        for (int axis = 0; axis < 3; ++axis) {
            const float extent = box.upper[axis] - box.lower[axis];
            start[axis] = o[axis] = box.lower[axis];
            width[axis] = extent / static_cast<float>(bins);
            s[axis] = 0.99999f * static_cast<float>(bins) / extent;
            possible[axis] = extent > 0.0f && is_finite(extent) && is_finite(s[axis]);
            if (!possible[axis]) s[axis] = 0.0f;
        }
        origin = hn::Load(Lanes(), o);
        scale = hn::Load(Lanes(), s);
    }
    // Slabs of a point on the three axes; the fourth number means nothing.
    void find(Vec point, std::int32_t (&slab)[4]) const
    {
        const hn::RebindToSigned<Lanes> di;
        const auto index = hn::ConvertTo(di, hn::Mul(hn::Sub(point, origin), scale));
        const auto top = hn::Set(di, static_cast<std::int32_t>(bins) - 1);
        hn::Store(hn::Max(hn::Min(index, top), hn::Zero(di)), di, slab);
    }
    // Where slab i begins.
    float plane(int axis, uint i) const { return start[axis] + width[axis] * static_cast<float>(i); }
};

// A way to cut a set in two, and what is known of the sides.
struct Split
{
    int axis = -1; // -1: there is none
    uint bin = 0;  // the first one on the right
    float cost = std::numeric_limits<float>::infinity();
    WideBox left, right;
    uint left_count = 0, right_count = 0;
};

// Bins on three axes. `leaving` and `entering` count the references whose last or first bin it is.
template <uint max_bins>
struct Histogram
{
    struct Bin
    {
        WideBox box;
        uint entering, leaving;
    };
    std::array<std::array<Bin, max_bins>, 3> axes;
    uint bins;

    explicit Histogram(uint count) : bins(count)
    {
        for (auto& axis : axes)
            for (uint i = 0; i < bins; ++i) axis[i] = {{}, 0, 0};
    }
    void add(const Histogram& other)
    {
        for (std::size_t axis = 0; axis < 3; ++axis)
            for (uint i = 0; i < bins; ++i) {
                Bin& bin = axes[axis][i];
                bin.box.extend(other.axes[axis][i].box);
                bin.entering += other.axes[axis][i].entering;
                bin.leaving += other.axes[axis][i].leaving;
            }
    }
    Split best(const bool (&possible)[3]) const;
};

template <uint max_bins>
Split Histogram<max_bins>::best(const bool (&possible)[3]) const
{
    Split best;
    for (int axis = 0; axis < 3; ++axis) {
        if (!possible[axis]) continue;
        const auto& row = axes[static_cast<std::size_t>(axis)];
        std::array<WideBox, max_bins> right;
        std::array<float, max_bins> right_cost;
        std::array<uint, max_bins> right_count;
        WideBox box;
        uint count = 0;
        for (uint i = bins - 1; i > 0; --i) {
            box.extend(row[i].box);
            count += row[i].leaving;
            right[i] = box;
            right_cost[i] = count > 0 ? box.half_area() * blocks(count) : 0.0f;
            right_count[i] = count;
        }
        box = WideBox();
        count = 0;
        for (uint i = 1; i < bins; ++i) {
            box.extend(row[i - 1].box);
            count += row[i - 1].entering;
            if (count == 0 || right_count[i] == 0) continue;
            const float cost = box.half_area() * blocks(count) + right_cost[i];
            if (best.axis < 0 || cost < best.cost) best = {axis, i, cost, box, right[i], count, right_count[i]};
        }
    }
    return best;
}

using ObjectBins = Histogram<object_bins>;
using SpatialBins = Histogram<spatial_bins>;

inline void add_objects(ObjectBins& histogram, std::span<const PrimitiveRef> refs, const Slabs& slabs)
{
    for (const PrimitiveRef& ref : refs) {
        alignas(16) std::int32_t bin[4];
        const Vec lo = load3(ref.lower), hi = load3(ref.upper);
        slabs.find(hn::Add(lo, hi), bin);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            auto& b = histogram.axes[axis][static_cast<std::size_t>(bin[axis])];
            b.box.extend(lo, hi);
            ++b.entering;
            ++b.leaving;
        }
    }
}

// Chops the triangles at the slabs' planes. To within rounding: it is the cut itself that must be exact.
// Only on axes that are possible. stride: takes every so many of the references.
void add_chopped(SpatialBins& histogram, const PackedScene& scene, std::span<const PrimitiveRef> refs,
                 const Slabs& slabs, std::size_t stride = 1);

} // namespace snell::sbvh
