#include "snell/bvh/linked_tree.h"

#include "snell/bvh/big_pages.h"
#include "snell/bvh/build.h"
#include "snell/core/error.h"
#include "snell/core/parallel.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>

namespace snell {
namespace {

constexpr uint none = ~0u;
constexpr std::size_t grain = 8192;       // nodes of a parallel pass that one thread takes at a time
constexpr uint task_leaves = 4096;        // subtrees with more leaves are written by two threads
constexpr uint too_high = 255;            // heights and counts beyond that need not be told apart
constexpr RefKind mixed = RefKind(0);     // a subtree with more than one kind
static_assert(max_tree_depth < too_high); // heights are compared with it

// What is known of a subtree once small ones have become leaves.
struct Summary
{
    uint entries = 0; // of all leaves together
    uint leaves = 0;
    float cost = 0;            // of small subtrees; the others need none
    std::uint8_t height = 0;   // up to too_high
    std::uint8_t gathered = 0; // entries before those that repeat are dropped, up to too_high
    RefKind kind : 8 = mixed;  // that all entries have
    bool becomes_leaf = false; // or is one already
};

// A few entries, each once. Trees with spatial splits hold a primitive in several leaves.
struct LeafEntries
{
    std::array<uint, max_leaf_size> index;
    uint count = 0;

    void add(uint entry)
    {
        for (uint i = 0; i < count; ++i)
            if (index[i] == entry) return;
        index[count++] = entry;
    }
};

class Relinker
{
  public:
    Relinker(std::span<const LinkedNode> linked, uint root_node, std::span<const BinaryTree::Entry> entries)
        : nodes(linked), root(root_node), order(entries), summaries(linked.size())
    {
    }

    BinaryTree run()
    {
        summarise_all();
        const Summary& all = summaries[root];
        tree.nodes = make_big<BinaryNode>(2 * std::size_t{all.leaves} - 1);
        tree.order = make_big<BinaryTree::Entry>(all.entries);
        emit(root, 0, 0, 0);
        return std::move(tree);
    }

  private:
    std::span<const LinkedNode> nodes;
    uint root;
    std::span<const BinaryTree::Entry> order;
    BigVector<Summary> summaries;
    BinaryTree tree;

    bool is_leaf(uint node) const { return nodes[node].count > 0; }

    // From the leaves up: whoever comes to a node second has both children's summaries and goes on. There is no
    // recursion, for the tree may be a chain of millions.
    void summarise_all()
    {
        BigVector<uint> parents(nodes.size(), none);
        parallel_ranges(nodes.size(), grain, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                if (is_leaf(static_cast<uint>(i))) continue;
                parents[nodes[i].left] = static_cast<uint>(i);
                parents[nodes[i].right] = static_cast<uint>(i);
            }
        });
        std::vector<std::atomic<std::uint8_t>> arrived(nodes.size());
        parallel_ranges(nodes.size(), grain, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                uint node = static_cast<uint>(i);
                if (!is_leaf(node)) continue;
                summaries[node] = summary_of_leaf(nodes[node]);
                for (node = parents[node]; node != none; node = parents[node]) {
                    if (arrived[node].fetch_add(1, std::memory_order_acq_rel) == 0) break;
                    summaries[node] = summary_of_inner(node);
                }
            }
        });
        SNELL_CHECK_LT(0u, summaries[root].leaves);
    }

    Summary summary_of_leaf(const LinkedNode& leaf) const
    {
        Summary s;
        s.entries = leaf.count;
        s.leaves = 1;
        s.cost = cost_of_block * static_cast<float>(leaf.box.half_area());
        s.gathered = static_cast<std::uint8_t>(std::min(leaf.count, too_high));
        s.kind = order[leaf.left].kind;
        s.becomes_leaf = true;
        return s;
    }

    Summary summary_of_inner(uint node) const
    {
        const Summary &a = summaries[nodes[node].left], &b = summaries[nodes[node].right];
        Summary s;
        s.entries = a.entries + b.entries;
        s.leaves = a.leaves + b.leaves;
        s.height = static_cast<std::uint8_t>(std::min<uint>(std::max(a.height, b.height) + 1u, too_high));
        s.gathered = static_cast<std::uint8_t>(std::min<uint>(uint{a.gathered} + b.gathered, too_high));
        s.kind = a.kind == b.kind ? a.kind : mixed;
        if (s.gathered > max_leaf_size || s.kind == mixed || s.kind == RefKind::instance) return s;
        const float area = static_cast<float>(nodes[node].box.half_area());
        const float as_leaf = cost_of_block * area;
        s.cost = cost_of_node * area + a.cost + b.cost;
        if (!(as_leaf <= s.cost)) return s;
        s.cost = as_leaf;
        s.becomes_leaf = true;
        s.entries = gather(node).count;
        s.leaves = 1;
        s.height = 0;
        return s;
    }

    // The entries of a subtree that becomes a leaf; it has few nodes, for each leaf below has an entry.
    LeafEntries gather(uint node) const
    {
        LeafEntries found;
        gather(node, found);
        return found;
    }
    void gather(uint node, LeafEntries& found) const
    {
        const LinkedNode& n = nodes[node];
        if (is_leaf(node)) {
            for (uint i = 0; i < n.count; ++i) found.add(order[n.left + i].index);
            return;
        }
        gather(n.left, found);
        gather(n.right, found);
    }

    void emit_leaf(uint node, uint at, uint first)
    {
        const LinkedNode& n = nodes[node];
        const Summary& s = summaries[node];
        tree.nodes[at] = {n.box, first, s.entries};
        if (is_leaf(node)) {
            std::copy_n(order.begin() + n.left, n.count, tree.order.begin() + first);
            return;
        }
        const LeafEntries found = gather(node);
        for (uint i = 0; i < found.count; ++i) tree.order[first + i] = {found.index[i], s.kind};
    }

    // Writes the subtree to tree.nodes[at...] and tree.order[first...]. The recursion ends at max_tree_depth.
    void emit(uint node, uint at, uint first, int depth)
    {
        const Summary& s = summaries[node];
        if (s.becomes_leaf) {
            emit_leaf(node, at, first);
            return;
        }
        const uint left = nodes[node].left, right = nodes[node].right;
        const Summary& l = summaries[left];
        if (depth + s.height > max_tree_depth && !(fits(left, depth + 1) && fits(right, depth + 1))) {
            emit_rearranged(node, at, first);
            return;
        }
        const uint right_at = at + 2 * l.leaves, right_first = first + l.entries;
        tree.nodes[at] = {nodes[node].box, right_at, 0};
        const auto emit_left = [&, depth] { emit(left, at + 1, first, depth + 1); };
        const auto emit_right = [&, depth] { emit(right, right_at, right_first, depth + 1); };
        if (s.leaves > task_leaves) {
            parallel_both(emit_left, emit_right);
        } else {
            emit_left();
            emit_right();
        }
    }

    // Whether the subtree can be within max_tree_depth at all: halved again and again, it is.
    bool fits(uint node, int depth) const
    {
        return depth + static_cast<int>(std::bit_width(summaries[node].leaves - 1)) <= max_tree_depth;
    }

    void emit_rearranged(uint node, uint at, uint first)
    {
        std::vector<uint> leaves, stack{node};
        leaves.reserve(summaries[node].leaves);
        while (!stack.empty()) {
            const uint n = stack.back();
            stack.pop_back();
            if (summaries[n].becomes_leaf) {
                leaves.push_back(n);
            } else {
                stack.push_back(nodes[n].right);
                stack.push_back(nodes[n].left);
            }
        }
        emit_halves(leaves, at, first);
    }

    // Returns the next free place in the order.
    uint emit_halves(std::span<const uint> leaves, uint at, uint first)
    {
        if (leaves.size() == 1) {
            emit_leaf(leaves.front(), at, first);
            return first + summaries[leaves.front()].entries;
        }
        const std::size_t half = leaves.size() / 2;
        const uint right = at + 2 * static_cast<uint>(half);
        first = emit_halves(leaves.first(half), at + 1, first);
        first = emit_halves(leaves.subspan(half), right, first);
        Box box = tree.nodes[at + 1].box;
        box.extend(tree.nodes[right].box);
        tree.nodes[at] = {box, right, 0};
        return first;
    }
};

} // namespace

BinaryTree make_depth_first(std::span<const LinkedNode> nodes, uint root, std::span<const BinaryTree::Entry> order)
{
    if (nodes.empty()) return {};
    return Relinker(nodes, root, order).run();
}

std::vector<LinkedNode> make_linked(const BinaryTree& tree)
{
    std::vector<LinkedNode> nodes(tree.nodes.size());
    parallel_ranges(nodes.size(), grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const BinaryNode& node = tree.nodes[i];
            nodes[i] = node.count > 0 ? LinkedNode{node.box, node.link, 0, node.count}
                                      : LinkedNode{node.box, static_cast<uint>(i) + 1, node.link, 0};
        }
    });
    return nodes;
}

} // namespace snell
