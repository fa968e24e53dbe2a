// Binned surface area heuristic: Wald 2007, On fast Construction of SAH-based Bounding Volume Hierarchies.
#include "snell/bvh/partition.h"
#include "snell/bvh/top_down.h"

namespace snell {
namespace {

using Ints4 = hn::RebindToSigned<Lanes4>;
using IntVec4 = hn::Vec<Ints4>;

constexpr std::size_t max_bins = 32;
// Larger parts choose their split by a sample of so many references. That costs no quality: which of 32 planes is best
// is as plain from thousands as from millions.
constexpr std::size_t sample_size = 4096;

// Maps twice a primitive's centre to a bin on each axis.
struct Binning
{
    Vec4 origin, scale;
    std::size_t bins;

    Binning(const WideBox& centre, std::size_t count) : origin(centre.lower)
    {
        // Few bins for few references: below, looking through bins takes as long as filling them.
        bins = std::min(max_bins, 4 + count / 8);
        const Vec4 width = hn::Sub(centre.upper, centre.lower), zero = hn::Zero(Lanes4());
        scale = hn::Div(hn::Set(Lanes4(), 0.99999f * static_cast<float>(bins)), width);
        // A width of 0, or one that overflows: all in bin 0.
        const auto possible = hn::And(hn::Gt(width, zero), hn::And(hn::IsFinite(width), hn::IsFinite(scale)));
        scale = hn::IfThenElse(possible, scale, zero);
    }

    // Bins on the three axes; the fourth number is 0.
    IntVec4 find(const PrimitiveRef& ref) const
    {
        const Ints4 di;
        const auto index = hn::ConvertTo(di, hn::Mul(hn::Sub(centre2(ref), origin), scale));
        const auto top = hn::Set(di, static_cast<std::int32_t>(bins) - 1);
        return hn::Max(hn::Min(index, top), hn::Zero(di));
    }
};

struct Histogram
{
    alignas(16) float lower[max_bins][3][4], upper[max_bins][3][4];
    alignas(16) std::int32_t counts[max_bins][4]; // by axis

    // Only as many bins as are needed are made empty.
    explicit Histogram(std::size_t bins)
    {
        const WideBox empty;
        for (std::size_t i = 0; i < bins; ++i) {
            for (std::size_t axis = 0; axis < 3; ++axis) store(i, axis, empty);
            hn::Store(hn::Zero(Ints4()), Ints4(), counts[i]);
        }
    }

    WideBox load(std::size_t bin, std::size_t axis) const
    {
        return {hn::Load(Lanes4(), lower[bin][axis]), hn::Load(Lanes4(), upper[bin][axis])};
    }
    void store(std::size_t bin, std::size_t axis, const WideBox& box)
    {
        hn::Store(box.lower, Lanes4(), lower[bin][axis]);
        hn::Store(box.upper, Lanes4(), upper[bin][axis]);
    }

    void add(const PrimitiveRef& ref, const Binning& binning)
    {
        alignas(16) std::int32_t bin[4];
        hn::Store(binning.find(ref), Ints4(), bin);
        const Vec4 lo = load3(ref.lower), hi = load3(ref.upper);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const auto i = static_cast<std::size_t>(bin[axis]);
            WideBox box = load(i, axis);
            box.extend(lo, hi);
            store(i, axis, box);
            ++counts[i][axis];
        }
    }
};

// Three boxes and their counts, each grown along its own axis.
struct Growing
{
    WideBox boxes[3];
    IntVec4 counts = hn::Zero(Ints4());

    void extend(const Histogram& histogram, std::size_t bin)
    {
        for (std::size_t axis = 0; axis < 3; ++axis) boxes[axis].extend(histogram.load(bin, axis));
        counts = hn::Add(counts, hn::Load(Ints4(), histogram.counts[bin]));
    }

    // Half the surface times blocks, by axis. A NaN, which no comparison likes, where there is nothing (the surface of
    // an empty box is infinite) and in the fourth lane.
    Vec4 cost() const
    {
        const Lanes4 d;
        Vec4 e[3];
        for (std::size_t axis = 0; axis < 3; ++axis) e[axis] = hn::Sub(boxes[axis].upper, boxes[axis].lower);
        const Vec4 low = hn::InterleaveLower(d, e[0], e[1]);  // x0 x1 y0 y1
        const Vec4 high = hn::InterleaveUpper(d, e[0], e[1]); // z0 z1
        const Vec4 x = hn::ConcatLowerLower(d, e[2], low);
        const Vec4 y = hn::ConcatLowerUpper(d, hn::Shuffle2301(e[2]), low);
        const Vec4 z = hn::ConcatUpperLower(d, e[2], high);
        const Vec4 area = hn::Add(hn::Mul(x, hn::Add(y, z)), hn::Mul(y, z));
        static_assert(max_leaf_size == 4);
        const IntVec4 blocks = hn::ShiftRight<2>(hn::Add(counts, hn::Set(Ints4(), 3)));
        const Vec4 nothing = hn::Set(d, std::numeric_limits<float>::quiet_NaN());
        const auto some = hn::RebindMask(d, hn::Gt(counts, hn::Zero(Ints4())));
        return hn::IfThenElse(some, hn::Mul(area, hn::ConvertTo(d, blocks)), nothing);
    }
};

struct Plane3
{
    int axis = -1;        // -1: no plane separates the centres
    std::int32_t bin = 0; // the first one on the right
};

Plane3 best_split(const Histogram& histogram, const Binning& binning)
{
    const Lanes4 d;
    Vec4 right_cost[max_bins];
    Growing right;
    for (std::size_t i = binning.bins - 1; i > 0; --i) {
        right.extend(histogram, i);
        right_cost[i] = right.cost();
    }
    Growing left;
    Vec4 best = hn::Set(d, std::numeric_limits<float>::infinity());
    Vec4 best_bin = hn::Zero(d);
    for (std::size_t i = 1; i < binning.bins; ++i) {
        left.extend(histogram, i - 1);
        const Vec4 cost = hn::Add(left.cost(), right_cost[i]);
        const auto better = hn::Lt(cost, best);
        best = hn::IfThenElse(better, cost, best);
        best_bin = hn::IfThenElse(better, hn::Set(d, static_cast<float>(i)), best_bin);
    }
    alignas(16) float costs[4], bins[4], scale[4];
    hn::Store(best, d, costs);
    hn::Store(best_bin, d, bins);
    hn::Store(binning.scale, d, scale);
    Plane3 split;
    for (int axis = 0; axis < 3; ++axis)
        if (bins[axis] > 0.0f && (split.axis < 0 || costs[axis] < costs[split.axis]))
            split = {axis, static_cast<std::int32_t>(bins[axis])};
    // Costs that overflow: any plane will do, and as the outermost bins hold something, the middle one separates.
    for (int axis = 0; axis < 3 && split.axis < 0; ++axis)
        if (scale[axis] > 0.0f) split = {axis, static_cast<std::int32_t>(binning.bins / 2)};
    return split;
}

class BinnedSplitter : public RefPartition
{
  public:
    using Part = RefPart;
    using RefPartition::RefPartition;

    void split(const Part& part, bool halve_it, Part& left, Part& right)
    {
        const std::size_t count = part.end - part.begin;
        const Binning binning(part.extents.centre, count);
        const Plane3 plane = halve_it ? Plane3() : best_split(fill(part, binning), binning);
        if (plane.axis < 0) return halve(part, left, right); // all centres in one place
        RefPartition::split(
            part,
            [&](const PrimitiveRef& ref) {
                alignas(16) std::int32_t bin[4];
                hn::Store(binning.find(ref), Ints4(), bin);
                return bin[plane.axis] < plane.bin;
            },
            left, right);
    }

  private:
    Histogram fill(const Part& part, const Binning& binning) const
    {
        Histogram histogram(binning.bins);
        const std::span<const PrimitiveRef> refs = range(part);
        if (refs.size() < 2 * sample_size) {
            for (const PrimitiveRef& ref : refs) histogram.add(ref, binning);
            return histogram;
        }
        // One from each of as many equal runs, not always the same place of it: meshes have rhythm.
        const std::size_t stride = refs.size() / sample_size;
        std::uint32_t hash = 0;
        for (std::size_t i = 0; i < sample_size; ++i) {
            hash = hash * 1664525u + 1013904223u;
            histogram.add(refs[i * stride + (hash >> 8) % stride], binning);
        }
        return histogram;
    }
};

} // namespace

BinaryTree build_binned_sah(const PackedScene&, std::vector<PrimitiveRef> refs, const BuildOptions&)
{
    const std::size_t count = refs.size();
    if (count == 0) return {};
    BinnedSplitter splitter(std::move(refs));
    return TopDown(splitter).run(count);
}

} // namespace snell
