// Every structure, on every instruction set, finds bit for bit the hits of brute force.
#include "snell/bvh/simd/traverse.h"
#include "snell/kernel/intersect.h"
#include "tests/bvh/scenes.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cstring>

namespace snell::test {
namespace {

std::string describe(const Ray& r, const Hit& h)
{
    return fmt::format("ray ({}, {}, {}) -> ({}, {}, {}) in ({}, {}): t {} u {} v {} primitive {:x} instance {:x}",
                       r.origin.x, r.origin.y, r.origin.z, r.direction.x, r.direction.y, r.direction.z, r.t_min,
                       r.t_max, h.t, h.u, h.v, h.primitive, h.instance);
}

bool same(const Hit& a, const Hit& b)
{
    return std::memcmp(&a, &b, sizeof(Hit)) == 0;
}

// Calls body for each instruction set of this build that this processor has.
template <class Body>
void for_each_target(const Body& body)
{
    for (const std::int64_t target : traversal_targets()) {
        hwy::SetSupportedTargetsForTest(target);
        SCOPED_TRACE(hwy::TargetName(target));
        body();
    }
    hwy::SetSupportedTargetsForTest(0);
}

#if defined(__SANITIZE_THREAD__)
constexpr std::size_t thinning = 40; // one thread traces here
#elif defined(__SANITIZE_ADDRESS__)
constexpr std::size_t thinning = 8;
#else
constexpr std::size_t thinning = 1;
#endif

// From hit to hit, all of them behind each other.
void expect_same_chains(const Accel& accel, const Accel& brute, std::vector<Ray> rays, std::vector<Hit> hits)
{
    constexpr int most = 6;
    constexpr std::size_t enough = 300; // of the rays, evenly spread
    const std::size_t step = rays.size() / enough + 1;
    for (std::size_t i = 0, k = 0; i < rays.size(); i += step, ++k) rays[k] = rays[i], hits[k] = hits[i];
    rays.resize((rays.size() + step - 1) / step);
    hits.resize(rays.size());
    for (int link = 0; link < most; ++link) {
        std::size_t kept = 0;
        for (std::size_t i = 0; i < rays.size(); ++i)
            if (is_hit(hits[i])) rays[kept] = rays[i], hits[kept++] = hits[i];
        if (kept == 0) return;
        rays.resize(kept);
        hits.resize(kept);
        std::vector<Hit> expected(kept), found(kept);
        brute.intersect_next(rays, hits, expected);
        accel.intersect_next(rays, hits, found);
        int wrong = 0;
        for (std::size_t i = 0; i < kept && wrong < 3; ++i) {
            ASSERT_TRUE(!is_hit(expected[i]) ||
                        is_later_hit(expected[i].t, expected[i].primitive, expected[i].instance, hits[i]));
            if (same(found[i], expected[i])) continue;
            ++wrong;
            ADD_FAILURE() << "behind " << describe(rays[i], hits[i]) << "\nexpected " << describe(rays[i], expected[i])
                          << "\n     got " << describe(rays[i], found[i]);
        }
        hits = std::move(expected);
    }
}

void expect_agreement(const PackedScene& scene, const std::vector<Ray>& rays, std::size_t least_hits,
                      TriangleTest test = TriangleTest::watertight)
{
    AccelOptions options;
    options.triangle_test = test;
    const auto brute = find_accel("brute")->make(scene, options);
    std::vector<Hit> expected(rays.size());
    brute->intersect(rays, expected);
    std::vector<std::uint8_t> expected_blocked(rays.size());
    brute->occluded(rays, expected_blocked);
    std::size_t hits_found = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        hits_found += is_hit(expected[i]);
        ASSERT_EQ(expected_blocked[i], is_hit(expected[i]) ? 1 : 0);
    }
    EXPECT_GE(hits_found, least_hits) << "the test looks past the scene";

    for (const AccelInfo& info : accels()) {
        if (info.name == "brute" || !info.exact) continue;
        // The default takes them all, the others every third; under sanitizers, which look at memory, fewer do.
        const std::size_t step = (&info == &accels().front() ? 1 : 3) * thinning;
        std::vector<Ray> some;
        std::vector<Hit> some_hits;
        for (std::size_t i = 0; i < rays.size(); i += step) some.push_back(rays[i]), some_hits.push_back(expected[i]);
        for (const Traversal traversal : {Traversal::single, Traversal::packets, Traversal::stream}) {
            SCOPED_TRACE(fmt::format("{}, traversal {}", info.name, int(traversal)));
            options.traversal = traversal;
            const auto accel = info.make(scene, options);
            for_each_target([&] {
                std::vector<Hit> hits(some.size()), counted(some_hits);
                std::vector<std::uint8_t> blocked(some.size(), 77);
                std::vector<uint> steps(some.size());
                accel->intersect(some, hits);
                accel->occluded(some, blocked);
                if (traversal == Traversal::single) { // the same for all of them
                    accel->intersect_counted(some, counted, steps);
                    expect_same_chains(*accel, *brute, some, some_hits);
                }
                int wrong = 0;
                for (std::size_t i = 0; i < some.size() && wrong < 3; ++i) {
                    if (same(hits[i], some_hits[i]) && same(counted[i], some_hits[i]) &&
                        blocked[i] == (is_hit(some_hits[i]) ? 1 : 0))
                        continue;
                    ++wrong;
                    ADD_FAILURE() << "expected " << describe(some[i], some_hits[i]) << "\n     got "
                                  << describe(some[i], hits[i]) << "\n counted " << describe(some[i], counted[i])
                                  << "\n blocked " << int(blocked[i]);
                }
            });
        }
    }
}

// Random and hostile rays, both triangle tests.
void expect_agreement(const PackedScene& scene, std::size_t least_hits, uint seed = 1, int count = 2000)
{
    Random random(seed);
    std::vector<Ray> rays = random_rays(random, count);
    const std::vector<Ray> hostile = hostile_rays(scene, random);
    rays.insert(rays.end(), hostile.begin(), hostile.end());
    expect_agreement(scene, rays, least_hits);
    SCOPED_TRACE("Moeller-Trumbore");
    expect_agreement(scene, rays, least_hits, TriangleTest::moller_trumbore);
    // Every builder, with every layout.
    for (const BuilderInfo& builder : builders()) {
        SCOPED_TRACE(builder.name);
        AccelOptions options;
        options.build.builder = builder.name;
        options.build.reinsertion = 1;
        std::vector<Hit> expected(rays.size()), hits(rays.size());
        find_accel("brute")->make(scene, options)->intersect(rays, expected);
        for (const AccelInfo& info : accels()) {
            if (info.name == "brute" || !info.exact) continue;
            SCOPED_TRACE(info.name);
            info.make(scene, options)->intersect(rays, hits);
            for (std::size_t i = 0; i < rays.size(); ++i)
                ASSERT_TRUE(same(hits[i], expected[i]))
                    << "expected " << describe(rays[i], expected[i]) << "\n     got " << describe(rays[i], hits[i]);
        }
    }
}

TEST(BvhAgrees, TriangleSoups)
{
    for (const int count : {1, 2, 3, 4, 5, 8, 9, 40, 1000})
        for (const float size : {0.02f, 0.2f, 2.0f}) {
            SCOPED_TRACE(fmt::format("{} triangles of size {}", count, size));
            Random random(static_cast<uint>(count));
            PackedScene scene;
            add_soup(scene, random, count, size);
            end_world(scene);
            expect_agreement(scene, static_cast<float>(count) * size >= 40.0f ? 500 : 0, 7, 700);
        }
}

TEST(BvhAgrees, GridsWithExactEdges)
{
    PackedScene scene;
    for (const float height : {-1.0f, -0.5f, 0.0f, 0.0f, 1.0f}) add_grid(scene, 8, height);
    end_world(scene);
    expect_agreement(scene, 1000);

    // Straight down onto vertices and edges, where several triangles are hit at once.
    std::vector<Ray> rays;
    for (int i = -16; i <= 16; ++i)
        for (int j = -16; j <= 16; ++j)
            rays.push_back(make_ray(vec3(static_cast<float>(i) / 16.0f, static_cast<float>(j) / 16.0f, 2.0f),
                                    vec3(0.0f, 0.0f, -1.0f), infinity()));
    expect_agreement(scene, rays, rays.size());
}

// Coplanar surfaces of the same corners: the hits behind each other are all of them, each once, then nothing.
TEST(BvhAgrees, EverySurfaceOfAStackComesOnce)
{
    PackedScene scene;
    for (int i = 0; i < 5; ++i) add_triangle(scene, vec3(-1, -1, 0), vec3(1, -1, 0), vec3(0, 1, 0));
    add_sphere(scene, vec3(0, 0, -3), 1.0f);
    add_sphere(scene, vec3(0, 0, -3), 1.0f);
    end_world(scene);
    const std::vector<Ray> rays = {make_ray(vec3(0.1f, 0.1f, 2.0f), vec3(0, 0, -1), infinity())};
    for (const AccelInfo& info : accels()) {
        if (!info.exact) continue;
        SCOPED_TRACE(info.name);
        const auto accel = info.make(scene, {});
        std::vector<Hit> hits(1), next(1);
        accel->intersect(rays, hits);
        int count = 0;
        for (; is_hit(hits[0]) && count < 20; ++count) {
            accel->intersect_next(rays, hits, next);
            hits = next;
        }
        EXPECT_EQ(count, 5 + 2 * 2);
    }
}

TEST(BvhAgrees, SphereClouds)
{
    for (const int count : {1, 2, 4, 5, 500}) {
        Random random(static_cast<uint>(count));
        PackedScene scene;
        add_cloud(scene, random, count, 0.3f);
        end_world(scene);
        expect_agreement(scene, count == 500 ? 1500 : 1);
    }
}

TEST(BvhAgrees, EverythingTogether)
{
    Random random(3);
    PackedScene scene;
    add_soup(scene, random, 60, 0.3f);
    add_cloud(scene, random, 5, 0.4f);
    end_group(scene);
    add_cloud(scene, random, 30, 0.2f);
    end_group(scene);
    end_group(scene); // an empty one
    add_soup(scene, random, 1, 1.0f);
    end_group(scene);
    add_soup(scene, random, 40, 0.2f);
    add_cloud(scene, random, 20, 0.1f);
    end_world(scene);
    for (uint i = 0; i < 60; ++i) {
        Transform m = compose(rotation(random.direction(), random.range(0.0f, 360.0f)),
                              scaling(vec3(random.range(0.1f, 0.5f), random.range(0.1f, 0.5f),
                                           (i % 3 == 0 ? -1.0f : 1.0f) * random.range(0.1f, 0.5f))));
        m = compose(translation(random.in_box(1.0f)), m);
        add_instance(scene, i % 4, m);
        if (i == 5) add_instance(scene, 0, m); // in the same place: ties between instances
    }
    expect_agreement(scene, 800);
    add_plane(scene, vec3(0.0f, 1.0f, 0.0f), -1.0f);
    add_plane(scene, vec3(0.3f, 1.0f, 0.2f), -1.5f);
    expect_agreement(scene, 1500);
}

TEST(BvhAgrees, PlanesAlone)
{
    PackedScene scene;
    end_world(scene);
    expect_agreement(scene, 0);
    add_plane(scene, vec3(0.0f, 1.0f, 0.0f), -1.0f);
    add_plane(scene, vec3(0.0f, 1.0f, 0.0f), -1.0f); // twice: the first one wins
    add_plane(scene, vec3(1.0f, 0.0f, 0.0f), 0.5f);
    expect_agreement(scene, 1000);
}

TEST(BvhAgrees, IdenticalCentroids)
{
    for (const int count : {2, 5, 100, 3000}) {
        PackedScene scene;
        Random random(5);
        for (int i = 0; i < count; ++i) {
            const float s = count == 3000 ? 1.0f : random.range(0.1f, 1.0f); // the last one: all the same triangle
            add_triangle(scene, vec3(-s, -s, 0.0f), vec3(s, -s, 0.0f), vec3(0.0f, s, 0.0f));
        }
        for (int i = 0; i < 10; ++i) add_sphere(scene, vec3(0.0f), 0.5f);
        end_world(scene);
        expect_agreement(scene, 50, 1, 300);
    }
}

TEST(BvhAgrees, ZeroAreaAndSlivers)
{
    Random random(8);
    PackedScene scene;
    for (int i = 0; i < 200; ++i) {
        const vec3 a = random.in_box(1.0f), b = random.in_box(1.0f);
        if (i % 4 == 0) add_triangle(scene, a, a, a);
        if (i % 4 == 1) add_triangle(scene, a, b, b);
        if (i % 4 == 2) add_triangle(scene, a, b, 0.5f * (a + b));
        if (i % 4 == 3) add_triangle(scene, a, b, 0.5f * (a + b) + random.in_box(1e-3f));
    }
    for (int i = 0; i < 20; ++i) add_sphere(scene, random.in_box(1.0f), 0.0f);
    end_world(scene);
    expect_agreement(scene, 1);
}

TEST(BvhAgrees, NanAndInfiniteVertices)
{
    Random random(9);
    PackedScene scene;
    add_soup(scene, random, 300, 0.5f);
    for (std::size_t i = 0; i < scene.positions.size(); i += 7)
        scene.positions[i][static_cast<int>(i % 3)] = i % 2 ? std::nanf("") : (i % 4 ? infinity() : -infinity());
    for (const float bad : {std::nanf(""), infinity(), -infinity()}) {
        add_sphere(scene, vec3(bad, 0.0f, 0.0f), 0.3f);
        add_sphere(scene, vec3(0.0f), bad);
    }
    end_world(scene);
    expect_agreement(scene, 500);

    PackedScene nothing;
    for (int i = 0; i < 9; ++i) add_triangle(nothing, vec3(std::nanf("")), vec3(0.0f), vec3(1.0f));
    end_world(nothing);
    expect_agreement(nothing, 0);
}

TEST(BvhAgrees, HugeOffsets)
{
    for (const float offset : {1e4f, 1e6f, 1e9f}) {
        Random random(10);
        const vec3 center(offset, -offset, 0.5f * offset);
        PackedScene scene;
        add_soup(scene, random, 300, 0.5f, center);
        for (int i = 0; i < 20; ++i) add_sphere(scene, center + random.in_box(1.0f), 0.2f);
        const float size = offset * 1e-6f; // so that a few thousand positions exist even there
        for (int i = 0; i < 200; ++i)
            add_triangle(scene, center + random.in_box(size), center + random.in_box(size),
                         center + random.in_box(size));
        end_world(scene);
        std::vector<Ray> rays = random_rays(random, 1500, size, center);
        const std::vector<Ray> hostile = hostile_rays(scene, random);
        rays.insert(rays.end(), hostile.begin(), hostile.end());
        expect_agreement(scene, rays, 500);
    }
}

TEST(BvhAgrees, FarAndTinyScenes)
{
    for (const float scale : {1e-9f, 1e-3f, 1e9f}) {
        Random random(11);
        PackedScene scene;
        add_soup(scene, random, 200, 0.5f);
        for (vec3& p : scene.positions) p *= scale;
        end_world(scene);
        std::vector<Ray> rays = random_rays(random, 1000, scale);
        expect_agreement(scene, rays, 200);
    }
}

// Coherent batches, pure and with every third ray replaced by one that has nothing to do with its neighbours, that is
// hostile, or whose interval is its own.
void expect_agreement_for_cameras(const PackedScene& scene, std::size_t least_hits)
{
    Random random(61);
    const std::vector<Ray> hostile = hostile_rays(scene, random);
    for (const vec3 eye : {vec3(0.1f, 0.2f, 3.0f), vec3(-2.0f, 2.1f, 2.0f), vec3(0.0f, 0.0f, 0.1f)})
        for (const vec3 target : {vec3(0.0f), vec3(0.3f, -0.2f, 0.1f)}) {
            std::vector<Ray> rays = camera_rays(eye, target, 1.2f, 5);
            expect_agreement(scene, rays, least_hits);
            const std::vector<Ray> others = random_rays(random, static_cast<int>(rays.size()));
            for (std::size_t i = 0; i < rays.size(); i += 3) switch (i % 5) {
                case 0:
                    rays[i] = others[i];
                    break;
                case 1:
                    rays[i] = hostile[(i * 7) % hostile.size()];
                    break;
                case 2:
                    rays[i].t_min = random.range(0.0f, 1.5f);
                    break;
                default:
                    rays[i].t_max = random.range(-0.1f, 1.5f);
                }
            expect_agreement(scene, rays, 0);
            expect_agreement(scene, rays, 0, TriangleTest::moller_trumbore);
            // The other way: towards one point, as shadow rays go.
            for (Ray& ray : rays) ray = make_ray(ray_at(ray, 0.9f), eye - ray_at(ray, 0.9f), 1.0f);
            expect_agreement(scene, rays, 0);
        }
}

TEST(BvhAgrees, CameraRaysOnTriangles)
{
    for (const int count : {1, 3, 40, 1500}) {
        Random random(static_cast<uint>(count));
        PackedScene scene;
        add_soup(scene, random, count, count > 1000 ? 0.1f : 0.5f);
        add_triangle(scene, vec3(-9.0f, -9.0f, -2.0f), vec3(9.0f, -9.0f, -2.0f), vec3(0.0f, 9.0f, -2.0f));
        end_world(scene);
        expect_agreement_for_cameras(scene, 1);
    }
    PackedScene grids;
    for (const float height : {-1.0f, -0.5f, 0.0f, 0.0f, 1.0f}) add_grid(grids, 10, height);
    end_world(grids);
    expect_agreement_for_cameras(grids, 50);
    add_plane(grids, vec3(0.1f, 0.0f, 1.0f), -0.2f);
    expect_agreement_for_cameras(grids, 200);
}

TEST(BvhAgrees, CameraRaysOnSpheres)
{
    for (const int count : {1, 4, 300}) {
        Random random(static_cast<uint>(count));
        PackedScene scene;
        add_cloud(scene, random, count, 0.3f);
        add_sphere(scene, vec3(0.0f), 0.8f);
        add_sphere(scene, vec3(0.0f), 0.8f); // twice: the first one wins
        add_sphere(scene, vec3(0.0f, std::nanf(""), 0.0f), 1.0f);
        add_sphere(scene, vec3(0.1f), 0.0f);
        add_sphere(scene, vec3(0.0f, 0.0f, -1000.0f), 999.0f);
        end_world(scene);
        expect_agreement_for_cameras(scene, 100);
    }
}

TEST(BvhAgrees, CameraRaysOnEverything)
{
    Random random(62);
    PackedScene scene;
    add_soup(scene, random, 60, 0.3f);
    add_cloud(scene, random, 9, 0.4f);
    end_group(scene);
    add_soup(scene, random, 100, 0.2f);
    add_grid(scene, 6, 0.0f);
    add_cloud(scene, random, 20, 0.1f);
    for (int i = 0; i < 20; ++i) {
        const vec3 a = random.in_box(1.0f), b = random.in_box(1.0f);
        add_triangle(scene, a, b, 0.5f * (a + b));
        add_triangle(scene, a, b, vec3(std::nanf("")));
    }
    end_world(scene);
    for (int i = 0; i < 20; ++i)
        add_instance(scene, 0, compose(translation(random.in_box(1.0f)), scaling(vec3(random.range(0.1f, 0.4f)))));
    expect_agreement_for_cameras(scene, 50);
}

// Straight down onto vertices and edges of squares: a whole packet of ties, with nothing left of the slack.
TEST(BvhAgrees, ParallelRaysOnEdges)
{
    for (const float offset : {0.0f, 1000.0f}) {
        PackedScene scene;
        for (const float height : {-0.5f, 0.0f, 0.0f}) add_grid(scene, 16, height);
        for (vec3& p : scene.positions) p += vec3(offset, -offset, 0.5f * offset);
        end_world(scene);
        for (int axis = 0; axis < 3; ++axis) {
            std::vector<Ray> rays;
            for (int i = -32; i <= 32; ++i)
                for (int j = -16; j < 16; ++j) {
                    const vec3 at(static_cast<float>(i) / 32.0f, static_cast<float>(j) / 16.0f, 0.0f);
                    vec3 direction(0.0f, -0.0f, 0.0f);
                    direction[axis] = -1.0f;
                    rays.push_back(
                        make_ray(at + vec3(offset, -offset, 0.5f * offset) - 2.0f * direction, direction, infinity()));
                }
            expect_agreement(scene, rays, axis == 2 ? rays.size() : 0);
        }
    }
}

// Batches shorter and longer than the number of rays in flight, and none at all.
TEST(BvhAgrees, BatchSizes)
{
    Random random(13);
    PackedScene scene;
    add_soup(scene, random, 200, 0.3f);
    end_world(scene);
    for (const int count : {0, 1, 2, 15, 16, 17, 31, 33, 100}) expect_agreement(scene, random_rays(random, count), 0);
}

// One axis a thousand million times longer, and a spiral of shrinking triangles: trees that degenerate.
TEST(BvhAgrees, ExponentialSpacing)
{
    Random random(12);
    PackedScene scene;
    for (int i = 0; i < 400; ++i) {
        const float s = std::exp2(-0.1f * static_cast<float>(i));
        add_triangle(scene, vec3(s, -s, s), vec3(s, s, -s), vec3(s * 1.001f, s, s));
    }
    end_world(scene);
    expect_agreement(scene, 1);
}

} // namespace
} // namespace snell::test
