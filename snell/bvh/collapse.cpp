#include "snell/bvh/collapse.h"

#include "snell/bvh/triangle_block.h"
#include "snell/bvh/wide.h"
#include "snell/core/parallel.h"

#include <algorithm>

namespace snell {

// Subtrees of so many binary nodes are looked at by one thread.
static constexpr uint piece_size = 8192;

// What a node costs even where no ray comes, relative to one that all rays visit: of trees that are as fast, the
// smaller one. Decides alone where boxes have no surface.
static constexpr float cost_of_room = 1e-7f;

template <uint width>
Collapse<width>::Collapse(const PackedScene& scene, const BinaryTree& tree)
    : scene_(scene), tree_(tree), cells_(tree.nodes.size())
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
    parallel_for(small.size(), [&](std::size_t i) {
        for (uint index = small[i].end; index-- > small[i].begin;) price(index);
    });
    for (std::size_t i = above.size(); i-- > 0;) price(above[i]);
}

template <uint width>
void Collapse<width>::price(uint index)
{
    const BinaryNode& node = tree_.nodes[index];
    std::array<Cell, width>& cells = cells_[index];
    const float area = static_cast<float>(node.box.half_area() * scale_);
    const float as_leaf = wide_block_cost * area;
    if (node.count > 0) {
        for (uint i = 0; i + 1 < width; ++i) cells[i].cost = as_leaf;
        const bool triangles = tree_.order[node.link].kind == RefKind::triangle;
        cells[width - 1].notes = leaf_bit | (triangles ? node.count : 0);
        return;
    }
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
        if (fit_one_block(scene_, {&tree_.order[first_entry(index)], count}))
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
    const uint left = note(index + 1) & count_mask, right = note(middle(index)) & count_mask;
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
std::span<const BinaryTree::Entry> Collapse<width>::entries(uint index) const
{
    const BinaryNode& node = tree_.nodes[index];
    return {&tree_.order[first_entry(index)], node.count > 0 ? node.count : note(index) & count_mask};
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
    if (tree_.nodes[index].count == 0)
        while (places > 1 && cost(index, places) == cost(index, places - 1)) --places;
    if (places == 1 || tree_.nodes[index].count > 0) {
        to.index[to.count] = index;
        to.end[to.count++] = end;
        return;
    }
    const uint share = best_share(index, places);
    add(to, index + 1, middle(index), share);
    add(to, middle(index), end, places - share);
}

template <uint width>
typename Collapse<width>::Children Collapse<width>::children(uint index, uint end) const
{
    Children found;
    const uint share = best_share(index, width);
    add(found, index + 1, middle(index), share);
    add(found, middle(index), end, width - share);
    return found;
}

template class Collapse<2>;
template class Collapse<4>;
template class Collapse<8>;

} // namespace snell
