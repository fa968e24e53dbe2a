// From a scene to the layout that is traced: the same for any number of threads, and of bounded size.
#include "snell/bvh/build.h"
#include "snell/bvh/primitives.h"
#include "snell/bvh/wide.h"
#include "snell/core/parallel.h"
#include "tests/bvh/scenes.h"

#include <gtest/gtest.h>

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
    for (int i = 0; i < 500; ++i) add_instance(scene, 0, translation(3.0f * random.in_box(1.0f)));
    return scene;
}

template <class Vector>
bool same_bytes(const Vector& a, const Vector& b)
{
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0;
}

template <class Node>
bool same_tree(const WideTree<Node>& a, const WideTree<Node>& b)
{
    return same_bytes(a.nodes, b.nodes) && same_bytes(a.lines, b.lines) && same_bytes(a.spheres, b.spheres) &&
           a.root == b.root && a.stack_size == b.stack_size && a.sah_cost == b.sah_cost && a.leaves == b.leaves;
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

} // namespace
} // namespace snell::test
