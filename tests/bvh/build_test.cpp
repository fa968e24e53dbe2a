// From a scene to the layout that is traced: the same for any number of threads, and of bounded size.
#include "snell/bvh/build.h"
#include "snell/bvh/primitives.h"
#include "snell/bvh/wide.h"
#include "snell/core/parallel.h"
#include "tests/bvh/scenes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

namespace snell::test {
namespace {

PackedScene big_scene()
{
    Random random(31);
    PackedScene scene;
    add_soup(scene, random, 90'000, 0.01f);
    add_cloud(scene, random, 3000, 0.01f);
    end_group(scene);
    add_soup(scene, random, 100'000, 0.02f);
    end_world(scene);
    for (int i = 0; i < 9000; ++i) add_instance(scene, 0, translation(3.0f * random.in_box(1.0f)));
    return scene;
}

// Triangles side by side along x, from the numbers of a group of corners.
PackedScene row_of_triangles(std::span<const float> places)
{
    PackedScene scene;
    for (const float x : places) add_triangle(scene, vec3(x, 0, 0), vec3(x + 1, 0, 0), vec3(x, 1, 1));
    end_world(scene);
    return scene;
}

// The surface of a box that holds so many triangles of a scene, from one on.
Box box_of(const PackedScene& scene, uint first, uint count)
{
    Box box;
    for (uint t = first; t < first + count; ++t)
        for (const uint v : {scene.triangles[t].v0, scene.triangles[t].v1, scene.triangles[t].v2})
            box.extend(scene.positions[v]);
    return box;
}

// A random binary tree over the triangles in their order, `leaf` in each leaf.
void grow(BinaryTree& tree, const PackedScene& scene, Random& random, uint first, uint count, uint leaf)
{
    const std::size_t at = tree.nodes.size();
    tree.nodes.push_back({box_of(scene, first, count), 0, 0});
    if (count <= leaf) {
        tree.nodes[at].link = static_cast<uint>(tree.order.size()), tree.nodes[at].count = count;
        for (uint t = first; t < first + count; ++t) tree.order.push_back({t, RefKind::triangle});
        return;
    }
    const uint leaves = count / leaf;
    const uint left = leaf * (1 + static_cast<uint>(random.range(0.0f, 0.999f) * static_cast<float>(leaves - 1)));
    grow(tree, scene, random, first, left, leaf);
    tree.nodes[at].link = static_cast<uint>(tree.nodes.size());
    grow(tree, scene, random, first + left, count - left, leaf);
}

// The least cost of all ways to collapse a subtree into at most so many children, by trying them all.
double least_cost(const BinaryTree& tree, uint index, uint places, uint width)
{
    const BinaryNode& node = tree.nodes[index];
    const double area = node.box.half_area();
    if (node.count > 0) return area * double(wide_block_cost);
    const auto apart = [&](uint all) {
        double least = 1e300;
        for (uint left = 1; left < all; ++left)
            least = std::min(least,
                             least_cost(tree, index + 1, left, width) + least_cost(tree, node.link, all - left, width));
        return least;
    };
    const double as_node = area * double(wide_node_cost) + apart(width);
    return places < 2 ? as_node : std::min(as_node, apart(places));
}

template <class Node>
void expect_least_cost(uint leaves)
{
    Random random(35);
    for (int round = 0; round < 20; ++round) {
        PackedScene scene;
        // Fans of triangles that share vertices: a block of eight holds them, and parts are as large as the whole.
        for (uint leaf = 0; leaf < leaves; ++leaf) {
            const vec3 at = 5.0f * random.in_box(1.0f), u = random.in_box(1.0f), v = random.in_box(1.0f);
            const uint first = static_cast<uint>(scene.positions.size());
            add_triangle(scene, at, at + u, at + v);
            for (uint i = 1; i < max_leaf_size; ++i) {
                scene.triangles.push_back(scene.triangles.back());
                scene.triangles.back().v0 = first;
            }
        }
        end_world(scene);
        BinaryTree tree;
        grow(tree, scene, random, 0, leaves * max_leaf_size, max_leaf_size);
        const WideTree<Node> wide = make_wide_tree<Node>(scene, tree);
        const double least = least_cost(tree, 0, 1, Node::width) / wide.box.half_area();
        EXPECT_NEAR(wide.sah_cost, least, 1e-4 * least);
        EXPECT_EQ(wide.leaves, leaves);
    }
}

template <class Vector>
bool same_bytes(const Vector& a, const Vector& b)
{
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0);
}

template <class Node>
bool same_tree(const WideTree<Node>& a, const WideTree<Node>& b)
{
    return same_bytes(a.nodes, b.nodes) && same_bytes(a.lines, b.lines) && same_bytes(a.spheres, b.spheres) &&
           a.root == b.root && a.stack_size == b.stack_size && a.sah_cost == b.sah_cost && a.leaves == b.leaves;
}

// What a finished tree says of a child: the area of the triangles below, and the expected cost times the box's area.
struct Below8
{
    double surface = 0, cost = 0;
};

// Recomputes both from below, and checks that every node's slots rise by the chance of being blocked for the cost.
Below8 expect_rising_slots(const PackedScene& scene, const WideTree<Node8>& tree, ChildWord word, const Box& box)
{
    Below8 sum;
    if (RefKind(word >> 30) == RefKind::triangle) {
        for (const TriangleBlock* block = &block_at(tree.lines.data(), word & child_index_mask);;
             block = &block_at(reinterpret_cast<const Line*>(block), block->size())) {
            for (uint i = 0; i < block->count; ++i) {
                const Triangle& t = scene.triangles[block->id[i]];
                const vec3 a = scene.positions[t.v0];
                sum.surface += 0.5 * double(length(cross(scene.positions[t.v1] - a, scene.positions[t.v2] - a)));
            }
            sum.cost += box.half_area() * double(wide_block_cost);
            if (!block->more) return sum;
        }
    }
    const Node8& node = tree.nodes[word];
    sum.cost = box.half_area() * double(wide_node_cost);
    double before = 0;
    for (uint slot = 0; slot < 8 && node.child[slot] != tree.no_child; ++slot) {
        Box inner;
        for (int axis = 0; axis < 3; ++axis) {
            inner.lower[axis] = node.planes[2 * axis][slot];
            inner.upper[axis] = node.planes[2 * axis + 1][slot];
        }
        const Below8 below = expect_rising_slots(scene, tree, node.child[slot], inner);
        const double area = inner.half_area(), worth = (1 - std::exp(-below.surface / area)) * area / below.cost;
        EXPECT_GE(worth, before * (1 - 1e-6)) << "node " << word << ", slot " << slot;
        before = worth;
        sum.surface += below.surface;
        sum.cost += below.cost;
    }
    return sum;
}

template <class Node>
void expect_same_for_threads()
{
    const PackedScene scene = big_scene();
    set_thread_count(1);
    const WideBvh<Node> one = make_wide<Node>(scene);
    for (const int threads : {2, 5, 16}) {
        set_thread_count(threads);
        const WideBvh<Node> many = make_wide<Node>(scene);
        EXPECT_TRUE(same_tree(one.world, many.world)) << threads;
        EXPECT_TRUE(same_tree(one.top, many.top)) << threads;
        EXPECT_TRUE(same_tree(one.groups[0], many.groups[0])) << threads;
    }
    set_thread_count(0);
}

TEST(BvhBuild, IsTheSameForAnyNumberOfThreads)
{
    expect_same_for_threads<Node2>();
    expect_same_for_threads<Node8>();
    expect_same_for_threads<QuantisedNode>();
}

// Of all the trees that keep the order of the binary one.
TEST(BvhBuild, WideTreesAreOfLeastCost)
{
    expect_least_cost<Node2>(9);
    expect_least_cost<Node4>(7);
    expect_least_cost<Node4>(9);
    expect_least_cost<Node8>(9);
}

// Children that no ray meets together do not wait in one leaf, and those that fit one block do not take two.
TEST(BvhBuild, LeavesArePartedAndJoined)
{
    Random random(36);
    const float apart[] = {0, 50, 1, 51, 100, 150, 101, 151}; // two leaves, each of two places
    PackedScene scene = row_of_triangles(apart);
    BinaryTree tree;
    grow(tree, scene, random, 0, 8, 4);
    const WideTree<Node8> parted = make_wide_tree<Node8>(scene, tree);
    EXPECT_EQ(parted.leaves, 4u);
    EXPECT_EQ(parted.nodes.size(), 1u);
    for (uint i = 0; i < 4; ++i) {
        EXPECT_LT(parted.nodes[0].planes[1][i] - parted.nodes[0].planes[0][i], 2.5f);
        EXPECT_EQ(block_at(parted.lines.data(), parted.nodes[0].child[i] & child_index_mask).count, 2u);
    }
    EXPECT_EQ(make_wide_tree<Node2>(scene, tree).leaves, 2u); // has no places for more

    // Four leaves of one triangle, all in the same place.
    PackedScene near = row_of_triangles(std::vector<float>(4, 0.0f));
    tree = {};
    grow(tree, near, random, 0, 4, 1);
    const WideTree<Node8> joined = make_wide_tree<Node8>(near, tree);
    EXPECT_EQ(joined.leaves, 1u);
    EXPECT_EQ(joined.nodes.size(), 0u);
    EXPECT_EQ(block_at(joined.lines.data(), 0).count, 4u);
    EXPECT_NEAR(joined.sah_cost, double(wide_block_cost), 1e-6);
    // Six of them have more vertices than a block.
    near = row_of_triangles(std::vector<float>(6, 0.0f));
    tree = {};
    grow(tree, near, random, 0, 6, 1);
    EXPECT_GT(make_wide_tree<Node8>(near, tree).leaves, 1u);
}

// Whatever becomes of leaves: each triangle is in one block, and its leaf's box holds it.
TEST(BvhBuild, BlocksHoldEachTriangleOnce)
{
    Random random(37);
    PackedScene scene;
    add_soup(scene, random, 3000, 0.3f);
    add_grid(scene, 40, 0.3f);
    end_world(scene);
    for (const char* builder : {"binned", "lbvh", "ploc"}) {
        BuildOptions options;
        options.builder = builder;
        const WideTree<Node8> tree = make_group_tree<Node8>(scene, scene.world, options);
        std::vector<int> seen(scene.triangles.size());
        for (const Node8& node : tree.nodes)
            for (uint slot = 0; slot < 8; ++slot) {
                if (node.child[slot] >> 30 != uint(RefKind::triangle) || node.child[slot] == tree.no_child) continue;
                std::size_t index = node.child[slot] & child_index_mask;
                for (bool more = true; more;) {
                    const TriangleBlock& block = block_at(tree.lines.data(), index);
                    for (uint lane = 0; lane < block.count; ++lane) {
                        ++seen[block.id[lane]];
                        const Box box = box_of(scene, block.id[lane], 1);
                        for (int axis = 0; axis < 3; ++axis) {
                            EXPECT_LE(node.planes[2 * axis][slot], box.lower[axis]);
                            EXPECT_GE(node.planes[2 * axis + 1][slot], box.upper[axis]);
                        }
                    }
                    more = block.more != 0;
                    index += block.size();
                }
            }
        for (const int times : seen) EXPECT_EQ(times, 1) << builder;
    }
}

TEST(BvhBuild, LeavesOutWhatHasNoPlace)
{
    PackedScene scene;
    Random random(33);
    add_soup(scene, random, 30, 0.5f);
    scene.positions[0].x = std::nanf("");
    scene.positions[10].y = infinity();
    scene.positions[20].z = -infinity();
    add_sphere(scene, vec3(std::nanf("")), 1.0f);
    add_sphere(scene, vec3(0.0f), infinity());
    add_sphere(scene, vec3(0.0f), 1.0f);
    end_world(scene);
    EXPECT_EQ(collect_primitives(scene, scene.world).size(), 27u + 1u);
}

TEST(BvhBuild, Statistics)
{
    const PackedScene scene = big_scene();
    const auto accel = accels().front().make(scene, {});
    EXPECT_GT(accel->stats.build_seconds, 0.0);
    EXPECT_GT(accel->stats.nodes, 4000u);
    EXPECT_GT(accel->stats.leaves, accel->stats.nodes);
    EXPECT_GT(accel->stats.sah_cost, 1.0);
    const double bytes = static_cast<double>(accel->stats.bytes) / static_cast<double>(scene.triangles.size());
    EXPECT_LT(bytes, 120.0); // a soup shares no vertices
    EXPECT_GT(bytes, 30.0);

    PackedScene empty;
    const auto nothing = accels().front().make(empty, {});
    EXPECT_EQ(nothing->stats.nodes, 0u);
    EXPECT_EQ(nothing->stats.sah_cost, 0.0);
}

TEST(AccelRegistry, FindsByName)
{
    for (const AccelInfo& info : accels()) {
        ASSERT_NE(find_accel(info.name), nullptr);
        EXPECT_EQ(find_accel(info.name)->name, info.name);
        EXPECT_FALSE(info.summary.empty());
    }
    EXPECT_EQ(accels().front().name, "bvh8");
    EXPECT_EQ(find_accel("no such thing"), nullptr);
}

// Large triangles before small ones, whatever the builder did: enough of them for parts that threads make apart.
TEST(BvhBuild, SlotsRiseByWhatTheyBlock)
{
    Random random(37);
    PackedScene scene;
    add_soup(scene, random, 60'000, 0.01f);
    add_soup(scene, random, 300, 0.2f);
    end_world(scene);
    const WideTree<Node8> tree = make_wide<Node8>(scene).world;
    ASSERT_LE(tree.root, child_index_mask);
    const Below8 all = expect_rising_slots(scene, tree, tree.root, tree.box);
    EXPECT_NEAR(all.cost / tree.box.half_area(), tree.sah_cost, 1e-4 * tree.sah_cost); // the same sums
}

} // namespace
} // namespace snell::test
