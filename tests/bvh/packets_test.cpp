// Packets of rays, whatever they are made of, find bit for bit the hits of single rays: on every layout and
// instruction set.
#include "snell/bvh/simd/traverse.h"
#include "snell/kernel/intersect.h"
#include "tests/bvh/scenes.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cmath>
#include <cstring>

namespace snell::test {
namespace {

void expect_same_as_single(const PackedScene& scene, const std::vector<Ray>& rays, std::size_t least_hits)
{
    for (const char* name : {"bvh2", "bvh4", "bvh8", "bvh8q"}) {
        AccelOptions options;
        options.traversal = Traversal::single;
        const auto single = find_accel(name)->make(scene, options);
        std::vector<Hit> expected(rays.size());
        single->intersect(rays, expected);
        std::size_t found = 0;
        for (const Hit& hit : expected) found += is_hit(hit);
        ASSERT_GE(found, least_hits) << "the test looks past the scene";
        options.traversal = Traversal::packets;
        const auto packets = find_accel(name)->make(scene, options);
        for (const std::int64_t target : traversal_targets()) {
            SCOPED_TRACE(fmt::format("{}, {}", name, hwy::TargetName(target)));
            hwy::SetSupportedTargetsForTest(target);
            std::vector<Hit> hits(rays.size());
            std::vector<std::uint8_t> blocked(rays.size(), 77);
            packets->intersect(rays, hits);
            packets->occluded(rays, blocked);
            std::size_t wrong = 0;
            for (std::size_t i = 0; i < rays.size(); ++i)
                wrong += std::memcmp(&hits[i], &expected[i], sizeof(Hit)) != 0 || blocked[i] != is_hit(expected[i]);
            EXPECT_EQ(wrong, 0u) << "of " << rays.size();
        }
        hwy::SetSupportedTargetsForTest(0);
    }
}

// Rays from one point into a cone: a narrow one keeps packets together, of a wide one each ray soon goes alone and
// leaves more subtrees for later than there is room for.
std::vector<Ray> cone(Random& random, vec3 eye, float width, int count)
{
    std::vector<Ray> rays;
    for (int i = 0; i < count; ++i)
        rays.push_back(make_ray(eye, normalize(vec3(0.3f, 0.2f, 1.0f)) + random.in_box(width), infinity()));
    return rays;
}

// Whatever is found first may be named, but it must be in the way.
TEST(BvhPackets, BlockersAreInTheWay)
{
    Random random(5);
    PackedScene scene;
    add_soup(scene, random, 3000, 0.1f);
    end_world(scene);
    std::vector<Ray> rays = cone(random, vec3(0.1f), 0.2f, 1000);
    for (const Ray& ray : random_rays(random, 1000)) rays.push_back(ray);
    std::vector<Hit> expected(rays.size());
    find_accel("brute")->make(scene, {})->intersect(rays, expected);
    std::size_t blocked = 0;
    for (const char* name : {"bvh2", "bvh4", "bvh8", "bvh8q", "brute"}) {
        for (const Traversal traversal : {Traversal::single, Traversal::packets, Traversal::stream}) {
            AccelOptions options;
            options.traversal = traversal;
            const auto accel = find_accel(name)->make(scene, options);
            for (const std::int64_t target : traversal_targets()) {
                SCOPED_TRACE(fmt::format("{}, {}", name, hwy::TargetName(target)));
                hwy::SetSupportedTargetsForTest(target);
                std::vector<uint> primitives(rays.size(), 12345u);
                accel->find_blockers(rays, primitives);
                for (std::size_t i = 0; i < rays.size(); ++i) {
                    ASSERT_EQ(primitives[i] != none, is_hit(expected[i])) << i;
                    if (primitives[i] == none) continue;
                    ++blocked;
                    const Triangle& tri = scene.triangles[primitive_index(primitives[i])];
                    ASSERT_TRUE(intersect_triangle_watertight(rays[i], shear_ray(rays[i]), scene.positions[tri.v0],
                                                              scene.positions[tri.v1], scene.positions[tri.v2])
                                    .ok)
                        << i;
                }
            }
            hwy::SetSupportedTargetsForTest(0);
        }
    }
    EXPECT_GT(blocked, 10000u);
}

TEST(BvhPackets, NarrowAndWideCones)
{
    Random random(3);
    PackedScene scene;
    add_soup(scene, random, 6000, 0.05f);
    add_cloud(scene, random, 60, 0.05f);
    end_world(scene);
    for (const float width : {0.0f, 0.01f, 0.1f, 0.6f})
        for (const vec3 eye : {vec3(-0.4f, -0.3f, -1.5f), vec3(0.1f)})
            expect_same_as_single(scene, cone(random, eye, width, 700), width == 0.0f ? 0 : 100);
}

TEST(BvhPackets, LongSliversThatEveryRayPasses)
{
    Random random(4);
    PackedScene scene;
    for (int i = 0; i < 1500; ++i) {
        const vec3 a = random.in_box(1.0f), along = random.in_box(1.0f);
        add_triangle(scene, a, a + along, a + along + random.in_box(0.01f));
    }
    end_world(scene);
    expect_same_as_single(scene, cone(random, vec3(-0.4f, -0.3f, -1.5f), 0.4f, 1500), 100);
    expect_same_as_single(scene, random_rays(random, 1500), 100);
}

// Numbers of rays around those of vectors and packets; one that no tree takes among others, first or last of a block.
TEST(BvhPackets, EveryCountAndRaysThatAreNone)
{
    Random random(5);
    PackedScene scene;
    add_soup(scene, random, 500, 0.2f);
    end_world(scene);
    for (const int count : {1, 3, 4, 5, 15, 16, 17, 33, 47, 63, 64, 65, 127, 128, 130}) {
        std::vector<Ray> rays = cone(random, vec3(-0.4f, -0.3f, -1.5f), 0.05f, count);
        expect_same_as_single(scene, rays, 0);
        for (const std::size_t at : {std::size_t{0}, rays.size() / 2, rays.size() - 1}) {
            std::vector<Ray> some = rays;
            some[at].direction = at % 2 == 0 ? vec3(0.0f) : vec3(NAN, 1.0f, 1.0f);
            expect_same_as_single(scene, some, 0);
            some[at] = rays[at];
            some[at].t_max = some[at].t_min;
            expect_same_as_single(scene, some, 0);
            some[at] = rays[at];
            some[at].origin.y = INFINITY;
            expect_same_as_single(scene, some, 0);
        }
    }
}

// Ends of rays below 0, at 0 and between surfaces: those that end first do not hold back or speed up the others.
TEST(BvhPackets, RaysOfManyLengths)
{
    Random random(6);
    PackedScene scene;
    add_soup(scene, random, 3000, 0.1f);
    end_world(scene);
    std::vector<Ray> rays = cone(random, vec3(0.1f), 0.05f, 640);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        rays[i].t_min = i % 3 == 0 ? -2.0f : 0.0f;
        rays[i].t_max = i % 4 == 0 ? infinity() : i % 12 == 3 ? -0.5f : i % 12 == 9 ? 0.0f : random.range(0.0f, 1.0f);
    }
    expect_same_as_single(scene, rays, 100);
}

// Rays in a bare room with a dense thing in its middle visit hardly any nodes: those in flight stop at the probe, and
// the default finishes the batch in packets. Rays in the thing itself go on.
TEST(BvhPackets, RaysOfFewVisitsAreLeftToThem)
{
    Random random(9);
    PackedScene scene;
    for (int axis = 0; axis < 3; ++axis)
        for (const float side : {-1.0f, 1.0f}) {
            vec3 corner[4];
            for (int i = 0; i < 4; ++i) {
                corner[i][axis] = side;
                corner[i][(axis + 1) % 3] = i == 0 || i == 3 ? -1.0f : 1.0f;
                corner[i][(axis + 2) % 3] = i < 2 ? -1.0f : 1.0f;
            }
            add_triangle(scene, corner[0], corner[1], corner[2]);
            add_triangle(scene, corner[0], corner[2], corner[3]);
        }
    for (int i = 0; i < 4000; ++i) {
        const vec3 a = random.in_box(0.02f);
        add_triangle(scene, a, a + random.in_box(0.004f), a + random.in_box(0.004f));
    }
    end_world(scene);
    constexpr std::size_t count = 3000, probe = 512;
    std::vector<Ray> across, within;
    for (std::size_t i = 0; i < count; ++i) {
        across.push_back(make_ray(random.in_box(0.9f), random.in_box(1.0f), infinity()));
        within.push_back(make_ray(random.in_box(0.02f), random.in_box(1.0f), infinity()));
    }
    AccelOptions options;
    const WideBvh<Node8> bvh = make_wide<Node8>(scene, options.build);
    const TraceInput<Node8> input = {&bvh, &scene, TriangleTest::watertight, false};
    for (const std::int64_t target : traversal_targets()) {
        hwy::SetSupportedTargetsForTest(target);
        const TraceKernels<Node8> kernels = trace_kernels<Node8>();
        std::vector<Hit> hits(count);
        const std::size_t done = kernels.stream(input, across, hits, probe);
        EXPECT_GE(done, probe);
        EXPECT_LT(done, probe + 100);
        EXPECT_EQ(kernels.stream(input, across, hits, 0), count);
        EXPECT_EQ(kernels.stream(input, within, hits, probe), count);
        for (const std::vector<Ray>& rays : {across, within}) {
            std::vector<Hit> expected(count);
            kernels.single(input, rays, expected);
            find_accel("bvh8")->make(scene, options)->intersect(rays, hits);
            EXPECT_EQ(std::memcmp(hits.data(), expected.data(), count * sizeof(Hit)), 0);
        }
    }
    hwy::SetSupportedTargetsForTest(0);
}

} // namespace
} // namespace snell::test
