// Embree's hits are brute force's, bit for bit but for rays that graze an edge.
#include "snell/core/error.h"
#include "snell/kernel/intersect.h"
#include "tests/bvh/scenes.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstring>

#ifdef SNELL_HAS_EMBREE
#include "snell/bvh/embree_rays.h"
#include "snell/bvh/embree_scene.h"
#endif

namespace snell::test {
namespace {

#ifndef SNELL_HAS_EMBREE

TEST(Embree, SaysWhatToInstall)
{
    try {
        find_accel("embree")->make({}, {});
        FAIL() << "there is no Embree in this build";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("libembree-dev"), std::string::npos) << error.what();
    }
}

#else

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

// What brute force answers: the nearest hits, whether there are any, and the hits behind, link by link.
struct Truth
{
    std::vector<Ray> rays;
    std::vector<Hit> hits;
    std::vector<std::uint8_t> blocked;
    struct Link
    {
        std::vector<Ray> rays;
        std::vector<Hit> after, hits;
    };
    std::vector<Link> links;
};

Truth find_truth(const Accel& brute, const std::vector<Ray>& rays)
{
    Truth truth = {rays, std::vector<Hit>(rays.size()), std::vector<std::uint8_t>(rays.size()), {}};
    brute.intersect(rays, truth.hits);
    brute.occluded(rays, truth.blocked);
    const std::vector<Hit>* hits = &truth.hits;
    const std::vector<Ray>* from = &rays;
    for (int i = 0; i < 3; ++i) {
        Truth::Link link;
        for (std::size_t k = 0; k < hits->size(); ++k)
            if (is_hit((*hits)[k])) link.rays.push_back((*from)[k]), link.after.push_back((*hits)[k]);
        if (link.rays.empty()) break;
        link.hits.resize(link.rays.size());
        brute.intersect_next(link.rays, link.after, link.hits);
        truth.links.push_back(std::move(link));
        hits = &truth.links.back().hits, from = &truth.links.back().rays;
    }
    return truth;
}

// `tolerated` rays may differ in each of the three.
void expect_agreement(const Accel& embree, const Truth& truth, std::size_t tolerated)
{
    const std::size_t count = truth.rays.size();
    std::vector<Hit> hits(count), counted(count);
    std::vector<std::uint8_t> blocked(count, 77);
    std::vector<uint> steps(count, 77);
    embree.intersect(truth.rays, hits);
    embree.occluded(truth.rays, blocked);
    embree.intersect_counted(truth.rays, counted, steps);

    std::size_t different = 0, different_any = 0, different_next = 0;
    std::string first;
    const auto note = [&](std::size_t& number, const Ray& ray, const Hit& want, const Hit& got) {
        if (number++ == 0) first += fmt::format("expected {}\n     got {}\n", describe(ray, want), describe(ray, got));
    };
    for (std::size_t i = 0; i < count; ++i) {
        if (!same(hits[i], truth.hits[i])) note(different, truth.rays[i], truth.hits[i], hits[i]);
        if (blocked[i] != truth.blocked[i]) note(different_any, truth.rays[i], truth.hits[i], hits[i]);
        ASSERT_LE(blocked[i], 1);
        ASSERT_TRUE(same(counted[i], hits[i]));
        ASSERT_EQ(steps[i], 0u);
    }
    for (const Truth::Link& link : truth.links) {
        std::vector<Hit> found(link.hits.size());
        embree.intersect_next(link.rays, link.after, found);
        for (std::size_t i = 0; i < found.size(); ++i)
            if (!same(found[i], link.hits[i])) note(different_next, link.rays[i], link.hits[i], found[i]);
    }
    EXPECT_LE(different, tolerated) << first;
    EXPECT_LE(different_any, tolerated) << first;
    EXPECT_LE(different_next, tolerated) << first;
}

// Both triangle tests, every way of asking Embree.
void expect_agreement(const PackedScene& scene, const std::vector<Ray>& rays, std::size_t tolerated)
{
    AccelOptions options;
    for (const TriangleTest test : {TriangleTest::watertight, TriangleTest::moller_trumbore}) {
        options.triangle_test = test;
        const Truth truth = find_truth(*find_accel("brute")->make(scene, options), rays);
        for (const Traversal traversal : {Traversal::automatic, Traversal::packets, Traversal::stream}) {
            SCOPED_TRACE(
                fmt::format("triangle test {}, traversal {}", static_cast<int>(test), static_cast<int>(traversal)));
            options.traversal = traversal;
            expect_agreement(*find_accel("embree")->make(scene, options), truth, tolerated);
        }
    }
}

// Groups, one of them empty, instances, spheres, planes.
PackedScene everything()
{
    Random random(3);
    PackedScene scene;
    add_soup(scene, random, 60, 0.3f);
    add_cloud(scene, random, 5, 0.4f);
    end_group(scene);
    add_cloud(scene, random, 30, 0.2f);
    end_group(scene);
    end_group(scene);
    add_soup(scene, random, 1, 1.0f);
    end_group(scene);
    add_soup(scene, random, 40, 0.2f);
    add_cloud(scene, random, 20, 0.1f);
    end_world(scene);
    for (uint i = 0; i < 60; ++i)
        add_instance(scene, i % 4,
                     compose(translation(2.0f * random.in_box(1.0f)),
                             compose(rotation(random.direction(), random.range(0.0f, 360.0f)),
                                     scaling(vec3(random.range(0.1f, 0.4f))))));
    add_plane(scene, vec3(0.1f, 1.0f, 0.2f), -1.5f);
    return scene;
}

// Rays that graze nothing: not one may differ.
TEST(Embree, AgreesOnRandomRays)
{
    Random random(4);
    expect_agreement(everything(), random_rays(random, 2500), 0);
    for (const int count : {0, 1, 3, 40, 1000}) {
        SCOPED_TRACE(count);
        PackedScene scene;
        add_soup(scene, random, count, 0.3f);
        end_world(scene);
        expect_agreement(scene, random_rays(random, 1000), 0);
    }
}

// NaN, infinities, empty intervals, negative t_min, directions of all lengths, from vertices and along edges; they are
// as many on every machine, and so are the ones that graze.
TEST(Embree, AgreesOnHostileRays)
{
    const PackedScene scene = everything();
    Random random(5);
    const std::vector<Ray> rays = hostile_rays(scene, random);
    ASSERT_GT(rays.size(), 1000u);
    expect_agreement(scene, rays, rays.size() / 500);

    PackedScene far_off = scene;
    for (vec3& p : far_off.positions) p += vec3(1e4f, -1e4f, 5e3f);
    Random again(6);
    expect_agreement(far_off, random_rays(again, 1000, 1.0f, vec3(1e4f, -1e4f, 5e3f)), 1);
}

// Intervals that end before the origin, or begin there, with the scene before and behind it.
TEST(Embree, LooksBehindTheOrigin)
{
    const PackedScene scene = everything();
    Random random(11);
    std::vector<Ray> rays;
    for (int i = 0; i < 1000; ++i) {
        Ray ray = ray_between(3.0f * random.direction(), random.in_box(0.5f));
        if (i % 2 == 1) ray.direction = -ray.direction;
        ray.t_min = random.range(-3.0f, 0.0f);
        ray.t_max = i % 3 == 0 ? random.range(-1.0f, 1.0f) : 0.0f;
        rays.push_back(ray);
    }
    expect_agreement(scene, rays, 0);
}

// The scene by itself, as benchmarks use it: a filter that refuses the near side of a sphere is asked about the far
// one, for single rays and packets, and for shadows.
TEST(EmbreeScene, FiltersAreAskedAboutBothSidesOfSpheres)
{
    PackedScene scene;
    add_sphere(scene, vec3(0.0f), 1.0f);
    end_world(scene);
    EmbreeSceneOptions options;
    options.filter = true;
    const EmbreeScene embree(scene, options);
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.filter = [](const RTCFilterFunctionNArguments* a) {
        for (uint i = 0; i < a->N; ++i)
            if (RTCRayN_tfar(a->ray, a->N, i) < 3.5f) a->valid[i] = 0;
    };
    const Ray ray = make_ray(vec3(0.0f, 0.0f, 4.0f), vec3(0.0f, 0.0f, -1.0f), infinity());
    RTCRayHit query = to_query(ray);
    rtcIntersect1(embree.handle(), &context, &query);
    const Hit hit = to_hit(scene, query, ray.t_max);
    EXPECT_EQ(hit.t, 5.0f);
    EXPECT_EQ(hit.primitive, pack_primitive(kind_sphere, 0));
    EXPECT_EQ(hit.instance, none);
    RTCRay shadow = to_embree(ray);
    rtcOccluded1(embree.handle(), &context, &shadow);
    EXPECT_LT(shadow.tfar, 0.0f);
    shadow = to_embree(make_ray(ray.origin, ray.direction, 4.5f));
    rtcOccluded1(embree.handle(), &context, &shadow);
    EXPECT_GT(shadow.tfar, 0.0f);
    context.filter = nullptr;
    query = to_query(ray);
    rtcIntersect1(embree.handle(), &context, &query);
    EXPECT_EQ(query.ray.tfar, 3.0f);
}

// Straight onto vertices and edges of a grid: no hole inside of it, whichever of the triangles is found.
TEST(Embree, RobustModeHasNoHoles)
{
    PackedScene scene;
    add_grid(scene, 8, 0.0f);
    end_world(scene);
    std::vector<Ray> rays;
    for (int i = -15; i <= 15; ++i)
        for (int j = -15; j <= 15; ++j)
            rays.push_back(make_ray(vec3(static_cast<float>(i) / 16.0f, static_cast<float>(j) / 16.0f, 2.0f),
                                    vec3(0.0f, 0.0f, -1.0f), infinity()));
    std::vector<Hit> hits(rays.size());
    std::vector<std::uint8_t> blocked(rays.size());
    const auto accel = find_accel("embree")->make(scene, {});
    accel->intersect(rays, hits);
    accel->occluded(rays, blocked);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        ASSERT_EQ(hits[i].t, 2.0f) << describe(rays[i], hits[i]);
        ASSERT_EQ(blocked[i], 1);
    }
}

// Coplanar surfaces come one after the other, each once; spheres twice, from outside and from inside.
TEST(Embree, EverySurfaceOfAStackComesOnce)
{
    PackedScene scene;
    for (int i = 0; i < 5; ++i) add_triangle(scene, vec3(-1, -1, 0), vec3(1, -1, 0), vec3(0, 1, 0));
    add_sphere(scene, vec3(0, 0, -3), 1.0f);
    add_sphere(scene, vec3(0, 0, -3), 1.0f);
    end_world(scene);
    add_plane(scene, vec3(0, 0, 1), 0.0f);
    expect_agreement(scene, {make_ray(vec3(0.1f, 0.1f, 2.0f), vec3(0, 0, -1), infinity())}, 0);
    for (const Traversal traversal : {Traversal::single, Traversal::packets, Traversal::stream}) {
        AccelOptions options;
        options.traversal = traversal;
        const auto accel = find_accel("embree")->make(scene, options);
        const std::vector<Ray> rays = {make_ray(vec3(0.1f, 0.1f, 2.0f), vec3(0, 0, -1), infinity())};
        std::vector<Hit> hits(1), next(1);
        accel->intersect(rays, hits);
        int count = 0;
        for (; is_hit(hits[0]) && count < 20; ++count) {
            accel->intersect_next(rays, hits, next);
            hits = next;
        }
        EXPECT_EQ(count, 5 + 1 + 2 * 2);
    }
}

// Whatever has moved is found where it is, refitted or rebuilt, frame after frame.
TEST(Embree, FollowsChanges)
{
    for (const UpdatePolicy policy : {UpdatePolicy::automatic, UpdatePolicy::refit, UpdatePolicy::rebuild}) {
        PackedScene scene = everything();
        AccelOptions options;
        options.update = policy;
        const auto accel = find_accel("embree")->make(scene, options);
        const auto brute = find_accel("brute")->make(scene, options);
        Random random(7);
        const auto move = [&](const PackedGroup& group) {
            for (uint i = 0; i < group.triangle_count; ++i)
                scene.positions[scene.triangles[group.first_triangle + i].v1] += 0.1f * random.in_box(1.0f);
            for (uint i = 0; i < group.sphere_count; ++i)
                scene.spheres[group.first_sphere + i].center += 0.1f * random.in_box(1.0f);
        };
        for (int frame = 0; frame < 6; ++frame) {
            SCOPED_TRACE(fmt::format("policy {}, frame {}", static_cast<int>(policy), frame));
            PackedChanges changes;
            if (frame % 3 != 1) {
                changes.world = true;
                move(scene.world);
            }
            if (frame % 3 != 2) {
                changes.groups = {0, 1, 2};
                for (const uint group : changes.groups) move(scene.groups[group]);
            }
            if (frame % 2 == 1) {
                changes.instances = true;
                for (Instance& instance : scene.instances) {
                    instance.to_world = compose(translation(0.2f * random.in_box(1.0f)), instance.to_world);
                    instance.to_object = inverse(instance.to_world).value();
                }
            }
            accel->update(changes);
            const std::size_t trees = changes.groups.size() + (changes.world ? 1 : 0);
            EXPECT_EQ(accel->stats.refitted + accel->stats.rebuilt, trees);
            EXPECT_EQ(accel->stats.refitted, policy == UpdatePolicy::refit && frame > 0 ? trees : 0u);
            Random others(8);
            expect_agreement(*accel, find_truth(*brute, random_rays(others, 500)), 0);
        }
        accel->update({});
        EXPECT_EQ(accel->stats.refitted + accel->stats.rebuilt, 0u);
    }
}

TEST(Embree, StatisticsAndOptions)
{
    Random random(9);
    PackedScene scene;
    add_soup(scene, random, 2000, 0.1f);
    end_world(scene);
    AccelOptions options;
    for (const char* builder : {"", "lbvh", "sbvh", "binned"}) {
        if (*builder != 0 && find_builder(builder) == nullptr) continue;
        options.build.builder = builder;
        const auto accel = find_accel("embree")->make(scene, options);
        EXPECT_GT(accel->stats.bytes, scene.triangles.size() * 36);
        EXPECT_LT(accel->stats.bytes, scene.triangles.size() * 500);
        EXPECT_GT(accel->stats.build_seconds, 0.0);
        expect_agreement(*accel, find_truth(*find_accel("brute")->make(scene, {}), random_rays(random, 200)), 0);
    }
    options.build.builder = "no such thing";
    EXPECT_THROW(find_accel("embree")->make(scene, options), Error);
}

TEST(Embree, NothingToHit)
{
    PackedScene scene;
    end_group(scene);
    end_world(scene);
    for (int i = 0; i < 10; ++i) add_instance(scene, 0, translation(vec3(static_cast<float>(i))));
    add_triangle(scene, vec3(std::nanf("")), vec3(1.0f, 0.0f, 0.0f), vec3(0.0f, 1.0f, 0.0f));
    add_sphere(scene, vec3(std::nanf("")), 1.0f);
    add_sphere(scene, vec3(0.0f), 0.0f);
    end_world(scene);
    Random random(10);
    std::vector<Ray> rays = random_rays(random, 200);
    rays.push_back(make_ray(vec3(0.0f, 0.0f, 5.0f), vec3(0.0f, 0.0f, -1.0f), infinity()));
    expect_agreement(scene, rays, 0);
    expect_agreement(scene, {}, 0);
}

#endif

} // namespace
} // namespace snell::test
