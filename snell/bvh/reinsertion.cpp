#include "snell/bvh/big_pages.h"
#include "snell/bvh/build.h"
#include "snell/bvh/linked_tree.h"
#include "snell/core/parallel.h"
#include "snell/kernel/lang.h"

#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <functional>

namespace snell {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Lanes = hn::FixedTag<float, 4>;
using Vec = hn::Vec<Lanes>;

// A round tries one node in so many and a few thousand more: those with the largest surface. Most of what there is to
// gain is near the root.
constexpr std::size_t candidate_share = 50;
constexpr std::size_t least_candidates = 4000;
constexpr int max_visits = 1024;       // of one search; boxes that all overlap would make it visit everything
constexpr int max_target_depth = 80;   // room for the moved subtree, so that max_tree_depth is seldom exceeded
constexpr double least_gain = 1e-7;    // as a part of the root's surface; more than rounding can feign
constexpr std::size_t chunk_size = 64; // candidates that one thread takes at a time

// Two to a cache line. The indices share their load with the box.
struct alignas(32) Node
{
    vec3 lower;
    uint left; // none: a leaf
    vec3 upper;
    uint right;

    bool is_leaf() const { return left == none; }
    Box box() const { return {lower, upper}; }
};
static_assert(sizeof(Node) == 32);

// The fourth lane is an index in disguise; it becomes 0, so that no arithmetic meets a denormal or a NaN.
Vec load3(const vec3& v)
{
    alignas(16) static constexpr uint mask[4] = {~0u, ~0u, ~0u, 0u};
    const hn::RebindToUnsigned<Lanes> du;
    return hn::And(hn::Load(Lanes(), &v.x), hn::BitCast(Lanes(), hn::Load(du, mask)));
}

// In registers.
struct WideBox
{
    Vec lower, upper;

    explicit WideBox(const Node& node) : lower(load3(node.lower)), upper(load3(node.upper)) {}
    void extend(const WideBox& b) { lower = hn::Min(lower, b.lower), upper = hn::Max(upper, b.upper); }
};

// Takes n out of the tree and makes it the sibling of `target`.
struct Move
{
    float gain = 0; // by how much the inner nodes' surface shrinks
    uint node = none, target = none;
};

class Optimiser
{
  public:
    explicit Optimiser(const BinaryTree& binary)
        : nodes(binary.nodes.size()), parents(nodes.size()), marks(nodes.size())
    {
        // From the children to the parents: boxes become those of what is below, whatever they were.
        parents[0] = none;
        for (std::size_t i = nodes.size(); i-- > 0;) {
            const BinaryNode& node = binary.nodes[i];
            if (node.count > 0) {
                nodes[i] = {node.box.lower, none, node.box.upper, none};
                continue;
            }
            nodes[i].left = static_cast<uint>(i) + 1;
            nodes[i].right = node.link;
            parents[i + 1] = parents[node.link] = static_cast<uint>(i);
            tighten(static_cast<uint>(i));
        }
        // Surfaces are those of a root of about unit size: floats do not overflow when squared, whatever the scene.
        const float size = max3(nodes[0].upper - nodes[0].lower);
        scale = is_finite(size) && is_finite(1.0f / size) ? 1.0f / size : 1.0f;
    }

    // Returns whether anything has changed.
    bool round()
    {
        const std::vector<uint> candidates = choose();
        std::vector<Move> moves(candidates.size());
        parallel_for((candidates.size() + chunk_size - 1) / chunk_size, [&](std::size_t chunk) {
            Search search;
            const std::size_t end = std::min(candidates.size(), (chunk + 1) * chunk_size);
            for (std::size_t i = chunk * chunk_size; i < end; ++i) moves[i] = find(candidates[i], search);
        });
        // One after the other, the best first, each if it still gains: moves of one round may be in each other's way.
        std::erase_if(moves, [](const Move& move) { return !(move.gain > 0); });
        std::sort(moves.begin(), moves.end(),
                  [](const Move& a, const Move& b) { return a.gain != b.gain ? a.gain > b.gain : a.node < b.node; });
        const double least = least_gain * nodes[root].box().half_area();
        bool changed = false;
        for (const Move& move : moves) changed = apply(move.node, move.target, least) || changed;
        return changed;
    }

    BinaryTree result(const BinaryTree& original) const
    {
        BigVector<LinkedNode> linked(nodes.size());
        parallel_ranges(nodes.size(), 8192, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                const Node& node = nodes[i];
                const BinaryNode& old = original.nodes[i];
                linked[i] = node.is_leaf() ? LinkedNode{node.box(), old.link, 0, old.count}
                                           : LinkedNode{node.box(), node.left, node.right, 0};
            }
        });
        return make_depth_first(linked, root, original.order);
    }

  private:
    struct Waiting
    {
        float freed; // surface that the move gains before its target's new parent is counted
        uint node;
    };
    struct Search
    {
        std::vector<Waiting> stack;
        int visits = 0;
    };

    BigVector<Node> nodes;
    BigVector<uint> parents; // none: the root's
    BigVector<uint> marks;   // the last move that a node was an ancestor in
    uint mark = 0;
    uint root = 0;
    float scale = 1.0f;

    // Half the surface, scaled.
    float area(const WideBox& b) const
    {
        const Vec e = hn::Mul(hn::Sub(b.upper, b.lower), hn::Set(Lanes(), scale));
        alignas(16) float x[4];
        hn::Store(e, Lanes(), x);
        return x[0] * (x[1] + x[2]) + x[1] * x[2];
    }
    float merged_area(const WideBox& a, const WideBox& b) const
    {
        WideBox both = a;
        both.extend(b);
        return area(both);
    }

    uint sibling(uint parent, uint child) const
    {
        return nodes[parent].left == child ? nodes[parent].right : nodes[parent].left;
    }

    // Returns whether the box has changed.
    bool tighten(uint inner)
    {
        Node& node = nodes[inner];
        Box box = nodes[node.left].box();
        box.extend(nodes[node.right].box());
        const bool changed = box.lower != node.lower || box.upper != node.upper;
        node.lower = box.lower;
        node.upper = box.upper;
        return changed;
    }

    // From a node up to, and without, `end`, or to the first whose box stays.
    void tighten_up(uint node, uint end)
    {
        while (node != end && tighten(node)) node = parents[node];
    }

    // The nodes with the largest surface, in ascending order.
    std::vector<uint> choose() const
    {
        BigVector<std::uint64_t> keys(nodes.size());
        parallel_ranges(nodes.size(), 8192, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                const std::uint64_t rank = std::bit_cast<uint>(area(WideBox(nodes[i]))); // in order, for areas are >= 0
                keys[i] = rank << 32 | (0xffffffffu - static_cast<uint>(i));
            }
        });
        const std::size_t count = std::min(nodes.size(), nodes.size() / candidate_share + least_candidates);
        std::nth_element(keys.begin(), keys.begin() + static_cast<std::ptrdiff_t>(count - 1), keys.end(),
                         std::greater<>());
        std::vector<uint> chosen(count);
        for (std::size_t i = 0; i < count; ++i) chosen[i] = 0xffffffffu - static_cast<uint>(keys[i]);
        std::sort(chosen.begin(), chosen.end()); // neighbours search the same places
        return chosen;
    }

    // The best place for n: branch and bound, first below its sibling, then below the siblings of its ancestors.
    Move find(uint n, Search& search) const
    {
        Move best{0, n, none};
        const uint parent = parents[n];
        if (parent == none) return best;
        const WideBox box(nodes[n]);
        const float own = area(box);
        float freed = area(WideBox(nodes[parent]));
        uint below = n;
        WideBox rest(nodes[sibling(parent, n)]); // what remains of the ancestor without n
        search.visits = 0;
        for (uint ancestor = parent; ancestor != none; ancestor = parents[ancestor]) {
            const uint other = sibling(ancestor, below);
            if (freed - own > best.gain) find_below(other, freed, box, own, best, search);
            if (ancestor != parent) {
                rest.extend(WideBox(nodes[other]));
                const float whole = area(WideBox(nodes[ancestor]));
                freed += whole - area(rest);
                if (freed - whole > best.gain) best.gain = freed - whole, best.target = ancestor;
            }
            below = ancestor;
        }
        return best;
    }

    void find_below(uint top, float freed, const WideBox& box, float own, Move& best, Search& search) const
    {
        std::vector<Waiting>& stack = search.stack;
        // Looks at one target and returns what its children have to offer at most.
        const auto visit = [&](uint node, float before) {
            ++search.visits;
            const WideBox at(nodes[node]);
            const float gain = before - merged_area(at, box);
            if (gain > best.gain) best.gain = gain, best.target = node;
            return nodes[node].is_leaf() ? 0.0f : gain + area(at);
        };
        stack.assign(1, {visit(top, freed), top});
        while (!stack.empty() && search.visits < max_visits) {
            const Waiting next = stack.back();
            stack.pop_back();
            if (!(next.freed - own > best.gain)) continue;
            const uint left = nodes[next.node].left, right = nodes[next.node].right;
            const Waiting a{visit(left, next.freed), left}, b{visit(right, next.freed), right};
            const bool left_first = a.freed >= b.freed;
            for (const Waiting& child : {left_first ? b : a, left_first ? a : b})
                if (child.freed - own > best.gain) stack.push_back(child);
        }
    }

    void replace_child(uint parent, uint from, uint to)
    {
        parents[to] = parent;
        if (parent == none) {
            root = to;
        } else {
            (nodes[parent].left == from ? nodes[parent].left : nodes[parent].right) = to;
        }
    }

    // What the move gains now, in unscaled surface and in double. top: the lowest node above both, or the target
    // itself if it is above n.
    double gain_of(uint n, uint target, uint top) const
    {
        const Box box = nodes[n].box();
        const uint parent = parents[n];
        double gain = nodes[parent].box().half_area();
        if (top != parent) {
            Box rest = nodes[sibling(parent, n)].box();
            uint below = parent;
            for (uint a = parents[parent]; a != top; below = a, a = parents[a]) {
                rest.extend(nodes[sibling(a, below)].box());
                gain += nodes[a].box().half_area() - rest.half_area();
            }
            if (top == target) {
                rest.extend(nodes[sibling(top, below)].box());
                return gain - rest.half_area(); // the new parent has the target's old box
            }
        }
        Box merged = nodes[target].box();
        merged.extend(box);
        gain -= merged.half_area();
        for (uint a = parents[target]; a != top; a = parents[a]) {
            merged = nodes[a].box();
            merged.extend(box);
            gain -= merged.half_area() - nodes[a].box().half_area();
        }
        return gain;
    }

    bool apply(uint n, uint target, double least)
    {
        const uint parent = parents[n];
        if (parent == none || target == parent) return false;
        const uint other = sibling(parent, n);
        if (target == other) return false;
        ++mark;
        int depth = 0;
        for (uint a = n; a != none; a = parents[a]) marks[a] = mark, ++depth;
        uint top = target;
        for (; marks[top] != mark; top = parents[top]) ++depth;
        if (top == n) return false; // an earlier move has put the target below n
        for (uint a = n; a != top; a = parents[a]) --depth;
        if (depth > max_target_depth) return false;
        if (!(gain_of(n, target, top) > least)) return false;

        // Out: the sibling takes the parent's place, and boxes shrink up to where they do not.
        replace_child(parents[parent], parent, other);
        if (top != parent) {
            tighten_up(parents[other], top == target ? parents[top] : top);
        }
        // In: the old parent takes the target's place, and boxes grow up to the first that holds n already.
        replace_child(parents[target], target, parent);
        nodes[parent].left = target;
        nodes[parent].right = n;
        parents[target] = parents[n] = parent;
        tighten(parent);
        tighten_up(parents[parent], none);
        return true;
    }
};

double cost_of(const BinaryTree& tree)
{
    double cost = 0;
    for (const BinaryNode& node : tree.nodes)
        cost += node.box.half_area() * double{node.count > 0 ? cost_of_block : cost_of_node};
    return cost;
}

} // namespace

void optimise_by_reinsertion(BinaryTree& tree, uint rounds)
{
    if (rounds == 0 || tree.nodes.size() < 4) return;
    Optimiser optimiser(tree);
    uint done = 0;
    while (done < rounds && optimiser.round()) ++done;
    BinaryTree better = optimiser.result(tree);
    // Only making the tree shallower again can have cost more than was gained.
    if (cost_of(better) <= cost_of(tree)) tree = std::move(better);
}

} // namespace snell
