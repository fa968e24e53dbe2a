// Trees that follow moved primitives answer as trees built anew: bit for bit, whatever the policy.
#include "snell/bvh/options.h"
#include "snell/core/parallel.h"
#include "tests/bvh/scenes.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstring>
#include <utility>

namespace snell::test {
namespace {

constexpr std::string_view layouts[] = {"bvh8", "bvh8q", "bvh4", "bvh2"};

std::unique_ptr<Accel> make(const PackedScene& scene, UpdatePolicy policy, std::string_view name = "bvh8")
{
    AccelOptions options;
    options.update = policy;
    return find_accel(name)->make(scene, options);
}

// Closest, next and any hits of both, bit for bit.
void expect_same_answers(const Accel& a, const Accel& b, const std::vector<Ray>& rays)
{
    std::vector<Hit> expected(rays.size()), found(rays.size());
    a.intersect(rays, found);
    b.intersect(rays, expected);
    std::size_t wrong = 0, hits = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        hits += is_hit(expected[i]) ? 1 : 0;
        wrong += std::memcmp(&expected[i], &found[i], sizeof(Hit)) != 0 ? 1 : 0;
    }
    EXPECT_EQ(wrong, 0u) << "of " << rays.size() << " rays, " << hits << " hits";
    EXPECT_GT(hits, rays.size() / 20) << "or nothing is tested";

    std::vector<std::uint8_t> blocked(rays.size()), blocked_expected(rays.size());
    a.occluded(rays, blocked);
    b.occluded(rays, blocked_expected);
    EXPECT_EQ(blocked, blocked_expected);

    std::vector<Ray> onward;
    std::vector<Hit> after;
    for (std::size_t i = 0; i < rays.size(); i += 10)
        if (is_hit(expected[i])) onward.push_back(rays[i]), after.push_back(expected[i]);
    expected.resize(onward.size());
    found.resize(onward.size());
    a.intersect_next(onward, after, found);
    b.intersect_next(onward, after, expected);
    EXPECT_EQ(std::memcmp(expected.data(), found.data(), expected.size() * sizeof(Hit)), 0);
}

void expect_same_as_brute_force(const Accel& accel, const PackedScene& scene, const std::vector<Ray>& rays)
{
    expect_same_answers(accel, *make(scene, UpdatePolicy::automatic, "brute"), rays);
}

// Where the vertices of a scene are at a moment: a wave that turns and swells.
struct Wave
{
    std::vector<vec3> rest;
    std::vector<Sphere> balls;

    explicit Wave(const PackedScene& scene) : rest(scene.positions), balls(scene.spheres) {}

    vec3 at(vec3 p, float time) const
    {
        const vec3 w(std::sin(3.0f * p.y + time), std::sin(4.0f * p.z + 1.3f * time), std::sin(5.0f * p.x - time));
        return p + 0.2f * w;
    }

    void move(PackedScene& scene, float time) const
    {
        for (std::size_t i = 0; i < rest.size(); ++i) scene.positions[i] = at(rest[i], time);
        for (std::size_t i = 0; i < balls.size(); ++i) scene.spheres[i].center = at(balls[i].center, time);
    }
};

PackedChanges world_changes()
{
    PackedChanges changes;
    changes.world = true;
    return changes;
}

// A world of triangles and spheres, two groups of the same, and instances of them.
PackedScene two_levels(Random& random)
{
    PackedScene scene;
    add_soup(scene, random, 400, 0.15f);
    add_cloud(scene, random, 40, 0.1f);
    end_group(scene);
    add_soup(scene, random, 40, 0.5f);
    end_group(scene);
    add_soup(scene, random, 1000, 0.15f);
    add_cloud(scene, random, 80, 0.1f);
    end_world(scene);
    for (uint i = 0; i < 12; ++i) {
        const vec3 factors(random.range(0.2f, 0.6f), 0.3f, i % 2 ? -0.4f : 0.4f);
        add_instance(scene, i % 2,
                     compose(translation(1.5f * random.in_box(1.0f)),
                             compose(rotation(random.direction(), random.range(0.0f, 360.0f)), scaling(factors))));
    }
    return scene;
}

void follow_a_hundred_frames(std::string_view name, UpdatePolicy policy)
{
    SCOPED_TRACE(fmt::format("{} policy {}", name, static_cast<int>(policy)));
    Random random(41);
    PackedScene scene = two_levels(random);
    const Wave wave(scene);
    const std::vector<Ray> rays = random_rays(random, 2000, 1.5f);
    const std::unique_ptr<Accel> accel = make(scene, policy, name);
    PackedChanges changes = world_changes();
    changes.groups = {0, 1};
    changes.instances = true;
    for (int frame = 1; frame <= 100; ++frame) {
        wave.move(scene, 0.1f * static_cast<float>(frame));
        for (std::size_t i = 0; i < scene.instances.size(); ++i) {
            Instance& instance = scene.instances[i];
            instance.to_world = compose(rotation(vec3(0, 1, 0), 2.0f * static_cast<float>(i)), instance.to_world);
            instance.to_object = inverse(instance.to_world).value();
        }
        accel->update(changes);
        ASSERT_EQ(accel->stats.refitted + accel->stats.rebuilt, 3u);
        if (policy == UpdatePolicy::refit) {
            ASSERT_EQ(accel->stats.rebuilt, 0u);
        } else if (policy == UpdatePolicy::rebuild) {
            ASSERT_EQ(accel->stats.refitted, 0u);
        }
        if (frame % 40 == 1) expect_same_answers(*accel, *make(scene, policy, name), rays);
    }
    expect_same_as_brute_force(*accel, scene, rays);
}

TEST(Refit, AfterAHundredFramesTheHitsAreThoseOfANewTree)
{
    for (const std::string_view name : layouts)
        for (const UpdatePolicy policy : {UpdatePolicy::automatic, UpdatePolicy::refit})
            follow_a_hundred_frames(name, policy);
    follow_a_hundred_frames("bvh8", UpdatePolicy::rebuild);
}

// Triangles whose vertices change places, as those do whose normals turn round: leaves share vertices by number.
TEST(Refit, TrianglesThatAreWoundAnew)
{
    Random random(50);
    PackedScene scene;
    constexpr uint n = 24;
    for (uint i = 0; i <= n; ++i)
        for (uint j = 0; j <= n; ++j) scene.positions.push_back(vec3(float(i), float(j), 0.0f) * (2.0f / n) - 1.0f);
    for (uint i = 0; i < n; ++i)
        for (uint j = 0; j < n; ++j) {
            const uint a = i * (n + 1) + j;
            scene.triangles.push_back({a, a + 1, a + n + 2, 0});
            scene.triangles.push_back({a, a + n + 2, a + n + 1, 0});
        }
    end_world(scene);
    const std::vector<Ray> rays = random_rays(random, 1000);
    for (const std::string_view name : layouts) {
        SCOPED_TRACE(name);
        const std::unique_ptr<Accel> accel = make(scene, UpdatePolicy::refit, name);
        for (int frame = 0; frame < 3; ++frame) {
            for (vec3& p : scene.positions) p += 0.01f * random.in_box(1.0f);
            for (Triangle& triangle : scene.triangles)
                if (random.uniform() < 0.3f) std::swap(triangle.v1, triangle.v2);
            accel->update(world_changes());
            EXPECT_EQ(accel->stats.refitted, 1u);
            expect_same_as_brute_force(*accel, scene, rays);
        }
    }
}

TEST(Refit, LargeMovesOfLargeTrees)
{
    // Many chunks of nodes; everything ends up elsewhere.
    Random random(42);
    PackedScene scene;
    add_soup(scene, random, 25'000, 0.03f);
    end_world(scene);
    const std::unique_ptr<Accel> accel = make(scene, UpdatePolicy::refit);
    const std::unique_ptr<Accel> monitored = make(scene, UpdatePolicy::automatic);
    const double built = accel->stats.sah_cost;
    for (vec3& p : scene.positions) p = vec3(-p.y, p.z, 2.0f * p.x) + vec3(10.0f, 0.0f, 0.0f);
    accel->update(world_changes());
    EXPECT_EQ(accel->stats.refitted, 1u);
    // The same shape, stretched: no worse a tree.
    EXPECT_NEAR(accel->stats.sah_cost, built, 0.25 * built);
    const std::vector<Ray> rays = random_rays(random, 3000, 1.0f, vec3(10.0f, 0.0f, 0.0f));
    expect_same_answers(*accel, *make(scene, UpdatePolicy::refit), rays);
    monitored->update(world_changes());
    EXPECT_EQ(monitored->stats.refitted, 1u);

    // Triangle by triangle anywhere: as bad as can be.
    for (std::size_t t = 0; t + 2 < scene.positions.size(); t += 3) {
        const vec3 to = vec3(10.0f, 0.0f, 0.0f) + random.in_box(1.0f);
        for (std::size_t k = 0; k < 3; ++k) scene.positions[t + k] = to + random.in_box(0.03f);
    }
    accel->update(world_changes());
    EXPECT_EQ(accel->stats.refitted, 1u);
    EXPECT_GT(accel->stats.sah_cost, 5.0 * built);
    expect_same_answers(*accel, *make(scene, UpdatePolicy::refit), rays);

    monitored->update(world_changes());
    EXPECT_EQ(monitored->stats.refitted, 0u);
    EXPECT_EQ(monitored->stats.rebuilt, 1u);
    EXPECT_LT(monitored->stats.sah_cost, 1.5 * built);
    expect_same_answers(*monitored, *accel, rays);
    monitored->update(world_changes());
    EXPECT_EQ(monitored->stats.refitted, 1u) << "measured against the last build";
}

TEST(Refit, TheFactorDecides)
{
    for (const double factor : {1.05, 100.0}) {
        Random random(43);
        PackedScene scene;
        add_soup(scene, random, 4000, 0.05f);
        end_world(scene);
        AccelOptions options;
        options.rebuild_factor = factor;
        const std::unique_ptr<Accel> accel = accels().front().make(scene, options);
        const Wave wave(scene);
        wave.move(scene, 2.0f);
        accel->update(world_changes());
        EXPECT_EQ(accel->stats.rebuilt, factor < 2.0 ? 1u : 0u);
        EXPECT_EQ(accel->stats.refitted, factor < 2.0 ? 0u : 1u);
    }
}

TEST(Refit, OnlyWhatChangedIsTouched)
{
    Random random(44);
    PackedScene scene = two_levels(random);
    const std::vector<Ray> rays = random_rays(random, 2000, 1.5f);
    const std::unique_ptr<Accel> accel = make(scene, UpdatePolicy::refit);
    const auto expect_trees = [&](std::size_t refitted) {
        EXPECT_EQ(accel->stats.refitted, refitted);
        EXPECT_EQ(accel->stats.rebuilt, 0u);
        expect_same_answers(*accel, *make(scene, UpdatePolicy::refit), rays);
    };
    accel->update({});
    expect_trees(0);

    PackedChanges changes;
    changes.instances = true;
    for (Instance& instance : scene.instances) {
        instance.to_world = compose(translation(vec3(0.3f, 0.0f, 0.0f)), instance.to_world);
        instance.to_object = inverse(instance.to_world).value();
    }
    accel->update(changes);
    expect_trees(0);

    changes = {};
    changes.groups = {1};
    const PackedGroup& group = scene.groups[1];
    for (uint t = group.first_triangle; t < group.first_triangle + group.triangle_count; ++t)
        for (const uint v : {scene.triangles[t].v0, scene.triangles[t].v1, scene.triangles[t].v2})
            scene.positions[v] *= 2.0f;
    accel->update(changes);
    expect_trees(1);

    changes = world_changes();
    changes.groups = {0};
    Wave(scene).move(scene, 1.0f);
    changes.groups = {0, 1};
    accel->update(changes);
    expect_trees(3);
    accel->update({});
    EXPECT_EQ(accel->stats.refitted, 0u) << "by the last update";
}

// Trees of many chunks of nodes, in every layout.
TEST(Refit, TheSameForAnyNumberOfThreads)
{
    for (const std::string_view name : layouts) {
        SCOPED_TRACE(name);
        Random random(45);
        PackedScene scene;
        add_soup(scene, random, 30'000, 0.03f);
        end_world(scene);
        const auto one = make(scene, UpdatePolicy::refit, name), two = make(scene, UpdatePolicy::refit, name);
        Wave(scene).move(scene, 3.0f);
        set_thread_count(1);
        one->update(world_changes());
        set_thread_count(4);
        two->update(world_changes());
        set_thread_count(0);
        EXPECT_EQ(one->stats.sah_cost, two->stats.sah_cost);
        const std::vector<Ray> rays = random_rays(random, 2000);
        std::vector<Hit> hits_one(rays.size()), hits_two(rays.size());
        std::vector<uint> steps_one(rays.size()), steps_two(rays.size());
        one->intersect_counted(rays, hits_one, steps_one);
        two->intersect_counted(rays, hits_two, steps_two);
        EXPECT_EQ(steps_one, steps_two);
        EXPECT_EQ(std::memcmp(hits_one.data(), hits_two.data(), rays.size() * sizeof(Hit)), 0);
        expect_same_answers(*one, *make(scene, UpdatePolicy::refit, name), rays);
    }
}

// A refit of what has not moved gives the tree that was built: the same boxes, hence the same steps.
TEST(Refit, OfWhatStandsStillChangesNothing)
{
    Random random(46);
    PackedScene scene = two_levels(random);
    AccelOptions options;
    options.update = UpdatePolicy::refit;
    options.build.builder = "binned"; // what builds the tree over the instances for each frame
    const std::unique_ptr<Accel> accel = find_accel("bvh8")->make(scene, options),
                                 built = find_accel("bvh8")->make(scene, options);
    PackedChanges changes = world_changes();
    changes.groups = {0, 1};
    accel->update(changes);
    EXPECT_NEAR(accel->stats.sah_cost, built->stats.sah_cost, 1e-5 * built->stats.sah_cost);
    const std::vector<Ray> rays = random_rays(random, 3000, 1.5f);
    std::vector<Hit> hits(rays.size());
    std::vector<uint> steps(rays.size()), steps_built(rays.size());
    accel->intersect_counted(rays, hits, steps);
    built->intersect_counted(rays, hits, steps_built);
    double sum = 0, sum_built = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) sum += steps[i], sum_built += steps_built[i];
    EXPECT_NEAR(sum, sum_built, 1e-3 * sum_built); // orders that nearly tie
}

// ---- hostile ----

TEST(RefitHostile, VerticesThatAreNoNumbersComeAndGo)
{
    Random random(47);
    PackedScene scene;
    add_soup(scene, random, 600, 0.3f);
    add_cloud(scene, random, 30, 0.2f);
    end_world(scene);
    const PackedScene rest = scene;
    const std::vector<Ray> rays = random_rays(random, 1000);
    for (const float bad : {std::nanf(""), infinity(), -infinity()})
        for (const std::size_t step : {7u, 100u})
            for (const bool from_the_start : {false, true}) {
                SCOPED_TRACE(fmt::format("{} in every {}th vertex{}", bad, step, from_the_start ? ", and before" : ""));
                scene = rest;
                const auto spoil = [&] {
                    for (std::size_t i = 0; i < scene.positions.size(); i += step) scene.positions[i][int(i % 3)] = bad;
                    for (std::size_t i = 0; i < scene.spheres.size(); i += step) scene.spheres[i].center.y = bad;
                };
                if (from_the_start) spoil();
                const std::unique_ptr<Accel> accel = make(scene, UpdatePolicy::refit);
                expect_same_as_brute_force(*accel, scene, rays);
                spoil();
                accel->update(world_changes());
                EXPECT_EQ(accel->stats.refitted, from_the_start ? 0u : 1u); // else they have no place in the tree
                expect_same_as_brute_force(*accel, scene, rays);
                scene = rest;
                accel->update(world_changes());
                expect_same_as_brute_force(*accel, scene, rays);
            }
}

TEST(RefitHostile, EverythingVanishesAndReturns)
{
    for (const bool in_world : {false, true})
        for (const int count : {1, 3, 200}) {
            SCOPED_TRACE(fmt::format("{} in {}", count, in_world ? "the world" : "a group"));
            Random random(48);
            PackedScene scene;
            add_triangle(scene, vec3(-1.0f, -1.0f, 0.0f), vec3(1.0f, -1.0f, 0.1f), vec3(0.0f, 1.5f, 0.0f));
            add_soup(scene, random, count - 1, 0.5f);
            PackedChanges changes;
            if (in_world) {
                changes.world = true;
            } else {
                end_group(scene);
                add_instance(scene, 0, translation(vec3(0.1f)));
                changes.groups = {0};
            }
            end_world(scene);
            const PackedScene rest = scene;
            const std::vector<Ray> rays = random_rays(random, 1000);
            const std::unique_ptr<Accel> accel = make(scene, UpdatePolicy::refit);
            for (vec3& p : scene.positions) p.x = std::nanf("");
            accel->update(changes);
            std::vector<Hit> hits(rays.size());
            accel->intersect(rays, hits);
            for (const Hit& hit : hits) ASSERT_FALSE(is_hit(hit));
            scene.positions = rest.positions;
            accel->update(changes);
            expect_same_as_brute_force(*accel, scene, rays);
        }
}

TEST(RefitHostile, ShapesWithoutSurfaceAndHugeOnes)
{
    Random random(49);
    PackedScene scene;
    add_soup(scene, random, 500, 0.2f);
    end_world(scene);
    const PackedScene rest = scene;
    for (const UpdatePolicy policy : {UpdatePolicy::refit, UpdatePolicy::automatic}) {
        scene = rest;
        const std::unique_ptr<Accel> accel = make(scene, policy);
        for (const float size : {0.0f, 1e-30f, 1e-6f, 1e9f, 1e25f, 1.0f}) {
            SCOPED_TRACE(size);
            for (std::size_t i = 0; i < scene.positions.size(); ++i) scene.positions[i] = size * rest.positions[i];
            accel->update(world_changes());
            std::vector<Ray> rays = random_rays(random, 500, size);
            std::vector<Hit> hits(rays.size()), expected(rays.size());
            accel->intersect(rays, hits);
            make(scene, policy, "brute")->intersect(rays, expected);
            EXPECT_EQ(std::memcmp(hits.data(), expected.data(), hits.size() * sizeof(Hit)), 0);
        }
    }
}

TEST(RefitHostile, EmptyScenes)
{
    PackedScene scene;
    end_group(scene);
    end_world(scene);
    add_instance(scene, 0, identity_transform());
    const std::unique_ptr<Accel> accel = make(scene, UpdatePolicy::automatic);
    PackedChanges changes = world_changes();
    changes.groups = {0};
    changes.instances = true;
    accel->update(changes);
    const std::vector<Ray> rays = {make_ray(vec3(0.0f), vec3(1.0f), infinity())};
    std::vector<Hit> hits(1);
    accel->intersect(rays, hits);
    EXPECT_FALSE(is_hit(hits[0]));
}

} // namespace
} // namespace snell::test
