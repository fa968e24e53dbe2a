#include "snell/bvh/build.h"
#include "snell/bvh/linked_tree.h"
#include "snell/bvh/morton.h"
#include "snell/core/error.h"
#include "snell/core/parallel.h"

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>

namespace snell {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Lanes = hn::FixedTag<float, 4>;
using Codes = hn::RebindToUnsigned<Lanes>;

constexpr std::size_t radius = 10;       // how far along the curve a neighbour may be
constexpr std::size_t chunk_size = 4096; // of parallel passes
constexpr std::size_t lanes = 4;
// Rounds over more clusters than that must merge a sixteenth of them, so that the time stays in proportion. What costs
// less than a millisecond may take its time.
constexpr std::size_t few = 1024;

// The neighbour that a cluster wants is a number: the surface of the two together, less its last bits, which hold who
// it is as seen from the lower one of the two, `d` before the other: d - 1 and, in the last bit, `side`. Both of a pair
// see the same number. Among equal surfaces near ones come first, and of those at the same distance every other one:
// whole rows of equals pair up in one round. (With ties to the lower index such a row would merge a pair a round.)
constexpr std::uint32_t code_bits = 5, code_mask = (1u << code_bits) - 1, nobody = ~0u;
static_assert(2 * radius <= code_mask + 1);

// Differs between i and i - d, for any i.
constexpr std::uint32_t side(std::size_t i, std::size_t d)
{
    return static_cast<std::uint32_t>(i >> std::countr_zero(d)) & 1;
}

std::size_t partner(std::size_t i, std::uint32_t key)
{
    const std::size_t d = ((key & code_mask) >> 1) + 1;
    return side(i, d) == (key & 1) ? i + d : i - d;
}

// Subtrees that wait to be joined, in the order of the curve.
struct Clusters
{
    std::array<Scratch<float>, 6> planes; // lower x, y, z, upper x, y, z
    Scratch<std::uint32_t> node;

    explicit Clusters(std::size_t count) : node(count)
    {
        for (Scratch<float>& plane : planes) plane = Scratch<float>(count + lanes);
    }
    Box box(std::size_t i) const
    {
        return {vec3(planes[0][i], planes[1][i], planes[2][i]), vec3(planes[3][i], planes[4][i], planes[5][i])};
    }
    void set(std::size_t i, const Box& box, std::uint32_t id)
    {
        for (int axis = 0; axis < 3; ++axis) {
            planes[static_cast<std::size_t>(axis)][i] = box.lower[axis];
            planes[static_cast<std::size_t>(axis) + 3][i] = box.upper[axis];
        }
        node[i] = id;
    }
};

template <class Body>
void for_chunks(std::size_t count, const Body& body)
{
    const std::size_t chunks = (count + chunk_size - 1) / chunk_size;
    const auto run = [&](std::size_t chunk) {
        body(chunk, chunk * chunk_size, std::min(count, (chunk + 1) * chunk_size));
    };
    if (chunks == 1)
        run(0); // most rounds: the last ones
    else
        parallel_for(chunks, run);
}

class Builder
{
  public:
    explicit Builder(std::span<const PrimitiveRef> primitives)
        : refs(primitives), nodes(2 * refs.size() - 1), order(refs.size()), now(refs.size()), next(refs.size()),
          wanted(refs.size())
    {
    }

    BinaryTree run()
    {
        const MortonOrder curve = sort_by_morton(refs);
        if (curve.is_wide())
            make_leaves([&](std::size_t i) { return std::size_t{curve.wide[i].index}; });
        else
            make_leaves([&](std::size_t i) {
                return static_cast<std::size_t>(curve.packed[i] & ((std::uint64_t{1} << curve.index_bits) - 1));
            });
        std::size_t used = refs.size();
        for (std::size_t count = refs.size(); count > 1;) {
            for_chunks(count, [&](std::size_t, std::size_t begin, std::size_t end) { choose(begin, end, count); });
            std::size_t merged = count_places(count);
            if (count > few && merged < count / 16) {
                pair_up(count);
                merged = count_places(count);
            }
            SNELL_CHECK_LT(std::size_t{0}, merged);
            for_chunks(count, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
                merge(begin, end, places[chunk], used);
            });
            std::swap(now, next);
            used += merged;
            count -= merged;
        }
        SNELL_CHECK_EQ(used, nodes.size());
        return make_depth_first(nodes, static_cast<uint>(used - 1), order);
    }

  private:
    // Where a chunk writes to: how many clusters and new nodes come from the chunks before it.
    struct Place
    {
        std::size_t clusters = 0, nodes = 0;
    };

    std::span<const PrimitiveRef> refs;
    Scratch<LinkedNode> nodes;
    Scratch<BinaryTree::Entry> order;
    Clusters now, next;
    Scratch<std::uint32_t> wanted;
    std::vector<Place> places;

    template <class Index>
    void make_leaves(const Index& index)
    {
        for_chunks(refs.size(), [&](std::size_t, std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                const PrimitiveRef& ref = refs[index(i)];
                const Box box{ref.lower, ref.upper};
                const uint id = static_cast<uint>(i);
                nodes[i] = {box, id, 0, 1};
                order[i] = {ref.index, ref.kind};
                now.set(i, box, id);
            }
        });
    }

    // The best neighbours of the clusters in [begin, end).
    void choose(std::size_t begin, std::size_t end, std::size_t count)
    {
        // Each pair is looked at once, for both; a few beyond the ends are looked at again by the next chunk.
        const std::size_t first = begin - std::min(begin, radius);
        std::array<std::uint32_t, chunk_size + 2 * radius + lanes> best;
        const std::size_t width = std::min(end + radius, count) - first;
        std::fill_n(best.begin(), width, nobody);
        for (std::size_t d = 1; d <= std::min(radius, count - 1); ++d) {
            const std::size_t stop = std::min(end, count - d);
            std::size_t i = first;
            for (; i + lanes <= stop; i += lanes) {
                const auto key = keys(i, d);
                std::uint32_t *lower = &best[i - first], *upper = lower + d;
                hn::StoreU(hn::Min(hn::LoadU(Codes(), lower), key), Codes(), lower);
                hn::StoreU(hn::Min(hn::LoadU(Codes(), upper), key), Codes(), upper);
            }
            if (i < stop) {
                alignas(16) std::uint32_t key[lanes];
                hn::Store(keys(i, d), Codes(), key);
                for (std::size_t lane = 0; i < stop; ++i, ++lane) {
                    best[i - first] = std::min(best[i - first], key[lane]);
                    best[i - first + d] = std::min(best[i - first + d], key[lane]);
                }
            }
        }
        std::copy_n(best.begin() + (begin - first), end - begin, wanted.data() + begin);
    }

    // What the clusters i, i + 1 ... have in common with those d after them.
    hn::Vec<Codes> keys(std::size_t i, std::size_t d) const
    {
        hn::Vec<Lanes> e[3];
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const float *lower = now.planes[axis].data() + i, *upper = now.planes[axis + 3].data() + i;
            e[axis] = hn::Sub(hn::Max(hn::LoadU(Lanes(), upper), hn::LoadU(Lanes(), upper + d)),
                              hn::Min(hn::LoadU(Lanes(), lower), hn::LoadU(Lanes(), lower + d)));
        }
        // Not negative; the sign bit goes, for the NaN of an overflow may have one.
        const auto area = hn::Add(hn::Mul(e[0], hn::Add(e[1], e[2])), hn::Mul(e[1], e[2]));
        const auto index = hn::Iota(Codes(), static_cast<std::uint32_t>(i));
        const auto sides = hn::And(hn::ShiftRightSame(index, std::countr_zero(d)), hn::Set(Codes(), 1));
        const auto who = hn::Or(sides, hn::Set(Codes(), static_cast<std::uint32_t>((d - 1) << 1)));
        return hn::Or(hn::And(hn::BitCast(Codes(), area), hn::Set(Codes(), 0x7fffffffu & ~code_mask)), who);
    }

    // Merges neighbours whatever it costs: surfaces that grow along the curve leave one agreeing pair among many.
    void pair_up(std::size_t count)
    {
        for (std::size_t i = 0; i < count; ++i) wanted[i] = 0;
        if (count % 2 == 1) wanted[count - 1] = nobody;
    }

    // The cluster that i is joined with: both want each other. Itself: it stays alone.
    std::size_t agreed(std::size_t i) const
    {
        const std::uint32_t key = wanted[i];
        if (key == nobody) return i;
        const std::size_t other = partner(i, key);
        return wanted[other] == key ? other : i;
    }

    // Fills `places` and returns how many pairs agree.
    std::size_t count_places(std::size_t count)
    {
        places.assign((count + chunk_size - 1) / chunk_size, {});
        for_chunks(count, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
            Place place;
            for (std::size_t i = begin; i < end; ++i) {
                const std::size_t other = agreed(i);
                place.clusters += other >= i;
                place.nodes += other > i;
            }
            places[chunk] = place;
        });
        Place sum;
        for (Place& place : places) {
            const Place own = std::exchange(place, sum);
            sum.clusters += own.clusters;
            sum.nodes += own.nodes;
        }
        return sum.nodes;
    }

    void merge(std::size_t begin, std::size_t end, Place place, std::size_t used)
    {
        for (std::size_t i = begin; i < end; ++i) {
            const std::size_t other = agreed(i);
            if (other < i) continue;
            Box box = now.box(i);
            std::uint32_t id = now.node[i];
            if (other > i) {
                box.extend(now.box(other));
                const std::size_t made = used + place.nodes++;
                nodes[made] = {box, id, now.node[other], 0};
                id = static_cast<std::uint32_t>(made);
            }
            next.set(place.clusters++, box, id);
        }
    }
};

} // namespace

BinaryTree build_ploc(const PackedScene&, std::vector<PrimitiveRef> refs, const BuildOptions&)
{
    if (refs.empty()) return {};
    return Builder(refs).run();
}

} // namespace snell
