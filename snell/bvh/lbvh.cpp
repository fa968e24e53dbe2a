#include "snell/bvh/build.h"
#include "snell/bvh/extents.h"
#include "snell/bvh/morton.h"
#include "snell/core/error.h"
#include "snell/core/parallel.h"
#include "snell/kernel/lang.h"

#include <hwy/cache_control.h>

#include <algorithm>
#include <array>
#include <bit>

namespace snell {
namespace {

constexpr std::size_t treelet_size = 16;
constexpr std::size_t piece_size = 4096; // subtrees up to here are built by one thread
constexpr std::size_t ahead = 24;        // references that are on their way from memory

// Every level of the tree takes at least one bit of a code or an index; a treelet has fewer levels than its keys have
// bits to differ in.
static_assert(63 + 30 <= max_tree_depth && treelet_size <= 4 * max_leaf_size);
// A leaf never costs more than a node over two others, so small subtrees always become one.
static_assert(cost_of_block <= cost_of_node);

// First i in [begin, end) for which is_right(i) holds; it holds for the last one, and from there on.
template <class IsRight>
std::size_t find_first(std::size_t begin, std::size_t end, const IsRight& is_right)
{
    std::size_t count = end - begin;
    while (count > 1) {
        const std::size_t half = count / 2;
        begin = is_right(begin + half - 1) ? begin : begin + half;
        count -= half;
    }
    return begin;
}

struct PackedKeys
{
    const Scratch<std::uint64_t>& keys;
    std::uint64_t index_mask;

    explicit PackedKeys(const MortonOrder& order)
        : keys(order.packed), index_mask((std::uint64_t{1} << order.index_bits) - 1)
    {
    }
    std::size_t index(std::size_t i) const { return keys[i] & index_mask; }
    // Where the highest bit changes in which the first and the last one differ.
    std::size_t split(std::size_t begin, std::size_t end) const
    {
        const std::uint64_t bit = std::bit_floor(keys[begin] ^ keys[end - 1]);
        return find_first(begin, end, [&](std::size_t i) { return (keys[i] & bit) != 0; });
    }
};

struct WideKeys
{
    const Scratch<MortonKey>& keys;

    explicit WideKeys(const MortonOrder& order) : keys(order.wide) {}
    std::size_t index(std::size_t i) const { return keys[i].index; }
    std::size_t split(std::size_t begin, std::size_t end) const
    {
        if (const std::uint64_t bit = std::bit_floor(keys[begin].code ^ keys[end - 1].code))
            return find_first(begin, end, [&](std::size_t i) { return (keys[i].code & bit) != 0; });
        const std::uint32_t bit = std::bit_floor(keys[begin].index ^ keys[end - 1].index);
        return find_first(begin, end, [&](std::size_t i) { return (keys[i].index & bit) != 0; });
    }
};

uint blocks(std::size_t count)
{
    return static_cast<uint>((count + max_leaf_size - 1) / max_leaf_size);
}

float half_area(const WideBox& box)
{
    alignas(16) float e[4];
    hn::Store(hn::Sub(box.upper, box.lower), Lanes4(), e);
    return e[0] * e[1] + e[1] * e[2] + e[2] * e[0];
}

// A few primitives in a row, of one kind. Bits of a code would leave most leaves half empty; here the cuts are those of
// least surface that fill as few leaves as there can be.
struct Treelet
{
    std::array<Vec4, treelet_size> lower, upper;

    WideBox box(std::size_t begin, std::size_t end) const
    {
        WideBox sum;
        for (std::size_t i = begin; i < end; ++i) sum.extend(lower[i], upper[i]);
        return sum;
    }
    // Where the right side begins.
    std::size_t cut(std::size_t begin, std::size_t end) const
    {
        const auto fills = [&](std::size_t i) { return blocks(i - begin) + blocks(end - i) == blocks(end - begin); };
        std::array<float, treelet_size> right_cost;
        WideBox sum;
        for (std::size_t i = end - 1; i > begin; --i) {
            sum.extend(lower[i], upper[i]);
            if (fills(i)) right_cost[i] = half_area(sum) * static_cast<float>(blocks(end - i));
        }
        sum = WideBox();
        std::size_t best = 0;
        float best_cost = 0;
        for (std::size_t i = begin + 1; i < end; ++i) {
            sum.extend(lower[i - 1], upper[i - 1]);
            if (!fills(i)) continue;
            const float cost = half_area(sum) * static_cast<float>(blocks(i - begin)) + right_cost[i];
            if (best == 0 || cost < best_cost) best = i, best_cost = cost;
        }
        return best;
    }
};

// The topology follows from the sorted keys alone, so it is gone through twice: first to count the leaves, then to
// write each node to its final place.
template <class Keys>
class Builder
{
  public:
    Builder(std::span<const PrimitiveRef> primitives, const MortonOrder& order)
        : refs(primitives), keys(order),
          one_kind(std::has_single_bit(order.kinds) && order.kinds != 1u << static_cast<uint>(RefKind::instance))
    {
    }

    BinaryTree run()
    {
        split_top();
        for_pieces([&](Part& part) { part.leaves = count_leaves(part.begin, part.end); });
        for (std::size_t i = parts.size(); i-- > 0;)
            if (parts[i].left) parts[i].leaves = parts[parts[i].left].leaves + parts[parts[i].right].leaves;
        tree.nodes = make_big<BinaryNode>(2 * std::size_t{parts[0].leaves} - 1);
        tree.order = make_big<BinaryTree::Entry>(refs.size());
        for (Part& part : parts) {
            if (!part.left) continue;
            parts[part.left].at = part.at + 1;
            parts[part.right].at = part.at + 2 * parts[part.left].leaves;
        }
        for_pieces([&](Part& part) {
            WideBox box;
            emit(part.begin, part.end, part.at, box);
        });
        for (std::size_t i = parts.size(); i-- > 0;) {
            const Part& part = parts[i];
            if (!part.left) continue;
            Box box = tree.nodes[part.at + 1].box;
            box.extend(tree.nodes[parts[part.right].at].box);
            tree.nodes[part.at] = {box, parts[part.right].at, 0};
        }
        return std::move(tree);
    }

  private:
    // A subtree near the root.
    struct Part
    {
        std::size_t begin, end;          // of the keys
        std::size_t left = 0, right = 0; // parts; none: a piece, which one thread builds
        uint leaves = 0, at = 0;         // at: its place among the nodes
    };

    std::span<const PrimitiveRef> refs;
    Keys keys;
    bool one_kind;           // and not instances
    std::vector<Part> parts; // children after parents
    BinaryTree tree;

    void split_top()
    {
        parts.push_back({0, refs.size()});
        for (std::size_t i = 0; i < parts.size(); ++i) {
            const auto [begin, end] = std::pair(parts[i].begin, parts[i].end);
            if (end - begin <= piece_size) continue;
            const std::size_t middle = keys.split(begin, end);
            parts[i].left = parts.size();
            parts[i].right = parts.size() + 1;
            parts.push_back({begin, middle});
            parts.push_back({middle, end});
        }
    }

    template <class Body>
    void for_pieces(const Body& body)
    {
        parallel_for(parts.size(), [&](std::size_t i) {
            if (!parts[i].left) body(parts[i]);
        });
    }

    bool is_leaf(std::size_t begin, std::size_t end) const
    {
        if (end - begin == 1) return true;
        if (end - begin > max_leaf_size) return false;
        if (one_kind) return true;
        const RefKind kind = refs[keys.index(begin)].kind;
        if (kind == RefKind::instance) return false;
        for (std::size_t i = begin + 1; i < end; ++i)
            if (refs[keys.index(i)].kind != kind) return false;
        return true;
    }

    bool is_treelet(std::size_t begin, std::size_t end) const { return one_kind && end - begin <= treelet_size; }

    uint count_leaves(std::size_t begin, std::size_t end) const
    {
        if (is_treelet(begin, end)) return blocks(end - begin);
        if (is_leaf(begin, end)) return 1;
        const std::size_t middle = keys.split(begin, end);
        return count_leaves(begin, middle) + count_leaves(middle, end);
    }

    // Enters the reference at place i into the order.
    const PrimitiveRef& take(std::size_t i)
    {
        hwy::Prefetch(&refs[keys.index(std::min(i + ahead, refs.size() - 1))]);
        const PrimitiveRef& ref = refs[keys.index(i)];
        tree.order[i] = {ref.index, ref.kind};
        return ref;
    }

    // Writes the subtree to tree.nodes[at...] and returns what comes behind it.
    uint emit(std::size_t begin, std::size_t end, uint at, WideBox& box)
    {
        if (is_treelet(begin, end)) {
            Treelet treelet;
            for (std::size_t i = begin; i < end; ++i) {
                const PrimitiveRef& ref = take(i);
                treelet.lower[i - begin] = hn::Load(Lanes4(), &ref.lower.x);
                treelet.upper[i - begin] = hn::Load(Lanes4(), &ref.upper.x);
            }
            return emit_treelet(treelet, begin, 0, end - begin, at, box);
        }
        if (is_leaf(begin, end)) {
            for (std::size_t i = begin; i < end; ++i) {
                const PrimitiveRef& ref = take(i);
                box.extend(hn::Load(Lanes4(), &ref.lower.x), hn::Load(Lanes4(), &ref.upper.x));
            }
            tree.nodes[at] = {box.box(), static_cast<uint>(begin), static_cast<uint>(end - begin)};
            return at + 1;
        }
        const std::size_t middle = keys.split(begin, end);
        WideBox other;
        const uint right = emit(begin, middle, at + 1, box);
        const uint next = emit(middle, end, right, other);
        box.extend(other);
        tree.nodes[at] = {box.box(), right, 0};
        return next;
    }

    // first: place of the treelet's first primitive; begin, end: within the treelet.
    uint emit_treelet(const Treelet& treelet, std::size_t first, std::size_t begin, std::size_t end, uint at,
                      WideBox& box)
    {
        if (end - begin <= max_leaf_size) {
            box = treelet.box(begin, end);
            tree.nodes[at] = {box.box(), static_cast<uint>(first + begin), static_cast<uint>(end - begin)};
            return at + 1;
        }
        const std::size_t middle = treelet.cut(begin, end);
        WideBox other;
        const uint right = emit_treelet(treelet, first, begin, middle, at + 1, box);
        const uint next = emit_treelet(treelet, first, middle, end, right, other);
        box.extend(other);
        tree.nodes[at] = {box.box(), right, 0};
        return next;
    }
};

} // namespace

BinaryTree build_lbvh(const PackedScene&, std::vector<PrimitiveRef> refs, const BuildOptions&)
{
    if (refs.empty()) return {};
    const MortonOrder order = sort_by_morton(refs);
    return order.is_wide() ? Builder<WideKeys>(refs, order).run() : Builder<PackedKeys>(refs, order).run();
}

} // namespace snell
