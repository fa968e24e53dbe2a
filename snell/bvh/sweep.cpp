// Full-sweep surface area heuristic: Wald and Havran 2006, On building fast kd-Trees for Ray Tracing, and on doing that
// in O(N log N), for trees of boxes: sorted once along each axis, and kept sorted by stable partitions.
#include "snell/bvh/extents.h"
#include "snell/bvh/top_down.h"

#include <algorithm>
#include <array>
#include <bit>

namespace snell {
namespace {

// Floats as integers of the same order.
std::uint32_t sortable(float x)
{
    const auto bits = std::bit_cast<std::uint32_t>(x);
    return bits ^ ((bits >> 31) != 0 ? ~0u : 0x80000000u);
}

double half_area(const WideBox& wide)
{
    return wide.box().half_area();
}

double blocks(std::size_t count)
{
    return static_cast<double>(count) / max_leaf_size;
}

class SweepSplitter
{
  public:
    // The references of a part are those whose numbers stand at its positions, of each axis' list.
    struct Part
    {
        std::size_t begin = 0, end = 0;
        WideBox box;
    };

    explicit SweepSplitter(std::vector<PrimitiveRef> primitives)
        : refs(std::move(primitives)), costs(refs.size()), scratch(refs.size()), is_left(refs.size())
    {
        parallel_for(3, [&](std::size_t axis) { sort(static_cast<int>(axis)); });
    }

    Part whole() const
    {
        Part part{0, refs.size(), {}};
        for (const PrimitiveRef& ref : refs) part.box.extend(load3(ref.lower), load3(ref.upper));
        return part;
    }

    static Box box(const Part& part) { return part.box.box(); }

    BinaryTree::Entry entry(const Part&, std::size_t position) const
    {
        const PrimitiveRef& ref = refs[lists[0][position]];
        return {ref.index, ref.kind};
    }

    void split(const Part& part, bool halve, Part& left, Part& right)
    {
        Choice best{0, part.begin + (part.end - part.begin) / 2, std::numeric_limits<double>::infinity()};
        for (std::size_t axis = 0; axis < 3 && !halve; ++axis) sweep(part, axis, best);

        const auto& list = lists[best.axis];
        left = {part.begin, best.middle, {}};
        right = {best.middle, part.end, {}};
        for (std::size_t i = part.begin; i < part.end; ++i) {
            const PrimitiveRef& ref = refs[list[i]];
            is_left[list[i]] = i < best.middle ? 1 : 0;
            (i < best.middle ? left : right).box.extend(load3(ref.lower), load3(ref.upper));
        }
        for (std::size_t axis = 0; axis < 3; ++axis)
            if (axis != best.axis) partition(part, axis);
    }

  private:
    struct Choice
    {
        std::size_t axis, middle; // the first position on the right
        double cost;
    };

    std::vector<PrimitiveRef> refs;
    std::array<std::vector<uint>, 3> lists; // numbers of references, sorted along an axis
    // By position, for the part that is at work there.
    std::vector<double> costs;
    std::vector<uint> scratch;
    std::vector<std::uint8_t> is_left; // by reference

    void sort(int axis)
    {
        std::vector<std::uint64_t> keys(refs.size()); // ties by number
        for (std::size_t i = 0; i < refs.size(); ++i)
            keys[i] = std::uint64_t{sortable(centre2(refs[i], axis))} << 32 | i;
        std::sort(keys.begin(), keys.end());
        std::vector<uint>& list = lists[static_cast<std::size_t>(axis)];
        list.resize(refs.size());
        for (std::size_t i = 0; i < refs.size(); ++i) list[i] = static_cast<uint>(keys[i]);
    }

    // Costs in double: they order splits of any size without overflow.
    void sweep(const Part& part, std::size_t axis, Choice& best)
    {
        const std::vector<uint>& list = lists[axis];
        WideBox box;
        for (std::size_t i = part.end - 1; i > part.begin; --i) {
            box.extend(load3(refs[list[i]].lower), load3(refs[list[i]].upper));
            costs[i] = half_area(box) * blocks(part.end - i);
        }
        box = WideBox();
        for (std::size_t i = part.begin + 1; i < part.end; ++i) {
            box.extend(load3(refs[list[i - 1]].lower), load3(refs[list[i - 1]].upper));
            const double cost = half_area(box) * blocks(i - part.begin) + costs[i];
            if (cost < best.cost) best = {axis, i, cost};
        }
    }

    // Those on the left first, each side in its old order.
    void partition(const Part& part, std::size_t axis)
    {
        std::vector<uint>& list = lists[axis];
        std::size_t left = part.begin, right = part.begin;
        for (std::size_t i = part.begin; i < part.end; ++i) {
            const uint ref = list[i];
            if (is_left[ref])
                list[left++] = ref;
            else
                scratch[right++] = ref;
        }
        std::copy(scratch.begin() + static_cast<std::ptrdiff_t>(part.begin),
                  scratch.begin() + static_cast<std::ptrdiff_t>(right),
                  list.begin() + static_cast<std::ptrdiff_t>(left));
    }
};

} // namespace

BinaryTree build_sweep_sah(const PackedScene&, std::vector<PrimitiveRef> refs, const BuildOptions&)
{
    const std::size_t count = refs.size();
    if (count == 0) return {};
    SweepSplitter splitter(std::move(refs));
    return TopDown(splitter).run(count);
}

} // namespace snell
