// Measures of trees: cases worked out by hand, and brute force over all pairs of a node and a triangle.
#include "snell/bvh/quality.h"

#include "snell/bvh/build.h"
#include "snell/bvh/primitives.h"
#include "snell/core/parallel.h"
#include "tests/bvh/scenes.h"

#include <gtest/gtest.h>

#include <functional>
#include <set>

namespace snell::test {
namespace {

using Entry = BinaryTree::Entry;

Box box_of(vec3 lower, vec3 upper)
{
    return {lower, upper};
}

// Two squares that cross, as a tree of two leaves. In the z = 0 plane the square [0,2]^2; in the x = 1 plane the
// square with y and z in [0, 1].
//   root: box [0,2]x[0,2]x[0,1], half area 2*2 + 2*1 + 1*2 = 8
//   left leaf (the first square): half area 4; of the second square it has only an edge
//   right leaf, made larger on purpose, [0,1]x[0,2]x[0,1]: half area 2 + 2 + 1 = 5; it has half of the first square, 2
// Together the squares have a surface of 5.
PackedScene crossing_squares()
{
    PackedScene scene;
    add_triangle(scene, vec3(0, 0, 0), vec3(2, 0, 0), vec3(2, 2, 0));
    add_triangle(scene, vec3(0, 0, 0), vec3(2, 2, 0), vec3(0, 2, 0));
    add_triangle(scene, vec3(1, 0, 0), vec3(1, 1, 0), vec3(1, 1, 1));
    add_triangle(scene, vec3(1, 0, 0), vec3(1, 1, 1), vec3(1, 0, 1));
    end_world(scene);
    return scene;
}

BinaryTree crossing_tree()
{
    BinaryTree tree;
    tree.nodes = {{box_of(vec3(0), vec3(2, 2, 1)), 2, 0},
                  {box_of(vec3(0), vec3(2, 2, 0)), 0, 2},
                  {box_of(vec3(0), vec3(1, 2, 1)), 2, 2}};
    tree.order = {{0, RefKind::triangle}, {1, RefKind::triangle}, {2, RefKind::triangle}, {3, RefKind::triangle}};
    return tree;
}

TEST(TreeQuality, ByHand)
{
    const TreeQuality quality = measure_quality(crossing_squares(), crossing_tree());
    EXPECT_EQ(quality.nodes, 1u);
    EXPECT_EQ(quality.leaves, 2u);
    EXPECT_EQ(quality.references, 4u);
    EXPECT_EQ(quality.depth, 1);
    EXPECT_EQ(quality.mean_leaf_depth, 1.0);
    EXPECT_EQ(quality.mean_leaf_size, 2.0);
    EXPECT_DOUBLE_EQ(quality.sah, 1.0 * cost_of_node + (4.0 + 5.0) / 8.0 * cost_of_block);
    EXPECT_DOUBLE_EQ(quality.epo, 2.0 / 5.0 * cost_of_block);

    const TreeQuality without = measure_quality(crossing_squares(), crossing_tree(), false);
    EXPECT_EQ(without.epo, 0.0);
    EXPECT_EQ(without.sah, quality.sah);
}

// The left child of the root is an inner node with a foreign half of a square in it, and so are its leaves.
TEST(TreeQuality, ByHandWithDepth)
{
    PackedScene scene = crossing_squares();
    BinaryTree tree;
    tree.nodes = {{box_of(vec3(0), vec3(2, 2, 1)), 4, 0},
                  {box_of(vec3(0), vec3(1, 2, 1)), 3, 0},
                  {box_of(vec3(0), vec3(1, 2, 1)), 2, 1},
                  {box_of(vec3(1, 0, 0), vec3(1, 1, 1)), 3, 1},
                  {box_of(vec3(0), vec3(2, 2, 0)), 0, 2}};
    tree.order = crossing_tree().order;
    const TreeQuality quality = measure_quality(scene, tree);
    EXPECT_EQ(quality.depth, 2);
    EXPECT_DOUBLE_EQ(quality.mean_leaf_depth, 5.0 / 3.0);
    EXPECT_DOUBLE_EQ(quality.mean_leaf_size, 4.0 / 3.0);
    EXPECT_DOUBLE_EQ(quality.sah, (8 + 5) / 8.0 * cost_of_node + (5 + 1 + 4) / 8.0 * cost_of_block);
    // Node 1 has half of the first square; its left leaf that and half of the second square, 1/2; its right leaf the
    // other half of the second square.
    EXPECT_DOUBLE_EQ(quality.epo, (2.0 * cost_of_node + 3.0 * cost_of_block) / 5.0);
}

// A triangle in two leaves belongs to both and counts once in the whole surface.
TEST(TreeQuality, SplitTriangles)
{
    PackedScene scene;
    add_triangle(scene, vec3(0, 0, 0), vec3(4, 0, 0), vec3(0, 4, 0));
    add_triangle(scene, vec3(0, 0, 0), vec3(1, 0, 0), vec3(0, 1, 0));
    end_world(scene);
    BinaryTree tree;
    tree.nodes = {{box_of(vec3(0), vec3(4, 4, 0)), 2, 0},
                  {box_of(vec3(0), vec3(2, 4, 0)), 0, 1},
                  {box_of(vec3(0), vec3(4, 4, 0)), 1, 2}};
    tree.order = {{0, RefKind::triangle}, {1, RefKind::triangle}, {0, RefKind::triangle}};
    const TreeQuality quality = measure_quality(scene, tree);
    EXPECT_EQ(quality.references, 3u);
    EXPECT_DOUBLE_EQ(quality.epo, 0.5 / 8.5 * cost_of_block);
}

TEST(TreeQuality, NothingToMeasure)
{
    const TreeQuality none_at_all = measure_quality({}, {});
    EXPECT_EQ(none_at_all.leaves, 0u);
    EXPECT_EQ(none_at_all.sah, 0.0);
    EXPECT_EQ(none_at_all.epo, 0.0);

    PackedScene scene; // no surface: spheres, and a triangle that is a point
    Random random(81);
    add_cloud(scene, random, 20, 0.2f);
    add_triangle(scene, vec3(0.5f), vec3(0.5f), vec3(0.5f));
    end_world(scene);
    const BinaryTree tree = build_binned_sah(scene, collect_primitives(scene, scene.world), {});
    const TreeQuality quality = measure_quality(scene, tree);
    EXPECT_GT(quality.sah, 0.0);
    EXPECT_EQ(quality.references, 21u);
    EXPECT_EQ(quality.epo, 0.0);
}

// ---- brute force ----

// Clips a polygon to a box the plain way, in long double.
long double clipped_area(const PackedScene& scene, const Triangle& tri, const Box& box)
{
    using Point = std::array<long double, 3>;
    std::vector<Point> polygon;
    for (const uint v : {tri.v0, tri.v1, tri.v2}) {
        const vec3 p = scene.positions[v];
        polygon.push_back({p.x, p.y, p.z});
    }
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (const bool above : {false, true}) {
            const long double plane = above ? box.upper[static_cast<int>(axis)] : box.lower[static_cast<int>(axis)];
            const auto outside = [&](const Point& p) { return above ? p[axis] - plane : plane - p[axis]; };
            std::vector<Point> next;
            for (std::size_t i = 0; i < polygon.size(); ++i) {
                const Point &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
                if (outside(a) <= 0) next.push_back(a);
                if ((outside(a) < 0) != (outside(b) < 0) && outside(a) != 0 && outside(b) != 0) {
                    const long double t = outside(a) / (outside(a) - outside(b));
                    Point p;
                    for (std::size_t k = 0; k < 3; ++k) p[k] = a[k] + t * (b[k] - a[k]);
                    next.push_back(p);
                }
            }
            polygon = next;
        }
    Point sum = {0, 0, 0};
    for (std::size_t i = 2; i < polygon.size(); ++i)
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t u = (k + 1) % 3, v = (k + 2) % 3;
            sum[k] += (polygon[i - 1][u] - polygon[0][u]) * (polygon[i][v] - polygon[0][v]) -
                      (polygon[i - 1][v] - polygon[0][v]) * (polygon[i][u] - polygon[0][u]);
        }
    return 0.5L * std::sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
}

double brute_epo(const PackedScene& scene, const BinaryTree& tree)
{
    std::set<uint> everything;
    for (const Entry& entry : tree.order)
        if (entry.kind == RefKind::triangle) everything.insert(entry.index);
    long double sum = 0, whole = 0;
    const Box space = box_of(vec3(-infinity()), vec3(infinity()));
    for (const uint tri : everything) whole += clipped_area(scene, scene.triangles[tri], space);
    const std::function<std::set<uint>(uint)> visit = [&](uint at) {
        const BinaryNode& node = tree.nodes[at];
        std::set<uint> own;
        if (node.count == 0) {
            own = visit(at + 1);
            own.merge(visit(node.link));
        } else {
            for (uint i = 0; i < node.count; ++i)
                if (tree.order[node.link + i].kind == RefKind::triangle) own.insert(tree.order[node.link + i].index);
        }
        for (const uint tri : everything)
            if (!own.contains(tri))
                sum += clipped_area(scene, scene.triangles[tri], node.box) *
                       static_cast<long double>(node.count == 0 ? cost_of_node : cost_of_block);
        return own;
    };
    visit(0);
    return static_cast<double>(sum / whole);
}

TEST(TreeQuality, EndPointOverlapAgreesWithBruteForce)
{
    for (const float size : {0.02f, 0.3f, 1.0f}) {
        SCOPED_TRACE(size);
        Random random(82);
        PackedScene scene;
        add_triangle(scene, vec3(9.0f), vec3(10.0f, 9.0f, 8.0f), vec3(9.0f, 8.0f, 7.0f)); // of nobody's tree
        end_group(scene);
        add_soup(scene, random, 150, size);
        add_grid(scene, 8, 0.25f);
        add_cloud(scene, random, 10, 0.1f);
        end_world(scene);
        const std::vector<PrimitiveRef> refs = collect_primitives(scene, scene.world);
        for (const BuilderInfo& builder : builders()) {
            SCOPED_TRACE(builder.name);
            const BinaryTree tree = builder.build(scene, refs, {});
            const double expected = brute_epo(scene, tree);
            EXPECT_GT(expected, 0.01);
            EXPECT_NEAR(measure_quality(scene, tree).epo, expected, 1e-9 * expected);
        }
    }
}

// The entries need not lie in the order of the leaves.
TEST(TreeQuality, OrderOfEntriesDoesNotMatter)
{
    Random random(83);
    PackedScene scene;
    add_soup(scene, random, 200, 0.3f);
    end_world(scene);
    BinaryTree tree = build_binned_sah(scene, collect_primitives(scene, scene.world), {});
    const double expected = measure_quality(scene, tree).epo;
    std::vector<Entry> order;
    for (std::size_t i = tree.nodes.size(); i-- > 0;) {
        BinaryNode& node = tree.nodes[i];
        if (node.count == 0) continue;
        const uint first = static_cast<uint>(order.size());
        for (uint k = 0; k < node.count; ++k) order.push_back(tree.order[node.link + k]);
        node.link = first;
    }
    tree.order = order;
    EXPECT_NEAR(measure_quality(scene, tree).epo, expected, 1e-12 * expected);
}

TEST(TreeQuality, TheSameForAnyNumberOfThreads)
{
    Random random(84);
    PackedScene scene;
    add_soup(scene, random, 20'000, 0.05f);
    end_world(scene);
    const BinaryTree tree = build_binned_sah(scene, collect_primitives(scene, scene.world), {});
    set_thread_count(1);
    const TreeQuality one = measure_quality(scene, tree);
    for (const int threads : {2, 5}) {
        set_thread_count(threads);
        const TreeQuality many = measure_quality(scene, tree);
        EXPECT_EQ(one.epo, many.epo);
        EXPECT_EQ(one.sah, many.sah);
    }
    set_thread_count(0);
}

// Coordinates near the ends of what floats can hold, and slivers.
TEST(TreeQuality, HostileScales)
{
    for (const float scale : {1e-30f, 1e30f}) {
        SCOPED_TRACE(scale);
        Random random(85);
        PackedScene scene;
        add_soup(scene, random, 300, 0.3f);
        for (vec3& p : scene.positions) p *= scale;
        for (int i = 0; i < 100; ++i) {
            const vec3 a = scale * random.in_box(1.0f), b = scale * random.in_box(1.0f);
            add_triangle(scene, a, b, 0.5f * (a + b));
        }
        end_world(scene);
        const BinaryTree tree = build_binned_sah(scene, collect_primitives(scene, scene.world), {});
        const double expected = brute_epo(scene, tree);
        EXPECT_NEAR(measure_quality(scene, tree).epo, expected, 1e-6 * expected);
    }
}

} // namespace
} // namespace snell::test
