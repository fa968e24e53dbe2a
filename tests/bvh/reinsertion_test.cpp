// Reinsertion: trees stay sound, never cost more, are the same for any number of threads, and end where no single move
// would help.
#include "snell/bvh/build.h"
#include "snell/bvh/linked_tree.h"
#include "snell/bvh/primitives.h"
#include "snell/bvh/quality.h"
#include "snell/core/parallel.h"
#include "snell/scene/keyframes.h"
#include "tests/bvh/scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <map>
#include <string>

namespace snell::test {
namespace {

using Entry = BinaryTree::Entry;

bool contains(const Box& outer, const Box& inner)
{
    for (int axis = 0; axis < 3; ++axis)
        if (!(outer.lower[axis] <= inner.lower[axis] && inner.upper[axis] <= outer.upper[axis])) return false;
    return true;
}

double sah(const BinaryTree& tree)
{
    return measure_quality({}, tree, false).sah;
}

// Leaves within the rules, inner boxes exactly around their children's, depth bounded.
void expect_well_formed(const BinaryTree& tree)
{
    std::size_t met = 0;
    const std::function<void(uint, int)> visit = [&](uint at, int depth) {
        ASSERT_LT(at, tree.nodes.size());
        ASSERT_LE(depth, max_tree_depth);
        ++met;
        const BinaryNode& node = tree.nodes[at];
        if (node.count > 0) {
            ASSERT_LE(node.count, max_leaf_size);
            ASSERT_LE(node.link + node.count, tree.order.size());
            for (uint i = 1; i < node.count; ++i) {
                EXPECT_EQ(tree.order[node.link + i].kind, tree.order[node.link].kind);
                EXPECT_NE(tree.order[node.link + i].kind, RefKind::instance);
            }
            return;
        }
        visit(at + 1, depth + 1);
        visit(node.link, depth + 1);
        Box below = tree.nodes[at + 1].box;
        below.extend(tree.nodes[node.link].box);
        EXPECT_EQ(below.lower, node.box.lower);
        EXPECT_EQ(below.upper, node.box.upper);
    };
    visit(0, 0);
    EXPECT_EQ(met, tree.nodes.size());
}

std::map<std::pair<RefKind, uint>, std::vector<Box>> leaves_of(const BinaryTree& tree)
{
    std::map<std::pair<RefKind, uint>, std::vector<Box>> found;
    for (const BinaryNode& node : tree.nodes)
        for (uint i = 0; i < node.count; ++i) {
            const Entry& entry = tree.order[node.link + i];
            found[{entry.kind, entry.index}].push_back(node.box);
        }
    return found;
}

// Whoever was in a leaf still is in one that holds the old one's box; nobody has come in addition.
void expect_same_content(const BinaryTree& before, const BinaryTree& after)
{
    const auto old = leaves_of(before), now = leaves_of(after);
    ASSERT_EQ(old.size(), now.size());
    for (const auto& [who, boxes] : old) {
        const auto found = now.find(who);
        ASSERT_NE(found, now.end());
        EXPECT_LE(found->second.size(), boxes.size());
        for (const Box& box : boxes)
            EXPECT_TRUE(std::any_of(found->second.begin(), found->second.end(),
                                    [&](const Box& leaf) { return contains(leaf, box); }));
    }
}

void expect_sound_pass(const BinaryTree& before, uint rounds)
{
    BinaryTree after = before;
    optimise_by_reinsertion(after, rounds);
    if (before.nodes.empty()) {
        EXPECT_TRUE(after.nodes.empty());
        return;
    }
    expect_well_formed(after);
    expect_same_content(before, after);
    EXPECT_LE(sah(after), sah(before) * (1 + 1e-12));
}

// ---- trees of instances, which never share a leaf, so that the tree's shape is what moves make of it ----

// Appends a node over two others.
uint join_nodes(std::vector<LinkedNode>& nodes, uint a, uint b)
{
    Box box = nodes[a].box;
    box.extend(nodes[b].box);
    nodes.push_back({box, a, b, 0});
    return static_cast<uint>(nodes.size()) - 1;
}

// Joins two random subtrees until there is one.
BinaryTree random_tree(const std::vector<Box>& boxes, Random& random)
{
    std::vector<LinkedNode> nodes;
    std::vector<Entry> order;
    std::vector<uint> roots;
    for (uint i = 0; i < boxes.size(); ++i) {
        nodes.push_back({boxes[i], i, 0, 1});
        order.push_back({i, RefKind::instance});
        roots.push_back(i);
    }
    while (roots.size() > 1) {
        const auto take = [&] {
            const std::size_t at = random.bits() % roots.size();
            const uint node = roots[at];
            roots[at] = roots.back();
            roots.pop_back();
            return node;
        };
        const uint a = take(), b = take();
        roots.push_back(join_nodes(nodes, a, b));
    }
    return make_depth_first(nodes, roots.front(), order);
}

Box cube(vec3 center, float half)
{
    return {center - half, center + half};
}

std::vector<Box> random_boxes(Random& random, int count, float size)
{
    std::vector<Box> boxes;
    for (int i = 0; i < count; ++i) {
        const vec3 at = random.in_box(1.0f);
        Box box;
        box.extend(at + random.in_box(size));
        box.extend(at + random.in_box(size));
        boxes.push_back(box);
    }
    return boxes;
}

// Of three neighbours, one is in the tree of two others far away.
TEST(Reinsertion, BringsNeighboursTogether)
{
    std::vector<LinkedNode> nodes;
    std::vector<Entry> order;
    for (const vec3 center : {vec3(0, 0, 0), vec3(0, 2, 0), vec3(0, 4, 0), vec3(100, 0, 0), vec3(100, 2, 0)}) {
        nodes.push_back({cube(center, 0.5f), static_cast<uint>(order.size()), 0, 1});
        order.push_back({static_cast<uint>(order.size()), RefKind::instance});
    }
    const auto join = [&](uint a, uint b) { return join_nodes(nodes, a, b); };
    const uint left = join(0, 1), right = join(2, join(3, 4));
    BinaryTree tree = make_depth_first(nodes, join(left, right), order);
    // Half areas: the root, and the three that are torn apart, 101 * 5 + 5 + 101 = 611; a pair 3 + 3 + 1 = 7; three
    // neighbours 5 + 5 + 1 = 11; a cube 3.
    EXPECT_DOUBLE_EQ(sah(tree), (611 + 611 + 7 + 7 + 5 * 3) / 611.0);
    optimise_by_reinsertion(tree, 1);
    expect_well_formed(tree);
    EXPECT_DOUBLE_EQ(sah(tree), (611 + 11 + 7 + 7 + 5 * 3) / 611.0);
}

// A large box deep among small ones belongs beside all of them, which is one move: beside the root.
TEST(Reinsertion, PullsLargeOnesUp)
{
    constexpr uint count = 256;
    std::vector<LinkedNode> nodes;
    std::vector<Entry> order;
    std::vector<uint> level;
    for (uint i = 0; i < count; ++i) {
        nodes.push_back({cube(vec3(2.0f * static_cast<float>(i), 0, 0), 0.5f), i, 0, 1});
        order.push_back({i, RefKind::instance});
        level.push_back(i);
    }
    nodes[100].box = cube(vec3(static_cast<float>(count), 0, 0), 2.0f * static_cast<float>(count));
    while (level.size() > 1) {
        std::vector<uint> next;
        for (std::size_t i = 0; i + 1 < level.size(); i += 2) next.push_back(join_nodes(nodes, level[i], level[i + 1]));
        level = next;
    }
    BinaryTree tree = make_depth_first(nodes, level.front(), order);
    const double before = sah(tree);
    optimise_by_reinsertion(tree, 1);
    expect_well_formed(tree);
    const BinaryNode &a = tree.nodes[1], &b = tree.nodes[tree.nodes[0].link];
    EXPECT_TRUE((a.count > 0 && tree.order[a.link].index == 100) || (b.count > 0 && tree.order[b.link].index == 100));
    EXPECT_LT(sah(tree), before - 6.9); // seven of the eight ancestors are rid of it
}

// The inner surface that taking n out and putting it beside the target would save, from the definition.
double brute_gain(const std::vector<LinkedNode>& nodes, uint n, uint target)
{
    const std::function<bool(uint, uint)> below = [&](uint at, uint what) -> bool {
        return at == what || (nodes[at].count == 0 && (below(nodes[at].left, what) || below(nodes[at].right, what)));
    };
    if (below(n, target) || n == 0) return 0;
    // Costs of the tree as it is and as it would be: the box of a subtree without n, and with n where it belongs.
    double before = 0, after = 0;
    const std::function<Box(uint)> visit = [&](uint at) -> Box {
        Box box;
        if (nodes[at].count > 0) {
            box = at == n ? Box() : nodes[at].box;
        } else {
            before += nodes[at].box.half_area();
            if (at != n) {
                const bool removed = nodes[at].left == n || nodes[at].right == n;
                box = visit(nodes[at].left);
                box.extend(visit(nodes[at].right));
                if (!removed) after += box.half_area();
            }
        }
        if (at == target) {
            box.extend(nodes[n].box);
            after += box.half_area();
        }
        return box;
    };
    visit(0);
    // The inner nodes below n were not met on either side, n itself on one.
    if (nodes[n].count == 0) before -= nodes[n].box.half_area();
    return before - after;
}

// Rounds until nothing changes leave no move that would gain: the search misses none.
TEST(Reinsertion, EndsWhereNoMoveGains)
{
    Random random(91);
    int improved = 0;
    for (int trial = 0; trial < 60; ++trial) {
        SCOPED_TRACE("trial " + std::to_string(trial) + " of seed 91");
        const int count = 4 + static_cast<int>(random.bits() % 30);
        const BinaryTree before = random_tree(random_boxes(random, count, trial % 3 == 0 ? 0.02f : 0.5f), random);
        BinaryTree after = before;
        optimise_by_reinsertion(after, 1000);
        improved += sah(after) < 0.999 * sah(before);
        const std::vector<LinkedNode> nodes = make_linked(after);
        const double whole = after.nodes[0].box.half_area();
        std::vector<uint> parents(nodes.size(), none);
        for (uint i = 0; i < nodes.size(); ++i)
            if (nodes[i].count == 0) parents[nodes[i].left] = parents[nodes[i].right] = i;
        for (uint n = 1; n < nodes.size(); ++n)
            for (uint target = 0; target < nodes.size(); ++target)
                if (target != parents[n]) {
                    ASSERT_LE(brute_gain(nodes, n, target), 1e-5 * whole) << n << " to " << target;
                }
    }
    EXPECT_GT(improved, 50);
}

TEST(Reinsertion, AnyTreeStaysSound)
{
    Random random(92);
    for (int trial = 0; trial < 300; ++trial) {
        SCOPED_TRACE("trial " + std::to_string(trial) + " of seed 92");
        const int count = 1 + static_cast<int>(random.bits() % 60);
        std::vector<Box> boxes = random_boxes(random, count, std::exp2(random.range(-8.0f, 1.0f)));
        const int kind = trial % 6;
        for (Box& box : boxes) {
            if (kind == 1) box.upper.z = box.lower.z = 0.25f;                        // flat
            if (kind == 2) box = cube(vec3(0.5f), 0.5f);                             // all the same
            if (kind == 3) box.upper = box.lower;                                    // points
            if (kind == 4) box = {box.lower * 1e30f, box.upper * 1e30f};             // no square of it is finite
            if (kind == 5) box = {1e9f + 1e3f * box.lower, 1e9f + 1e3f * box.upper}; // few bits left
        }
        expect_sound_pass(random_tree(boxes, random), 1 + trial % 5);
    }
}

// ---- trees of builders ----

struct Named
{
    std::string name;
    PackedScene scene;
};

std::vector<Named> small_scenes()
{
    std::vector<Named> all;
    const auto begin = [&](const char* name) -> PackedScene& { return all.emplace_back(Named{name, {}}).scene; };
    Random random(93);
    for (const int count : {0, 1, 2, 5, 9, 30}) {
        PackedScene& few = begin("few");
        add_soup(few, random, count, 0.5f);
        end_world(few);
    }
    PackedScene& soup = begin("soup");
    add_soup(soup, random, 3000, 0.1f);
    end_world(soup);

    PackedScene& grids = begin("grids");
    add_grid(grids, 16, 0.0f);
    add_grid(grids, 16, 0.0f); // everything twice
    add_grid(grids, 5, 0.5f);
    end_world(grids);

    PackedScene& mixed = begin("mixed");
    add_soup(mixed, random, 400, 0.2f);
    add_grid(mixed, 6, 0.1f);
    add_cloud(mixed, random, 150, 0.1f);
    end_group(mixed);
    add_cloud(mixed, random, 30, 0.3f);
    end_group(mixed);
    add_soup(mixed, random, 500, 0.4f);
    add_cloud(mixed, random, 100, 0.2f);
    end_world(mixed);
    for (uint i = 0; i < 60; ++i)
        add_instance(mixed, i % 2,
                     compose_trs(2.0f * random.in_box(1.0f), vec4(0, 0, 0, 1), vec3(random.range(0.1f, 0.6f))));

    PackedScene& slivers = begin("slivers");
    for (int i = 0; i < 400; ++i) {
        const vec3 a = random.in_box(1.0f), b = random.in_box(1.0f);
        add_triangle(slivers, a, b, 0.5f * (a + b) + random.in_box(1e-4f));
    }
    for (int i = 0; i < 40; ++i) add_triangle(slivers, vec3(0.3f), vec3(0.3f), vec3(0.3f));
    end_world(slivers);

    PackedScene& same = begin("one centre");
    for (int i = 0; i < 300; ++i) {
        const vec3 a = std::exp2(random.range(-10.0f, 0.0f)) * random.direction();
        const vec3 b = cross(a, random.direction());
        add_triangle(same, a + b, -a, a - b);
    }
    end_world(same);

    PackedScene& far = begin("far away");
    add_soup(far, random, 600, 0.2f);
    for (vec3& p : far.positions) p = 1e9f + 1e4f * p;
    end_world(far);

    PackedScene& doubling = begin("doubling");
    for (int i = 0; i < 240; ++i) {
        const float x = std::exp2(static_cast<float>(i % 120) - 60.0f) * (i % 2 ? 1.0f : -1.0f);
        add_triangle(doubling, vec3(x, 0, 0), vec3(x, 1, 0), vec3(x, 0, 1));
    }
    end_world(doubling);
    return all;
}

TEST(Reinsertion, TreesOfAllBuildersStaySound)
{
    for (const Named& named : small_scenes())
        for (const BuilderInfo& builder : builders()) {
            SCOPED_TRACE(named.name + ", " + std::string(builder.name));
            const PackedScene& scene = named.scene;
            std::vector<Box> boxes;
            for (const PackedGroup& group : scene.groups) {
                const BinaryTree tree = builder.build(scene, collect_primitives(scene, group), {});
                expect_sound_pass(tree, 3);
                boxes.push_back(tree.nodes[0].box);
            }
            std::vector<PrimitiveRef> refs = collect_primitives(scene, scene.world);
            collect_instances(scene, boxes, refs);
            expect_sound_pass(builder.build(scene, refs, {}), 3);
        }
}

TEST(Reinsertion, HitsAreThoseOfBruteForce)
{
    for (const Named& named : small_scenes()) {
        const PackedScene& scene = named.scene;
        Random random(94);
        const bool far = named.name == "far away";
        std::vector<Ray> rays = far ? random_rays(random, 300, 1e4f, vec3(1e9f)) : random_rays(random, 300);
        const std::vector<Ray> hostile = hostile_rays(scene, random);
        rays.insert(rays.end(), hostile.begin(), hostile.end());
        std::vector<Hit> expected(rays.size()), hits(rays.size());
        find_accel("brute")->make(scene, {})->intersect(rays, expected);
        for (const BuilderInfo& builder : builders()) {
            SCOPED_TRACE(named.name + ", " + std::string(builder.name));
            AccelOptions options;
            options.build.builder = builder.name;
            options.build.reinsertion = 3;
            find_accel("bvh8")->make(scene, options)->intersect(rays, hits);
            for (std::size_t i = 0; i < rays.size(); ++i)
                ASSERT_EQ(std::memcmp(&hits[i], &expected[i], sizeof(Hit)), 0)
                    << "ray " << i << ": t " << hits[i].t << " primitive " << hits[i].primitive << ", expected "
                    << expected[i].t << " primitive " << expected[i].primitive;
        }
    }
}

// Long triangles across a soup: what builders that look at centres do badly.
PackedScene large_scene()
{
    Random random(95);
    PackedScene scene;
    add_soup(scene, random, 50'000, 0.02f);
    add_soup(scene, random, 200, 0.8f);
    add_cloud(scene, random, 2000, 0.02f);
    end_world(scene);
    return scene;
}

template <class Vector>
bool same_bytes(const Vector& a, const Vector& b)
{
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0);
}

TEST(Reinsertion, TheSameForAnyNumberOfThreads)
{
    const PackedScene scene = large_scene();
    const BinaryTree before = build_lbvh(scene, collect_primitives(scene, scene.world), {});
    set_thread_count(1);
    BinaryTree one = before;
    optimise_by_reinsertion(one, 3);
    EXPECT_FALSE(same_bytes(one.nodes, before.nodes));
    for (const int threads : {2, 5, 16}) {
        set_thread_count(threads);
        BinaryTree many = before;
        optimise_by_reinsertion(many, 3);
        EXPECT_TRUE(same_bytes(one.nodes, many.nodes)) << threads;
        EXPECT_TRUE(same_bytes(one.order, many.order)) << threads;
    }
    set_thread_count(0);
}

TEST(Reinsertion, EachPassCostsNoMoreAndTheFirstGainsMuch)
{
    const PackedScene scene = large_scene();
    BuildOptions options;
    options.builder = "lbvh";
    const std::vector<PrimitiveRef> refs = collect_primitives(scene, scene.world);
    const BinaryTree start = build_tree(scene, refs, options);
    BinaryTree tree = start;
    double cost = sah(tree);
    const double first = cost;
    for (int pass = 0; pass < 4; ++pass) {
        optimise_by_reinsertion(tree, 1);
        EXPECT_LE(sah(tree), cost);
        cost = sah(tree);
    }
    EXPECT_LT(cost, 0.85 * first);
    expect_well_formed(tree);
    expect_same_content(start, tree);

    options.reinsertion = 2; // the builders' interface runs the same pass
    BinaryTree expected = start;
    optimise_by_reinsertion(expected, 2);
    EXPECT_TRUE(same_bytes(build_tree(scene, refs, options).nodes, expected.nodes));
}

TEST(Reinsertion, NoRoundsNoChange)
{
    const PackedScene scene = large_scene();
    const BinaryTree before = build_lbvh(scene, collect_primitives(scene, scene.world), {});
    BinaryTree after = before;
    optimise_by_reinsertion(after, 0);
    EXPECT_TRUE(same_bytes(before.nodes, after.nodes));
}

// A chain as deep as trees may be, of boxes that all overlap: searches are long, and trees grow deeper at first.
TEST(Reinsertion, ChainsAndOverlapTakeNoForeverAndStayShallow)
{
    Random random(96);
    std::vector<LinkedNode> nodes;
    std::vector<Entry> order;
    const auto leaf = [&](Box box) {
        nodes.push_back({box, static_cast<uint>(order.size()), 0, 1});
        order.push_back({static_cast<uint>(order.size()), RefKind::instance});
        return static_cast<uint>(nodes.size()) - 1;
    };
    uint root = leaf(cube(vec3(0.0f), 1e-6f));
    for (int i = 1; i < 95; ++i) {
        const float x = std::exp2(0.5f * static_cast<float>(i) - 20.0f);
        const uint other = leaf(cube(vec3(i % 2 ? x : -x, 0, 0), 0.1f * x));
        root = join_nodes(nodes, root, other);
    }
    expect_sound_pass(make_depth_first(nodes, root, order), 20);

    std::vector<Box> crossing; // long boxes through the middle
    for (int i = 0; i < 4000; ++i) {
        Box box;
        box.extend(random.in_box(1.0f));
        box.extend(-box.lower + random.in_box(0.1f));
        crossing.push_back(box);
    }
    expect_sound_pass(random_tree(crossing, random), 2);
}

} // namespace
} // namespace snell::test
