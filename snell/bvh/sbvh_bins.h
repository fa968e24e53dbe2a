// What object and spatial splits of a set of references would cost, estimated over bins. For sbvh.cpp.
#pragma once

#include "snell/bvh/extents.h"
#include "snell/kernel/lang.h"
#include "snell/scene/packed.h"

#include <algorithm>
#include <array>
#include <span>

namespace snell::sbvh {

inline constexpr uint object_bins = 32;
inline constexpr uint spatial_bins = 16;

// Half the surface of a box that is not empty; infinite for an overflow, which only makes a split unattractive.
inline float half_area(const WideBox& box)
{
    alignas(16) float x[4];
    hn::Store(hn::Sub(box.upper, box.lower), Lanes4(), x);
    return x[0] * x[1] + x[1] * x[2] + x[2] * x[0];
}

inline float blocks(uint count)
{
    return static_cast<float>((count + max_leaf_size - 1) / max_leaf_size);
}

// Cuts each axis of a box into equal slabs.
struct Slabs
{
    Vec4 origin, scale;
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
        origin = hn::Load(Lanes4(), o);
        scale = hn::Load(Lanes4(), s);
    }
    // Slabs of a point on the three axes; the fourth number means nothing.
    void find(Vec4 point, std::int32_t (&slab)[4]) const
    {
        const hn::RebindToSigned<Lanes4> di;
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

// A box and how many references have it as their first bin, and as their last one. No value until cleared, for there
// are more of them than small sets need.
struct alignas(16) Bin
{
    float lower[4], upper[4];
    uint entering, leaving;

    void clear()
    {
        store({});
        entering = leaving = 0;
    }
    WideBox box() const { return {hn::Load(Lanes4(), lower), hn::Load(Lanes4(), upper)}; }
    void extend(const WideBox& other)
    {
        WideBox all = box();
        all.extend(other);
        store(all);
    }

  private:
    void store(const WideBox& box)
    {
        hn::Store(box.lower, Lanes4(), lower);
        hn::Store(box.upper, Lanes4(), upper);
    }
};

// Bins on three axes.
template <uint max_bins>
struct Histogram
{
    std::array<std::array<Bin, max_bins>, 3> axes;
    uint bins;

    explicit Histogram(uint count) : bins(count)
    {
        for (auto& axis : axes)
            for (uint i = 0; i < bins; ++i) axis[i].clear();
    }
    void add(const Histogram& other)
    {
        for (std::size_t axis = 0; axis < 3; ++axis)
            for (uint i = 0; i < bins; ++i) {
                Bin& bin = axes[axis][i];
                bin.extend(other.axes[axis][i].box());
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
        std::array<float, max_bins> right_cost;
        std::array<uint, max_bins> right_count;
        WideBox box;
        uint count = 0;
        for (uint i = bins - 1; i > 0; --i) {
            box.extend(row[i].box());
            count += row[i].leaving;
            right_cost[i] = half_area(box) * blocks(count);
            right_count[i] = count;
        }
        box = WideBox();
        count = 0;
        for (uint i = 1; i < bins; ++i) {
            box.extend(row[i - 1].box());
            count += row[i - 1].entering;
            if (count == 0 || right_count[i] == 0) continue;
            const float cost = half_area(box) * blocks(count) + right_cost[i];
            // Where areas overflow, cost may be a NaN. Any split is better than none.
            if (best.axis < 0 || cost < best.cost)
                best = {axis, i, cost < infinity() ? cost : infinity(), {}, {}, count, right_count[i]};
        }
    }
    if (best.axis >= 0) {
        const auto& row = axes[static_cast<std::size_t>(best.axis)];
        for (uint i = 0; i < bins; ++i) (i < best.bin ? best.left : best.right).extend(row[i].box());
    }
    return best;
}

using ObjectBins = Histogram<object_bins>;
using SpatialBins = Histogram<spatial_bins>;

inline void add_objects(ObjectBins& histogram, std::span<const PrimitiveRef> refs, const Slabs& slabs)
{
    for (const PrimitiveRef& ref : refs) {
        alignas(16) std::int32_t bin[4];
        const Vec4 lo = load3(ref.lower), hi = load3(ref.upper);
        slabs.find(hn::Add(lo, hi), bin);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            auto& b = histogram.axes[axis][static_cast<std::size_t>(bin[axis])];
            b.extend({lo, hi});
            ++b.entering;
            ++b.leaving;
        }
    }
}

// Chops triangles at the slabs' planes, on the axes that are possible; one of every `stride` references. To within
// rounding: it is the cut itself that must be exact.
void add_chopped(SpatialBins& histogram, const PackedScene& scene, std::span<const PrimitiveRef> refs,
                 const Slabs& slabs, std::size_t stride = 1);

} // namespace snell::sbvh
