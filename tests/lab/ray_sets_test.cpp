// The rays that structures are measured with.
#include "snell/core/parallel.h"
#include "snell/lab/cross_check.h"
#include "snell/lab/ray_sets.h"
#include "snell/render/params.h"
#include "snell/scene/builtin.h"
#include "snell/scene/shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

namespace snell {
namespace {

struct Fixture
{
    PackedScene packed;
    Camera camera = {};
    std::unique_ptr<Accel> accel;

    Fixture(Scene scene, std::size_t rays, const char* name = "bvh8")
    {
        validate(scene);
        complete(scene, 1.0f);
        packed = pack(scene);
        const int side = ray_set_side(rays);
        camera = make_camera(scene.cameras.at(0), side, side);
        accel = find_accel(name)->make(packed, {});
    }
    std::vector<RaySet> sets(const RaySetOptions& options) const
    {
        return make_ray_sets(packed, camera, *accel, options);
    }
};

bool same_bytes(const std::vector<RaySet>& a, const std::vector<RaySet>& b)
{
    if (a.size() != b.size()) return false;
    for (std::size_t i = 0; i < a.size(); ++i)
        if (a[i].rays.size() != b[i].rays.size() ||
            std::memcmp(a[i].rays.data(), b[i].rays.data(), a[i].rays.size() * sizeof(Ray)) != 0)
            return false;
    return true;
}

RaySetOptions options_for(std::size_t rays, uint seed = 1)
{
    RaySetOptions options;
    options.rays = rays;
    options.seed = seed;
    return options;
}

TEST(RaySets, AreTheSameForAnyStructureAndNumberOfThreads)
{
    const RaySetOptions options = options_for(5000);
    const Fixture fixture(make_field(1000), options.rays), brute(make_field(1000), options.rays, "brute");
    const std::vector<RaySet> sets = fixture.sets(options);
    EXPECT_TRUE(same_bytes(sets, brute.sets(options)));
    set_thread_count(1);
    EXPECT_TRUE(same_bytes(sets, fixture.sets(options)));
    set_thread_count(0);
    EXPECT_FALSE(same_bytes(sets, fixture.sets(options_for(5000, 2)))) << "the seed matters";
}

TEST(RaySets, HaveTheirSizesAndLengths)
{
    EXPECT_EQ(ray_set_side(1 << 20), 1024);
    EXPECT_EQ(ray_set_side(5000), 64);
    EXPECT_EQ(ray_set_side(1), 8);
    const RaySetOptions options = options_for(5000);
    const Fixture fixture(make_field(1000), options.rays);
    const std::vector<RaySet> sets = fixture.sets(options);
    ASSERT_EQ(sets.size(), 6u);
    const char* names[] = {"camera", "shadow", "ao", "bounce1", "bounce2", "bounce3"};
    for (std::size_t i = 0; i < 6; ++i) {
        EXPECT_EQ(sets[i].name, names[i]);
        EXPECT_EQ(sets[i].any_hit, i == 1 || i == 2);
        for (const Ray& ray : sets[i].rays) {
            ASSERT_EQ(ray.t_min, 0.0f);
            ASSERT_EQ(ray.t_max, i == 1 ? 1.0f : i == 2 ? 0.25f * fixture.packed.radius : infinity());
            if (i != 1) {
                ASSERT_NEAR(length(ray.direction), 1.0f, 1e-5f);
            }
        }
    }
    EXPECT_EQ(sets[0].rays.size(), 64u * 64u);
    EXPECT_GT(sets[1].rays.size(), 2500u); // not those behind the lamp
    for (std::size_t i = 2; i < 6; ++i) EXPECT_EQ(sets[i].rays.size(), 5000u);
}

TEST(RaySets, CameraRaysGoThroughTheirPixelsInTiles)
{
    const RaySetOptions options = options_for(1024);
    const Fixture fixture(make_builtin_scene("cornell").value(), options.rays);
    const std::vector<Ray> rays = fixture.sets(options)[0].rays;
    ASSERT_EQ(rays.size(), 1024u);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const std::size_t tile = i / 64, x = tile % 4 * 8 + i % 8, y = tile / 4 * 8 + i % 64 / 8;
        const vec3 at = camera_project(fixture.camera, rays[i].origin + rays[i].direction);
        ASSERT_NEAR(at.x, static_cast<float>(x) + 0.5f, 0.501f) << i;
        ASSERT_NEAR(at.y, static_cast<float>(y) + 0.5f, 0.501f) << i;
    }
}

// Every hit of a closed room sends rays into the room: they all hit something, and none the surface it starts from.
TEST(RaySets, BouncesStayInAClosedRoom)
{
    const RaySetOptions options = options_for(4096);
    const Fixture fixture(make_field(1000), options.rays);
    const std::vector<RaySet> sets = fixture.sets(options);
    for (const RaySet& set : sets) {
        if (set.any_hit) continue;
        std::vector<Hit> hits(set.rays.size());
        fixture.accel->intersect(set.rays, hits);
        std::size_t misses = 0, at_once = 0;
        for (const Hit& hit : hits) {
            misses += !is_hit(hit);
            at_once += is_hit(hit) && hit.t < 1e-6f;
        }
        EXPECT_EQ(misses, 0u) << set.name;
        EXPECT_LE(at_once, 2u) << set.name;
    }
}

TEST(RaySets, BouncesFollowTheCosineOnTheSideOfTheRayBefore)
{
    for (const float side : {1.0f, -1.0f}) {
        Scene scene;
        place(scene, make_quad("floor", {-9, 0, 9}, {9, 0, 9}, {9, 0, -9}, {-9, 0, -9}, add(scene, MaterialDesc{})));
        add(scene, CameraDesc{"above or below", {0, 5 * side, 0.1f}, {0, 0, 0}, {0, 0, -1}, 40.0f});
        const RaySetOptions options = options_for(20000);
        const Fixture fixture(std::move(scene), options.rays);
        const std::vector<RaySet> sets = fixture.sets(options);
        ASSERT_EQ(sets[3].rays.size(), 20000u);
        double sum = 0, along = 0;
        for (const Ray& ray : sets[3].rays) {
            ASSERT_GT(side * ray.direction.y, -1e-6f);
            ASSERT_GT(side * ray.origin.y, 0.0f);
            sum += static_cast<double>(side * ray.direction.y);
            along += static_cast<double>(ray.direction.x);
        }
        EXPECT_NEAR(sum / 20000, 2.0 / 3.0, 0.006); // of the cosine distribution; three deviations
        EXPECT_NEAR(along / 20000, 0.0, 0.012);
        EXPECT_TRUE(sets[4].rays.empty()) << "nothing for them to hit";
        EXPECT_TRUE(sets[5].rays.empty());
        // The studio of a scene without lamps has no place: a square below the top stands in.
        EXPECT_EQ(sets[1].rays.size(), 20000u);
    }
}

TEST(RaySets, OfNothingAreEmpty)
{
    Scene scene = make_builtin_scene("cornell").value();
    scene.cameras.assign(1, CameraDesc{"away", {0, 0, 50}, {0, 0, 100}, {0, 1, 0}, 40.0f});
    const RaySetOptions options = options_for(1000);
    const Fixture fixture(std::move(scene), options.rays);
    const std::vector<RaySet> sets = fixture.sets(options);
    EXPECT_FALSE(sets[0].rays.empty());
    for (std::size_t i = 1; i < 6; ++i) EXPECT_TRUE(sets[i].rays.empty()) << sets[i].name;
}

TEST(CrossCheck, SeesASingleWrongBit)
{
    const RaySetOptions options = options_for(4096);
    const Fixture fixture(make_field(1000), options.rays);
    const std::vector<RaySet> sets = fixture.sets(options);
    const std::vector<Ray>& rays = sets[4].rays;
    std::vector<Hit> hits(rays.size());
    fixture.accel->intersect(rays, hits);
    EXPECT_EQ(compare_hits(rays, hits, hits).count, 0u);
    EXPECT_EQ(compare_hits_nearly(rays, hits, hits, 0, 0).count, 0u);

    const auto broken = [&](auto change) {
        std::vector<Hit> copy = hits;
        change(copy[1234]);
        const Disagreement exact = compare_hits(rays, hits, copy);
        EXPECT_EQ(exact.count, 1u);
        EXPECT_EQ(exact.first, 1234u);
        EXPECT_NE(exact.text.find("ray 1234 (origin "), std::string::npos) << exact.text;
        return compare_hits_nearly(rays, hits, copy, 1e-4, 1e-5).count;
    };
    EXPECT_EQ(broken([](Hit& h) { h.t = std::nextafter(h.t, 0.0f); }), 0u);
    EXPECT_EQ(broken([](Hit& h) { h.u = std::nextafter(h.u, 2.0f); }), 0u);
    EXPECT_EQ(broken([](Hit& h) { h.v = -h.v; }), 0u);
    EXPECT_EQ(broken([](Hit& h) { h.primitive ^= 1u; }), 0u); // another one at the same place
    EXPECT_EQ(broken([](Hit& h) { h.instance = 0; }), 0u);
    EXPECT_EQ(broken([](Hit& h) { h.t *= 1.001f; }), 1u);
    EXPECT_EQ(broken([](Hit& h) { h.t = std::nanf(""); }), 1u);
    EXPECT_EQ(broken([](Hit& h) { h = miss(infinity()); }), 1u);
}

TEST(CrossCheck, AllowsMoreAlongAGrazingRay)
{
    const std::vector<Ray> rays(1, make_ray(vec3(0), vec3(0, 0, 1), 9));
    const std::vector<Hit> a = {{1.0f, 0, 0, 7, none}}, b = {{1.001f, 0, 0, 7, none}}, c = {{1.1f, 0, 0, 7, none}};
    const auto grazing = [](const Ray&, const Hit&) { return 0.05; };
    EXPECT_EQ(compare_hits_nearly(rays, a, b, 1e-4, 0).count, 1u);
    EXPECT_EQ(compare_hits_nearly(rays, a, b, 1e-4, 0, grazing).count, 0u);
    EXPECT_EQ(compare_hits_nearly(rays, a, c, 1e-4, 0, grazing).count, 1u);
    EXPECT_EQ(compare_hits_nearly(rays, a, b, 0, 0.01).count, 0u);
}

TEST(CrossCheck, OfAnyHit)
{
    const std::vector<Ray> rays(5, make_ray(vec3(0), vec3(0, 0, 1), 1));
    const std::vector<std::uint8_t> a = {0, 1, 0, 1, 1}, b = {0, 2, 1, 0, 1};
    EXPECT_EQ(compare_blocked(rays, a, a).count, 0u);
    const Disagreement d = compare_blocked(rays, a, b); // 2 is neither
    EXPECT_EQ(d.count, 3u);
    EXPECT_EQ(d.first, 1u);
    EXPECT_NE(d.text.find("something expected, no answer found"), std::string::npos) << d.text;
    EXPECT_EQ(allowed_disagreements(10), 3u);
    EXPECT_EQ(allowed_disagreements(1'000'000), 100u);
}

} // namespace
} // namespace snell
