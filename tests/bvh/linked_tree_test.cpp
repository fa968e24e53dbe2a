// Trees in any order of nodes, put depth first.
#include "snell/bvh/linked_tree.h"
#include "snell/bvh/primitives.h"
#include "snell/core/parallel.h"
#include "tests/bvh/scenes.h"
#include "tests/bvh/tree_checks.h"

#include <gtest/gtest.h>

#include <numeric>

namespace snell::test {
namespace {

// References to unit boxes at random places, of the given kind.
std::vector<PrimitiveRef> random_refs(Random& random, uint count, RefKind kind = RefKind::triangle)
{
    std::vector<PrimitiveRef> refs;
    for (uint i = 0; i < count; ++i) {
        const vec3 at = random.in_box(100.0f);
        refs.push_back({at, i, at + vec3(1.0f), kind});
    }
    return refs;
}

struct Linked
{
    std::vector<LinkedNode> nodes;
    std::vector<BinaryTree::Entry> order;
    uint root = 0;

    BinaryTree depth_first() const { return make_depth_first(nodes, root, order); }
};

// One leaf each, not in the order of the references.
Linked leaves_of(const std::vector<PrimitiveRef>& refs)
{
    Linked linked;
    const uint count = static_cast<uint>(refs.size());
    for (uint i = 0; i < count; ++i) linked.order.push_back({refs[count - 1 - i].index, refs[count - 1 - i].kind});
    for (uint i = 0; i < count; ++i)
        linked.nodes.push_back({{refs[count - 1 - i].lower, refs[count - 1 - i].upper}, i, 0, 1});
    return linked;
}

uint join(Linked& linked, uint a, uint b)
{
    Box box = linked.nodes[a].box;
    box.extend(linked.nodes[b].box);
    linked.nodes.push_back({box, a, b, 0});
    return static_cast<uint>(linked.nodes.size() - 1);
}

// Joins random pairs until one is left.
Linked random_tree(const std::vector<PrimitiveRef>& refs, Random& random)
{
    Linked linked = leaves_of(refs);
    std::vector<uint> roots(refs.size());
    std::iota(roots.begin(), roots.end(), 0u);
    while (roots.size() > 1) {
        const auto take = [&] {
            std::swap(roots[random.bits() % roots.size()], roots.back());
            const uint taken = roots.back();
            roots.pop_back();
            return taken;
        };
        const uint a = take(), b = take();
        roots.push_back(join(linked, a, b));
    }
    linked.root = roots.front();
    return linked;
}

// Every node has a leaf as its one child.
Linked chain(const std::vector<PrimitiveRef>& refs)
{
    Linked linked = leaves_of(refs);
    for (uint i = 1; i < refs.size(); ++i) linked.root = join(linked, i % 2 ? linked.root : i, i % 2 ? i : linked.root);
    return linked;
}

// Moves the nodes to other places without changing the tree.
Linked shuffled(const Linked& tree, Random& random)
{
    std::vector<uint> place(tree.nodes.size());
    std::iota(place.begin(), place.end(), 0u);
    for (std::size_t i = place.size(); i > 1; --i) std::swap(place[i - 1], place[random.bits() % i]);
    Linked result;
    result.order = tree.order;
    result.root = place[tree.root];
    result.nodes.resize(tree.nodes.size());
    for (std::size_t i = 0; i < place.size(); ++i) {
        LinkedNode node = tree.nodes[i];
        if (node.count == 0) node.left = place[node.left], node.right = place[node.right];
        result.nodes[place[i]] = node;
    }
    return result;
}

TEST(LinkedTree, RandomTreesStaySound)
{
    Random random(71);
    for (const uint count : {1u, 2u, 3u, 4u, 5u, 6u, 9u, 50u, 3000u}) {
        SCOPED_TRACE(count);
        std::vector<PrimitiveRef> refs = random_refs(random, count);
        const Linked pure = random_tree(refs, random);
        expect_sound_tree(refs, pure.depth_first());
        EXPECT_TRUE(same_tree(pure.depth_first(), shuffled(pure, random).depth_first()));
        for (PrimitiveRef& ref : refs) ref.kind = RefKind(1 + random.bits() % 3);
        expect_sound_tree(refs, random_tree(refs, random).depth_first());
    }
    EXPECT_TRUE(make_depth_first({}, 0, {}).nodes.empty());
}

// Which entries lie below which, without the nodes that became leaves: none may be torn apart.
TEST(LinkedTree, SubtreesStay)
{
    Random random(72);
    const std::vector<PrimitiveRef> refs = random_refs(random, 2000);
    const Linked linked = random_tree(refs, random);
    const BinaryTree tree = linked.depth_first();
    // The place in the order of each entry, and for each subtree the first and last place: they must be neighbours.
    std::vector<uint> place(refs.size());
    for (uint i = 0; i < tree.order.size(); ++i) place[tree.order[i].index] = i;
    struct Span
    {
        uint first, last, count;
    };
    std::vector<Span> spans;
    std::size_t large = 0;
    for (const LinkedNode& node : linked.nodes) { // children before parents
        if (node.count > 0) {
            const uint p = place[linked.order[node.left].index];
            spans.push_back({p, p, 1});
            continue;
        }
        const Span a = spans[node.left], b = spans[node.right];
        spans.push_back({std::min(a.first, b.first), std::max(a.last, b.last), a.count + b.count});
        large += spans.back().count > max_leaf_size;
        EXPECT_EQ(spans.back().last - spans.back().first + 1, spans.back().count);
    }
    // One kind only: whatever could become a leaf did, and nothing else.
    std::size_t inner = 0;
    for (const BinaryNode& node : tree.nodes) inner += node.count == 0;
    EXPECT_EQ(inner, large);
}

TEST(LinkedTree, InstancesAndKindsKeepTheirLeaves)
{
    Random random(73);
    const auto leaf_sizes = [&](std::vector<RefKind> kinds) {
        std::vector<PrimitiveRef> refs = random_refs(random, static_cast<uint>(kinds.size()));
        for (std::size_t i = 0; i < kinds.size(); ++i) refs[kinds.size() - 1 - i].kind = kinds[i];
        const BinaryTree tree = chain(refs).depth_first();
        expect_sound_tree(refs, tree);
        std::vector<uint> sizes;
        for (const BinaryNode& node : tree.nodes)
            if (node.count > 0) sizes.push_back(node.count);
        std::ranges::sort(sizes);
        return sizes;
    };
    constexpr RefKind t = RefKind::triangle, s = RefKind::sphere, i = RefKind::instance;
    using Sizes = std::vector<uint>;
    EXPECT_EQ(leaf_sizes(std::vector(max_leaf_size, t)), (Sizes{max_leaf_size}));
    EXPECT_EQ(leaf_sizes(std::vector(max_leaf_size + 1, t)), (Sizes{1, max_leaf_size}));
    EXPECT_EQ(leaf_sizes({s, s, s}), (Sizes{3}));
    EXPECT_EQ(leaf_sizes({t, t, s, s}), (Sizes{1, 1, 2}));
    EXPECT_EQ(leaf_sizes({i, i, i}), (Sizes{1, 1, 1}));
}

TEST(LinkedTree, ChainsAreBounded)
{
    Random random(74);
    for (const uint count : {90u, 99u, 100u, 101u, 102u, 150u, 1000u, 200'000u}) {
        SCOPED_TRACE(count);
        const std::vector<PrimitiveRef> refs = random_refs(random, count, RefKind::sphere);
        const BinaryTree tree = chain(refs).depth_first();
        expect_sound_tree(refs, tree);
        // Those at the end are a leaf; what fits stays the chain it was; the rest is halved.
        const int chain_depth = static_cast<int>(count - max_leaf_size);
        if (chain_depth <= max_tree_depth - 10)
            EXPECT_EQ(tree_depth(tree), chain_depth);
        else
            EXPECT_LE(tree_depth(tree), max_tree_depth);
    }
}

// Trees with spatial splits: two leaves of the same primitive become one with a single entry.
TEST(LinkedTree, RepeatedEntriesMerge)
{
    Linked linked;
    linked.order = {{7, RefKind::triangle}, {9, RefKind::triangle}, {7, RefKind::triangle}, {5, RefKind::triangle}};
    const Box box{vec3(0.0f), vec3(1.0f)};
    linked.nodes = {{box, 0, 0, 2}, {box, 2, 0, 2}, {box, 0, 1, 0}};
    linked.root = 2;
    const BinaryTree tree = linked.depth_first();
    ASSERT_EQ(tree.nodes.size(), 1u);
    EXPECT_EQ(tree.nodes[0].count, 3u);
    ASSERT_EQ(tree.order.size(), 3u);
    EXPECT_EQ(tree.order[0].index, 7u);
    EXPECT_EQ(tree.order[1].index, 9u);
    EXPECT_EQ(tree.order[2].index, 5u);
}

TEST(LinkedTree, SameForAnyThreadCount)
{
    Random random(75);
    const std::vector<PrimitiveRef> refs = random_refs(random, 60'000);
    for (const Linked& linked : {random_tree(refs, random), chain(refs)}) {
        set_thread_count(1);
        const BinaryTree alone = linked.depth_first();
        for (const int threads : {2, 5, 16}) {
            set_thread_count(threads);
            EXPECT_TRUE(same_tree(alone, linked.depth_first())) << threads;
        }
        set_thread_count(0);
    }
}

TEST(LinkedTree, ThereAndBackAgain)
{
    Random random(76);
    PackedScene scene;
    add_soup(scene, random, 20'000, 0.1f);
    add_cloud(scene, random, 1000, 0.1f);
    end_world(scene);
    const std::vector<PrimitiveRef> refs = collect_primitives(scene, scene.world);
    const BinaryTree tree = build_binned_sah(scene, refs, {});
    const std::vector<LinkedNode> linked = make_linked(tree);
    ASSERT_EQ(linked.size(), tree.nodes.size());
    for (std::size_t i = 0; i < linked.size(); ++i) {
        EXPECT_EQ(linked[i].count, tree.nodes[i].count);
        EXPECT_EQ(linked[i].box.lower, tree.nodes[i].box.lower);
        EXPECT_EQ(linked[i].count > 0 ? linked[i].left : linked[i].right, tree.nodes[i].link);
    }
    const BinaryTree again = make_depth_first(linked, 0, tree.order);
    expect_sound_tree(refs, again);
    EXPECT_LE(tree_cost(again), tree_cost(tree) * (1 + 1e-12));
    EXPECT_TRUE(same_tree(again, make_depth_first(make_linked(again), 0, again.order)));
}

} // namespace
} // namespace snell::test
