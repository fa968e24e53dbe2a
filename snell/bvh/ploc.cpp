#include "snell/bvh/build.h"
#include "snell/bvh/linked_tree.h"
#include "snell/bvh/morton.h"
#include "snell/bvh/simd/neighbours.h"
#include "snell/core/error.h"
#include "snell/core/parallel.h"

#include <hwy/cache_control.h>

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

namespace snell {
namespace {

constexpr std::size_t chunk_size = 4096; // of parallel passes
// Looks at clusters that the rounds may take, in all and a primitive; usually they take 4. What costs less than a
// millisecond is free.
constexpr std::size_t free_looks = 1 << 16, looks_per_primitive = 16;
constexpr std::size_t ahead = 24; // references that are on their way from memory
constexpr std::uint32_t nothing = ~0u;

// Subtrees that wait to be joined, in the order of the curve.
class Clusters
{
  public:
    Scratch<std::uint32_t> node; // of a leaf: its first reference; Builder::after_ links the others to it

    explicit Clusters(std::size_t count) : node(count)
    {
        for (std::size_t i = 0; i < memory_.size(); ++i) {
            memory_[i] = Scratch<float>(count + 2 * cluster_margin);
            planes_[i] = memory_[i].data() + cluster_margin;
            std::fill_n(memory_[i].data(), cluster_margin, 0.0f);
        }
    }
    ClusterPlanes planes() const
    {
        ClusterPlanes planes;
        std::copy(planes_.begin(), planes_.end(), planes.begin());
        return planes;
    }
    Box box(std::size_t i) const
    {
        return {vec3(planes_[0][i], planes_[1][i], planes_[2][i]), vec3(planes_[3][i], planes_[4][i], planes_[5][i])};
    }
    // Entries of a leaf, 4 for an instance; more: an inner node.
    float size(std::size_t i) const { return planes_[6][i]; }
    bool is_leaf(std::size_t i) const { return size(i) <= float{max_leaf_size}; }

    void set(std::size_t i, const Box& box, float size, std::uint32_t id)
    {
        for (int axis = 0; axis < 3; ++axis) {
            planes_[static_cast<std::size_t>(axis)][i] = box.lower[axis];
            planes_[static_cast<std::size_t>(axis) + 3][i] = box.upper[axis];
        }
        planes_[6][i] = size;
        node[i] = id;
    }

  private:
    std::array<Scratch<float>, 7> memory_;
    std::array<float*, 7> planes_;
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
        : refs_(primitives), nodes_(2 * refs_.size() - 1), after_(refs_.size()), now_(refs_.size()),
          next_(refs_.size()), wanted_(refs_.size())
    {
    }

    BinaryTree run()
    {
        make_leaves();
        std::size_t count = refs_.size(), looks = free_looks + looks_per_primitive * refs_.size();
        while (count > 1) {
            if (looks >= count) {
                looks -= count;
                for_chunks(count, [&](std::size_t, std::size_t begin, std::size_t end) {
                    find_neighbours(now_.planes(), begin, end, count, wanted_.data());
                });
            } else {
                pair_up(count);
            }
            const Place sum = find_places(count);
            SNELL_CHECK_LT(sum.clusters, count);
            for_chunks(count, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
                merge(begin, end, places_[chunk]);
            });
            std::swap(now_, next_);
            count = sum.clusters;
            used_ = {0, sum.nodes, sum.entries};
        }
        const std::uint32_t root = finished(now_, 0, used_);
        return make_depth_first({nodes_.data(), used_.nodes}, root, {order_.data(), used_.entries});
    }

  private:
    // Where a chunk writes to.
    struct Place
    {
        std::size_t clusters = 0, nodes = 0, entries = 0;
    };

    std::span<const PrimitiveRef> refs_;
    bool one_kind_ = false;             // and not instances
    Scratch<LinkedNode> nodes_;         // of what has its final children
    Scratch<BinaryTree::Entry> order_;  // of leaves among them
    Scratch<BinaryTree::Entry> sorted_; // along the curve
    Scratch<std::uint32_t> after_;      // the next one in the same leaf, both by place on the curve
    Clusters now_, next_;
    Scratch<std::uint32_t> wanted_;
    std::vector<Place> places_;
    Place used_;

    void make_leaves()
    {
        const MortonOrder curve = sort_by_morton(refs_);
        one_kind_ = std::has_single_bit(curve.kinds) && curve.kinds != 1u << static_cast<uint>(RefKind::instance);
        order_ = Scratch<BinaryTree::Entry>(one_kind_ ? refs_.size() : max_leaf_size * refs_.size());
        sorted_ = Scratch<BinaryTree::Entry>(refs_.size());
        for_chunks(refs_.size(), [&](std::size_t, std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                hwy::Prefetch(&refs_[curve.index(std::min(i + ahead, refs_.size() - 1))]);
                const PrimitiveRef& ref = refs_[curve.index(i)];
                sorted_[i] = {ref.index, ref.kind};
                after_[i] = nothing;
                const float size = ref.kind == RefKind::instance ? float{max_leaf_size} : 1.0f;
                now_.set(i, {ref.lower, ref.upper}, size, static_cast<std::uint32_t>(i));
            }
        });
    }

    // Merges neighbours whatever it costs: where surfaces grow along the curve, only one pair a round would agree.
    void pair_up(std::size_t count)
    {
        std::fill_n(wanted_.data(), count, 0u); // 0 and 1, 2 and 3 ...
        if (count % 2 == 1) wanted_[count - 1] = no_neighbour;
    }

    // The cluster that i is joined with: both want each other. Itself: it stays alone.
    std::size_t agreed(std::size_t i) const
    {
        const std::uint32_t key = wanted_[i];
        if (key == no_neighbour) return i;
        const std::size_t other = wanted_neighbour(i, key);
        return wanted_[other] == key ? other : i;
    }

    // Whether the two make one leaf. One over many small boxes costs a block, as much as each of them, so it pays.
    bool make_a_leaf(std::size_t a, std::size_t b) const
    {
        static_assert(cost_of_block <= cost_of_node);
        if (now_.size(a) + now_.size(b) > float{max_leaf_size}) return false;
        return one_kind_ || sorted_[now_.node[a]].kind == sorted_[now_.node[b]].kind;
    }

    // Fills places_ and returns what there will be after the merge.
    Place find_places(std::size_t count)
    {
        places_.assign((count + chunk_size - 1) / chunk_size, {});
        for_chunks(count, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
            Place place;
            for (std::size_t i = begin; i < end; ++i) {
                const std::size_t other = agreed(i);
                if (other < i) continue;
                ++place.clusters;
                if (other == i || make_a_leaf(i, other)) continue;
                ++place.nodes;
                for (const std::size_t child : {i, other}) {
                    if (!now_.is_leaf(child)) continue;
                    ++place.nodes;
                    place.entries += static_cast<std::size_t>(now_.size(child));
                }
            }
            places_[chunk] = place;
        });
        Place sum = used_;
        sum.clusters = 0;
        for (Place& place : places_) {
            const Place own = std::exchange(place, sum);
            sum.clusters += own.clusters;
            sum.nodes += own.nodes;
            sum.entries += own.entries;
        }
        return sum;
    }

    void merge(std::size_t begin, std::size_t end, Place place)
    {
        for (std::size_t i = begin; i < end; ++i) {
            const std::size_t other = agreed(i);
            if (other < i) continue;
            Box box = now_.box(i);
            float size = now_.size(i);
            std::uint32_t id = now_.node[i];
            if (other > i) {
                box.extend(now_.box(other));
                size += now_.size(other);
                if (make_a_leaf(i, other)) {
                    std::uint32_t last = id;
                    while (after_[last] != nothing) last = after_[last];
                    after_[last] = now_.node[other];
                } else {
                    const std::uint32_t left = finished(now_, i, place), right = finished(now_, other, place);
                    id = static_cast<std::uint32_t>(place.nodes++);
                    nodes_[id] = {box, left, right, 0};
                    size = float{max_leaf_size + 1};
                }
            }
            next_.set(place.clusters++, box, size, id);
        }
    }

    // The node of a cluster that grows no more.
    std::uint32_t finished(const Clusters& clusters, std::size_t i, Place& place)
    {
        if (!clusters.is_leaf(i)) return clusters.node[i];
        const std::size_t first = place.entries;
        place.entries += static_cast<std::size_t>(clusters.size(i));
        uint count = 0;
        for (std::uint32_t at = clusters.node[i]; at != nothing; at = after_[at], ++count)
            order_[first + count] = sorted_[at];
        nodes_[place.nodes] = {clusters.box(i), static_cast<uint>(first), 0, count};
        return static_cast<std::uint32_t>(place.nodes++);
    }
};

} // namespace

BinaryTree build_ploc(const PackedScene&, std::vector<PrimitiveRef> refs, const BuildOptions&)
{
    if (refs.empty()) return {};
    return Builder(refs).run();
}

} // namespace snell
