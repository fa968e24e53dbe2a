#include "snell/bvh/collapse.h"

#include "snell/bvh/triangle_block.h"
#include "snell/bvh/wide.h"
#include "snell/core/parallel.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <numeric>

namespace snell {

// Subtrees of so many binary nodes are looked at by one thread.
static constexpr uint piece_size = 8192;

// What a node costs even where no ray comes, relative to one that all rays visit: of trees that are as fast, the
// smaller one. Decides alone where boxes have no surface.
static constexpr float cost_of_room = 1e-7f;

// What a second part of a leaf costs for the memory it takes, relative to a visit of the mean leaf. Measured: with
// less, trees grow and are no faster.
static constexpr double part_price = 0.06;

template <uint width>
Collapse<width>::Collapse(const PackedScene& scene, const BinaryTree& tree)
    : scene_(scene), tree_(tree), cells_(tree.nodes.size()), order_(tree.order.size())
{
    if (tree.nodes.empty()) return;
    const double area = tree.nodes[0].box.half_area();
    if (area > 0) scale_ = 1 / area;
    price_all();
}

// Children before their parents: small subtrees in parallel, then what is above them.
template <uint width>
void Collapse<width>::price_all()
{
    struct Range
    {
        uint begin, end;
    };
    std::vector<Range> small, waiting{{0, static_cast<uint>(tree_.nodes.size())}};
    std::vector<uint> above;
    while (!waiting.empty()) {
        const auto [begin, end] = waiting.back();
        waiting.pop_back();
        if (end - begin <= piece_size) {
            small.push_back({begin, end});
            continue;
        }
        above.push_back(begin);
        waiting.push_back({begin + 1, middle(begin)});
        waiting.push_back({middle(begin), end});
    }
    std::vector<double> areas(small.size());
    std::vector<std::size_t> leaves(small.size());
    parallel_for(small.size(), [&](std::size_t i) {
        for (uint index = small[i].begin; index < small[i].end; ++index)
            if (tree_.nodes[index].count > 0) areas[i] += tree_.nodes[index].box.half_area() * scale_, ++leaves[i];
    });
    const double area = std::accumulate(areas.begin(), areas.end(), 0.0);
    const std::size_t count = std::accumulate(leaves.begin(), leaves.end(), std::size_t{0});
    cost_of_part_ = static_cast<float>(part_price * area / static_cast<double>(count)) + cost_of_room;
    parallel_for(small.size(), [&](std::size_t i) {
        for (uint index = small[i].end; index-- > small[i].begin;) price(index);
    });
    for (std::size_t i = above.size(); i-- > 0;) price(above[i]);
}

namespace {

// The triangles of a leaf, and how to part them.
struct Parting
{
    Box box[max_leaf_size];
    uint vertices[max_leaf_size]; // as bits
    uint all_vertices = 0;
    uint order[max_leaf_size]; // of the best so far
    uint first = 0;            // how many are in the first part; 0: none found
    double cost = 0;

    Parting(const PackedScene& scene, const Box& within, std::span<const BinaryTree::Entry> entries)
    {
        uint distinct[3 * max_leaf_size];
        uint known = 0;
        for (uint i = 0; i < entries.size(); ++i) {
            const Triangle& tri = scene.triangles[entries[i].index];
            vertices[i] = 0;
            for (const uint vertex : {tri.v0, tri.v1, tri.v2}) {
                const uint at = static_cast<uint>(std::find(distinct, distinct + known, vertex) - distinct);
                if (at == known) distinct[known++] = vertex;
                vertices[i] |= 1u << at;
                box[i].extend(scene.positions[vertex]);
            }
            // Of a triangle that was split, here is a part only.
            box[i].lower = max(box[i].lower, within.lower), box[i].upper = min(box[i].upper, within.upper);
            all_vertices |= vertices[i];
        }
    }

    // As append_blocks() needs them, about.
    static double blocks(uint some_vertices) { return std::popcount(some_vertices) <= 16 ? 1 : 2; }

    void find(uint count)
    {
        cost = std::numeric_limits<double>::infinity();
        for (int axis = 0; axis < 3; ++axis) {
            uint sorted[max_leaf_size];
            for (uint i = 0; i < count; ++i) {
                const float key = box[i].lower[axis] + box[i].upper[axis];
                uint at = i;
                for (; at > 0 && box[sorted[at - 1]].lower[axis] + box[sorted[at - 1]].upper[axis] > key; --at)
                    sorted[at] = sorted[at - 1];
                sorted[at] = i;
            }
            double behind[max_leaf_size];
            Box sum;
            uint seen = 0;
            for (uint i = count; i-- > 1;) {
                sum.extend(box[sorted[i]]);
                seen |= vertices[sorted[i]];
                behind[i] = sum.half_area() * blocks(seen);
            }
            sum = {}, seen = 0;
            for (uint i = 1; i < count; ++i) {
                sum.extend(box[sorted[i - 1]]);
                seen |= vertices[sorted[i - 1]];
                const double both = sum.half_area() * blocks(seen) + behind[i];
                if (!(both < cost)) continue;
                cost = both, first = i;
                std::copy_n(sorted, count, order);
            }
        }
    }
};

} // namespace

template <uint width>
void Collapse<width>::price_leaf(uint index)
{
    const BinaryNode& node = tree_.nodes[index];
    std::array<Cell, width>& cells = cells_[index];
    const std::span<const BinaryTree::Entry> entries(&tree_.order[node.link], node.count);
    const double area = node.box.half_area() * scale_;
    std::copy(entries.begin(), entries.end(), &order_[node.link]);
    if (entries[0].kind != RefKind::triangle) {
        for (uint i = 0; i + 1 < width; ++i) cells[i].cost = static_cast<float>(area) * wide_block_cost;
        cells[width - 1].notes = leaf_bit;
        return;
    }
    cells[width - 1].notes = leaf_bit | node.count;
    // Most leaves are too small for parting them to gain what it costs: their triangles need not be looked at.
    const bool large = 0.5 * area * double(wide_block_cost) > double(cost_of_part_);
    if (width < 4 || node.count < 2 || !large) {
        for (uint i = 0; i + 1 < width; ++i) cells[i].cost = static_cast<float>(area) * wide_block_cost;
        return;
    }
    Parting parting(scene_, node.box, entries);
    const float whole = static_cast<float>(area * Parting::blocks(parting.all_vertices)) * wide_block_cost;
    for (uint i = 0; i + 1 < width; ++i) cells[i].cost = whole;
    parting.find(node.count);
    const float parted = static_cast<float>(parting.cost * scale_) * wide_block_cost + cost_of_part_;
    if (parting.first == 0 || !(parted < whole)) return;
    for (uint i = 1; i + 1 < width; ++i) cells[i].cost = parted;
    cells[width - 1].notes |= parting.first << part_shift;
    for (uint i = 0; i < node.count; ++i) order_[node.link + i] = entries[parting.order[i]];
}

template <uint width>
void Collapse<width>::price(uint index)
{
    const BinaryNode& node = tree_.nodes[index];
    std::array<Cell, width>& cells = cells_[index];
    const float area = static_cast<float>(node.box.half_area() * scale_);
    const float as_leaf = wide_block_cost * area;
    if (node.count > 0) return price_leaf(index);
    const std::array<Cell, width>&left = cells_[index + 1], &right = cells_[node.link];
    std::array<float, width + 1> apart; // both children of the binary node, by places for them
    for (uint places = 2; places <= width; ++places) {
        float least = left[0].cost + right[places - 2].cost;
        for (uint share = 2; share < places; ++share)
            least = std::min(least, left[share - 1].cost + right[places - share - 1].cost);
        apart[places] = least;
    }
    float least = wide_node_cost * area + cost_of_room + apart[width];
    const uint count = count_if_block(index);
    uint notes = count;
    if (count > 0 && as_leaf <= least) {
        least = as_leaf;
        // Looks at triangles, and so comes last.
        if (fit_one_block(scene_, {&order_[first_entry(index)], count}))
            notes |= leaf_bit;
        else
            least = wide_node_cost * area + cost_of_room + apart[width], notes = 0;
    }
    cells[0].cost = least;
    for (uint places = 2; places < width; ++places) {
        least = std::min(least, apart[places]);
        cells[places - 1].cost = least;
    }
    cells[width - 1].notes = notes;
}

// Entries of a subtree of two that could be a leaf, else 0.
template <uint width>
uint Collapse<width>::count_if_block(uint index) const
{
    const uint left = notes(index + 1) & count_mask, right = notes(middle(index)) & count_mask;
    if (left == 0 || right == 0 || left + right > max_leaf_size) return 0;
    return first_entry(index + 1) + left == first_entry(middle(index)) ? left + right : 0;
}

template <uint width>
uint Collapse<width>::first_entry(uint index) const
{
    while (tree_.nodes[index].count == 0) ++index;
    return tree_.nodes[index].link;
}

template <uint width>
std::span<const BinaryTree::Entry> Collapse<width>::entries(const Child& leaf) const
{
    const BinaryNode& node = tree_.nodes[leaf.index];
    const uint all = node.count > 0 ? node.count : notes(leaf.index) & count_mask;
    const uint first = notes(leaf.index) >> part_shift & count_mask;
    const BinaryTree::Entry* const begin = &order_[first_entry(leaf.index)];
    if (leaf.part == 0) return {begin, all};
    return leaf.part == 1 ? std::span(begin, first) : std::span(begin + first, all - first);
}

template <uint width>
Box Collapse<width>::box(const Child& child) const
{
    const Box& whole = tree_.nodes[child.index].box;
    if (child.part == 0) return whole;
    Box part;
    for (const BinaryTree::Entry& entry : entries(child)) {
        const Triangle& tri = scene_.triangles[entry.index];
        for (const uint vertex : {tri.v0, tri.v1, tri.v2}) part.extend(scene_.positions[vertex]);
    }
    return {max(part.lower, whole.lower) + 0.0f, min(part.upper, whole.upper) + 0.0f};
}

// How many of the places go to the left child.
template <uint width>
uint Collapse<width>::best_share(uint index, uint places) const
{
    const uint left = index + 1, right = middle(index);
    uint best = 1;
    float least = cost(left, 1) + cost(right, places - 1);
    for (uint share = 2; share < places; ++share) {
        const float sum = cost(left, share) + cost(right, places - share);
        if (sum < least) least = sum, best = share;
    }
    return best;
}

template <uint width>
void Collapse<width>::add(Children& to, uint index, uint end, uint places) const
{
    while (places > 1 && cost(index, places) == cost(index, places - 1)) --places;
    if (places == 1) return to.add({index, end, 0});
    if (tree_.nodes[index].count > 0) {
        to.add({index, end, 1});
        to.add({index, end, 2});
        return;
    }
    const uint share = best_share(index, places);
    add(to, index + 1, middle(index), share);
    add(to, middle(index), end, places - share);
}

template <uint width>
typename Collapse<width>::Children Collapse<width>::children(const Child& of) const
{
    Children found;
    const uint share = best_share(of.index, width);
    add(found, of.index + 1, middle(of.index), share);
    add(found, middle(of.index), of.end, width - share);
    return found;
}

template class Collapse<2>;
template class Collapse<4>;
template class Collapse<8>;

} // namespace snell
