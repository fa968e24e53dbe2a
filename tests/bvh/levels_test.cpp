// Two levels: instances find what the same geometry finds when it is written out in world space.
#include "snell/bvh/wide.h"
#include "tests/bvh/scenes.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace snell::test {
namespace {

// The scene with every instance's triangles moved into the world. Triangles keep their order: instance by instance.
PackedScene flatten(const PackedScene& scene)
{
    PackedScene flat;
    for (const Instance& instance : scene.instances) {
        const PackedGroup& group = scene.groups[instance.group];
        for (uint i = 0; i < group.triangle_count; ++i) {
            const Triangle& tri = scene.triangles[group.first_triangle + i];
            const auto at = [&](uint v) { return transform_point(instance.to_world, scene.positions[v]); };
            add_triangle(flat, at(tri.v0), at(tri.v1), at(tri.v2));
        }
    }
    end_world(flat);
    return flat;
}

TEST(TwoLevels, EqualTheFlattenedScene)
{
    Random random(21);
    PackedScene scene;
    add_soup(scene, random, 50, 0.4f);
    end_group(scene);
    add_soup(scene, random, 7, 1.0f);
    end_group(scene);
    end_world(scene);
    for (uint i = 0; i < 80; ++i) {
        const vec3 factors(random.range(0.2f, 0.6f), random.range(0.2f, 0.6f), (i % 2 ? -1.0f : 1.0f) * 0.4f);
        const Transform turned = compose(rotation(random.direction(), random.range(0.0f, 360.0f)), scaling(factors));
        add_instance(scene, i % 2, compose(translation(2.0f * random.in_box(1.0f)), turned));
    }
    const PackedScene flat = flatten(scene);

    const std::vector<Ray> rays = random_rays(random, 20'000, 2.0f);
    std::vector<Hit> hits(rays.size()), flat_hits(rays.size());
    accels().front().make(scene, {})->intersect(rays, hits);
    accels().front().make(flat, {})->intersect(rays, flat_hits);

    std::size_t found = 0, different = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        found += is_hit(flat_hits[i]);
        const float scale = length(rays[i].direction);
        const bool same_place = is_hit(hits[i]) == is_hit(flat_hits[i]) &&
                                (!is_hit(hits[i]) || std::abs(hits[i].t - flat_hits[i].t) * scale < 1e-4f);
        if (!same_place) {
            ++different; // a ray that grazes an edge may fall to either side
            continue;
        }
        if (!is_hit(hits[i])) continue;
        ASSERT_LT(hits[i].instance, scene.instances.size());
        EXPECT_EQ(flat_hits[i].instance, none);
    }
    EXPECT_GT(found, rays.size() / 4);
    EXPECT_LE(different, rays.size() / 5000);
}

// Memory grows with the number of instances, not with what they hold.
TEST(TwoLevels, ManyInstancesOfOneMesh)
{
    Random random(22);
    PackedScene scene;
    add_soup(scene, random, 2000, 0.1f);
    end_group(scene);
    end_world(scene);
    constexpr int side = 30;
    for (int i = 0; i < side * side * side; ++i) {
        const vec3 at(static_cast<float>(i % side), static_cast<float>(i / side % side),
                      static_cast<float>(i / side / side));
        add_instance(scene, 0, compose(translation(4.0f * at), scaling(vec3(0.5f))));
    }
    const auto accel = accels().front().make(scene, {});
    EXPECT_LT(accel->stats.bytes, scene.instances.size() * 150 + 2000 * 150);
    EXPECT_GT(accel->stats.leaves, scene.instances.size());

    // Each instance is found where it is.
    std::vector<Ray> rays;
    for (const Instance& instance : scene.instances) {
        const vec3 target = vec3(instance.to_world.x.w, instance.to_world.y.w, instance.to_world.z.w);
        rays.push_back(ray_between(target + vec3(1.9f, 0.3f, 0.4f), target));
    }
    std::vector<Hit> hits(rays.size());
    accel->intersect(rays, hits);
    std::size_t found = 0;
    for (std::size_t i = 0; i < hits.size(); ++i) found += is_hit(hits[i]) && hits[i].t < 1.0f && hits[i].instance == i;
    EXPECT_GT(found, rays.size() / 2); // all meshes are alike, so all or nothing but for rounding
}

// A tree over a million of them, twice: what it takes does not depend on the mesh.
TEST(TwoLevels, AMillionInstances)
{
    constexpr uint count = 1'000'000;
    std::size_t bytes[2], mesh_bytes[2];
    for (const int large : {0, 1}) {
        Random random(23);
        PackedScene scene;
        add_soup(scene, random, large == 0 ? 10 : 5000, 0.5f);
        end_group(scene);
        end_world(scene);
        const WideTree<Node8> mesh = make_group_tree<Node8>(scene, scene.groups[0], {});
        mesh_bytes[large] = mesh.bytes();
        scene.instances.reserve(count);
        for (uint i = 0; i < count; ++i) {
            const vec3 at(static_cast<float>(i % 100), static_cast<float>(i / 100 % 100),
                          static_cast<float>(i / 10'000));
            add_instance(scene, 0, translation(4.0f * at));
        }
        AccelOptions options;
        options.build = for_each_frame({});
        const auto accel = accels().front().make(scene, options);
        bytes[large] = accel->stats.bytes;
        std::vector<Ray> rays;
        for (uint i = 0; i < count; i += 997) {
            const Transform& place = scene.instances[i].to_world;
            const vec3 origin(place.x.w, place.y.w, place.z.w);
            rays.push_back(ray_between(origin + vec3(1.9f, 0.3f, 0.4f), origin));
        }
        std::vector<Hit> hits(rays.size());
        accel->intersect(rays, hits);
        std::size_t found = 0;
        for (std::size_t i = 0; i < hits.size(); ++i) {
            if (!is_hit(hits[i]) || hits[i].t >= 1.0f) continue; // beyond it are others
            ++found;
            EXPECT_EQ(hits[i].instance, 997 * i);
        }
        if (large == 1) {
            EXPECT_GT(found, 900u);
        }
    }
    const double rest[2] = {static_cast<double>(bytes[0] - mesh_bytes[0]),
                            static_cast<double>(bytes[1] - mesh_bytes[1])};
    EXPECT_GT(mesh_bytes[1], 100 * mesh_bytes[0]);
    EXPECT_NEAR(rest[0], rest[1], 0.05 * rest[0]);
    EXPECT_LT(bytes[0], std::size_t{count} * 80);
}

TEST(TwoLevels, TreesForEachFrameAreBuiltFast)
{
    EXPECT_EQ(for_each_frame({}).builder, "binned");
    BuildOptions options;
    options.builder = "auto";
    EXPECT_EQ(for_each_frame(options).builder, "binned");
    options.builder = "lbvh", options.reinsertion = 1;
    EXPECT_EQ(for_each_frame(options), options); // as it was asked for
}

// A group without anything to hit, and instances of it, are no trouble.
TEST(TwoLevels, EmptyGroups)
{
    PackedScene scene;
    end_group(scene);
    end_world(scene);
    for (int i = 0; i < 10; ++i) add_instance(scene, 0, translation(vec3(static_cast<float>(i))));
    for (const AccelInfo& info : accels()) {
        if (!info.exact) continue;
        const auto accel = info.make(scene, {});
        const std::vector<Ray> rays(100, make_ray(vec3(0.0f), vec3(1.0f), infinity()));
        std::vector<Hit> hits(rays.size());
        accel->intersect(rays, hits);
        for (const Hit& hit : hits) EXPECT_FALSE(is_hit(hit));
    }
}

} // namespace
} // namespace snell::test
