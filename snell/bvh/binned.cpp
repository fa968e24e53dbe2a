// Binned surface area heuristic: Wald 2007, On fast Construction of SAH-based Bounding Volume Hierarchies.
#include "snell/bvh/partition.h"
#include "snell/bvh/top_down.h"

#include <bit>

namespace snell {
namespace {

using Ints4 = hn::RebindToSigned<Lanes4>;
using IntVec4 = hn::Vec<Ints4>;

constexpr std::size_t max_bins = 48;
// Larger parts choose their split by a sample of so many references. That costs no quality: which plane of a few dozen
// is best is as plain from thousands as from millions.
constexpr std::size_t sample_size = 8192;

// Maps twice a primitive's centre to a bin on each axis.
struct Binning
{
    Vec4 origin, scale; // (centre - origin) * scale lies in [-1/2, bins - 1/2], and is rounded
    std::size_t bins;

    Binning(const WideBox& centre, std::size_t count)
    {
        // Few bins for few references: below, looking through bins takes as long as filling them.
        bins = std::min(max_bins, 8 + count / 8);
        const Lanes4 d;
        const Vec4 width = hn::Sub(centre.upper, centre.lower), zero = hn::Zero(d);
        const Vec4 number = hn::Set(d, static_cast<float>(bins));
        scale = hn::Div(number, width);
        // A width of 0, or one that overflows: all in bin 0.
        const auto possible = hn::And(hn::Gt(width, zero), hn::And(hn::IsFinite(width), hn::IsFinite(scale)));
        scale = hn::IfThenElse(possible, scale, zero);
        origin = hn::Add(centre.lower, hn::Div(width, hn::Add(number, number)));
    }

    // Added to a small number it leaves the nearest integer in the low bits: cheaper than a conversion that minds
    // overflow.
    static constexpr float round = 0x1.8p23f;

    // Bins on the three axes; the fourth number means nothing.
    void find(Vec4 centre, std::uint32_t (&bin)[4]) const
    {
        const Lanes4 d;
        const hn::RebindToUnsigned<Lanes4> du;
        const Vec4 x = hn::Mul(hn::Sub(centre, origin), scale);
        const Vec4 inside = hn::Min(hn::Max(x, hn::Zero(d)), hn::Set(d, static_cast<float>(bins - 1)));
        static_assert(max_bins <= 128);
        const auto bits = hn::And(hn::BitCast(du, hn::Add(inside, hn::Set(d, round))), hn::Set(du, 127));
        hn::Store(bits, du, bin);
    }
};

// What find() says of one axis, as a comparison: is the bin less than `bin`? The same roundings, so the same answer.
struct IsBelow
{
    int axis;
    float origin, scale, limit;

    IsBelow(const Binning& binning, int on_axis, std::uint32_t bin)
        : axis(on_axis), limit(Binning::round + static_cast<float>(bin))
    {
        alignas(16) float origins[4], scales[4];
        hn::Store(binning.origin, Lanes4(), origins);
        hn::Store(binning.scale, Lanes4(), scales);
        origin = origins[axis], scale = scales[axis];
    }
    bool operator()(const PrimitiveRef& ref) const
    {
        return (centre2(ref, axis) - origin) * scale + Binning::round < limit;
    }
};

// A box and how many are in it. The count is in the fourth lane of `upper`: the bits of 1.0f plus so many, which
// maximum leaves alone, for a reference has 0 there.
struct alignas(16) Bin
{
    float lower[4], upper[4];

    static constexpr std::uint32_t no_count = 0x3f800000u;
    static_assert(std::bit_cast<std::uint32_t>(1.0f) == no_count);

    static WideBox empty()
    {
        WideBox box;
        alignas(16) float upper[4];
        hn::Store(box.upper, Lanes4(), upper);
        upper[3] = 1.0f;
        box.upper = hn::Load(Lanes4(), upper);
        return box;
    }
    WideBox load() const { return {hn::Load(Lanes4(), lower), hn::Load(Lanes4(), upper)}; }
    void store(const WideBox& box)
    {
        hn::Store(box.lower, Lanes4(), lower);
        hn::Store(box.upper, Lanes4(), upper);
    }
    void add(Vec4 lo, Vec4 hi)
    {
        const hn::RebindToUnsigned<Lanes4> du;
        alignas(16) static constexpr std::uint32_t one[4] = {0, 0, 0, 1};
        WideBox box = load();
        box.extend(lo, hi);
        box.upper = hn::BitCast(Lanes4(), hn::Add(hn::BitCast(du, box.upper), hn::Load(du, one)));
        store(box);
    }
};

struct Histogram
{
    Bin axes[3][max_bins];

    // Only as many bins as are needed are made empty.
    explicit Histogram(std::size_t bins)
    {
        const WideBox empty = Bin::empty();
        for (auto& axis : axes)
            for (std::size_t i = 0; i < bins; ++i) axis[i].store(empty);
    }

    void add(const PrimitiveRef& ref, const Binning& binning)
    {
        const Vec4 lo = load3(ref.lower), hi = load3(ref.upper);
        alignas(16) std::uint32_t bin[4];
        binning.find(hn::Add(lo, hi), bin);
        for (std::size_t axis = 0; axis < 3; ++axis) axes[axis][bin[axis]].add(lo, hi);
    }
};

// Three boxes and their counts, each grown along its own axis. Fourth lanes mean nothing.
struct Growing
{
    WideBox boxes[3];
    IntVec4 counts = hn::Zero(Ints4());

    void extend(const Histogram& histogram, std::size_t bin)
    {
        const Lanes4 d;
        Vec4 upper[3];
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const WideBox box = histogram.axes[axis][bin].load();
            boxes[axis].extend(box);
            upper[axis] = box.upper;
        }
        const Vec4 two = hn::InterleaveUpper(d, upper[0], upper[1]); // z0 z1 count0 count1
        const Vec4 three = hn::ConcatUpperUpper(d, hn::Shuffle2301(upper[2]), two);
        counts = hn::Add(counts, hn::Sub(hn::BitCast(Ints4(), three), hn::Set(Ints4(), std::int32_t{Bin::no_count})));
    }

    // Half the surface times blocks, by axis. A NaN, which no comparison likes, where there is nothing: an empty box
    // has an infinite surface.
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
        static_assert(std::has_single_bit(max_leaf_size));
        constexpr int shift = std::countr_zero(max_leaf_size);
        const IntVec4 blocks = hn::ShiftRight<shift>(hn::Add(counts, hn::Set(Ints4(), max_leaf_size - 1)));
        return hn::Mul(area, hn::ConvertTo(d, blocks));
    }
};

struct Plane3
{
    int axis = -1;         // -1: no plane separates the centres
    std::uint32_t bin = 0; // the first one on the right
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
            split = {axis, static_cast<std::uint32_t>(bins[axis])};
    // Costs that overflow: any plane will do, and as the outermost bins hold something, the middle one separates.
    for (int axis = 0; axis < 3 && split.axis < 0; ++axis)
        if (scale[axis] > 0.0f) split = {axis, static_cast<std::uint32_t>(binning.bins / 2)};
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
        RefPartition::split(part, IsBelow(binning, plane.axis, plane.bin), left, right);
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
