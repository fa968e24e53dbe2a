// Rays on the GPU meet what brute force on the CPU finds.
#include "snell/vulkan/trace_rays.h"
#include "tests/bvh/scenes.h"
#include "tests/vulkan/gpu_test.h"

#include <cstring>

namespace snell::test {
namespace {

std::string describe(const Ray& r, const Hit& h)
{
    return fmt::format("ray ({}, {}, {}) -> ({}, {}, {}) in ({}, {}): t {} u {} v {} primitive {:x} instance {:x}",
                       r.origin.x, r.origin.y, r.origin.z, r.direction.x, r.direction.y, r.direction.z, r.t_min,
                       r.t_max, h.t, h.u, h.v, h.primitive, h.instance);
}

// To the bit where the device rounds as the CPU does; else within a few roundings, and at the seam of two primitives it
// may be either.
bool agree(const Hit& a, const Hit& b)
{
    if (std::memcmp(&a, &b, sizeof(Hit)) == 0) return true;
    if (rounds_exactly()) return false;
    return is_hit(a) == is_hit(b) && (!is_hit(a) || std::abs(a.t - b.t) <= 1e-5f * std::abs(a.t));
}

void expect_agreement(const PackedScene& scene, const std::vector<Ray>& rays, std::size_t least_hits,
                      TriangleTest test = TriangleTest::watertight)
{
    AccelOptions options;
    options.triangle_test = test;
    std::vector<Hit> expected(rays.size());
    find_accel("brute")->make(scene, options)->intersect(rays, expected);
    std::size_t hits_found = 0;
    for (const Hit& hit : expected) hits_found += is_hit(hit);
    EXPECT_GE(hits_found, least_hits) << "the test looks past the scene";

    for (const auto& [name, built_by_host] :
         {std::pair{"bvh8q", true}, {"bvh8q", false}, {"bvh2", true}, {"bvh2", false}}) {
        SCOPED_TRACE(fmt::format("{}, built by the {}", name, built_by_host ? "host" : "device"));
        const AccelInfo& layout = *find_accel(name);
        const std::unique_ptr<Accel> accel = built_by_host ? layout.make(scene, options) : nullptr;
        const std::unique_ptr<DeviceScene> on_device =
            make_device_scene(test_device(), scene, layout, options, accel.get());
        RayBatch batch(dynamic_cast<VulkanScene&>(*on_device), rays);
        batch.intersect();
        batch.occlude();
        const std::vector<Hit> hits = batch.hits();
        const std::vector<std::uint8_t> blocked = batch.blocked();
        int wrong = 0;
        for (std::size_t i = 0; i < rays.size() && wrong < 3; ++i) {
            if (agree(hits[i], expected[i]) && (blocked[i] != 0) == is_hit(expected[i])) continue;
            ++wrong;
            ADD_FAILURE() << "expected " << describe(rays[i], expected[i]) << "\n     got "
                          << describe(rays[i], hits[i]) << "\n blocked " << int(blocked[i]);
        }
    }
}

void expect_agreement(const PackedScene& scene, std::size_t least_hits, uint seed = 1)
{
    Random random(seed);
    std::vector<Ray> rays = random_rays(random, 3000);
    for (const std::vector<Ray>& more :
         {hostile_rays(scene, random), camera_rays(vec3(0.3f, 0.7f, 3.0f), vec3(0.0f), 1.2f, 10)})
        rays.insert(rays.end(), more.begin(), more.end());
    expect_agreement(scene, rays, least_hits);
}

void move_vertices(PackedScene& scene, vec3 by)
{
    for (vec3& p : scene.positions) p += by;
}

TEST(GpuTraversal, TriangleSoup)
{
    SNELL_NEEDS_GPU();
    Random random(2);
    PackedScene scene;
    add_soup(scene, random, 2000, 0.2f);
    end_world(scene);
    expect_agreement(scene, 1000);
    std::vector<Ray> rays = random_rays(random, 2000);
    expect_agreement(scene, rays, 500, TriangleTest::moller_trumbore);
}

TEST(GpuTraversal, OneTriangleAndNothing)
{
    SNELL_NEEDS_GPU();
    Random random(3);
    PackedScene scene;
    expect_agreement(scene, random_rays(random, 100), 0);
    add_soup(scene, random, 1, 1.0f);
    end_world(scene);
    expect_agreement(scene, 1);
}

TEST(GpuTraversal, GridsWithExactEdges)
{
    SNELL_NEEDS_GPU();
    PackedScene scene;
    for (const float height : {0.0f, 0.25f, 0.25f, -0.5f}) add_grid(scene, 12, height);
    end_world(scene);
    expect_agreement(scene, 500);
}

TEST(GpuTraversal, EverythingTogether)
{
    SNELL_NEEDS_GPU();
    Random random(4);
    PackedScene scene;
    add_soup(scene, random, 300, 0.1f);
    add_cloud(scene, random, 100, 0.1f);
    end_group(scene);
    add_grid(scene, 6, 0.0f);
    end_group(scene);
    add_soup(scene, random, 200, 0.2f);
    add_cloud(scene, random, 50, 0.2f);
    end_world(scene);
    add_plane(scene, vec3(0.0f, 1.0f, 0.1f), -1.5f);
    add_plane(scene, vec3(0.0f, 1.0f, 0.1f), -1.5f); // twice the same
    for (uint i = 0; i < 20; ++i) {
        const Transform turn = rotation(random.direction(), random.range(0.0f, 360.0f));
        add_instance(scene, i % 2, compose(translation(random.in_box(1.5f)), turn));
    }
    expect_agreement(scene, 1500);
}

TEST(GpuTraversal, SliversAndDegenerateTriangles)
{
    SNELL_NEEDS_GPU();
    Random random(5);
    PackedScene scene;
    for (int i = 0; i < 200; ++i) {
        const vec3 a = random.in_box(1.0f), b = random.in_box(1.0f);
        add_triangle(scene, a, b, a + (b - a) * random.uniform());
        add_triangle(scene, a, b, b + random.in_box(1e-5f));
        add_triangle(scene, a, a, a);
    }
    add_soup(scene, random, 200, 0.3f);
    const float nan = std::nanf("");
    add_triangle(scene, vec3(nan), vec3(0.0f), vec3(1.0f));
    add_triangle(scene, vec3(infinity(), 0.0f, 0.0f), vec3(0.0f), vec3(1.0f, 0.0f, 1.0f));
    end_world(scene);
    expect_agreement(scene, 200);
}

TEST(GpuTraversal, FarFromTheOrigin)
{
    SNELL_NEEDS_GPU();
    for (const float far : {1e3f, 1e6f}) {
        SCOPED_TRACE(far);
        Random random(6);
        PackedScene scene;
        add_soup(scene, random, 500, 0.3f);
        move_vertices(scene, vec3(far, -far, 0.5f * far));
        end_world(scene);
        expect_agreement(scene, random_rays(random, 2000, 1.0f, vec3(far, -far, 0.5f * far)), 200);
    }
}

TEST(GpuTraversal, HugeAndTinyScenes)
{
    SNELL_NEEDS_GPU();
    for (const float scale : {1e-12f, 1e12f}) {
        SCOPED_TRACE(scale);
        Random random(7);
        PackedScene scene;
        add_soup(scene, random, 500, 0.3f);
        for (vec3& p : scene.positions) p *= scale;
        end_world(scene);
        std::vector<Ray> rays = random_rays(random, 2000);
        for (Ray& ray : rays) ray.origin *= scale, ray.direction *= scale;
        expect_agreement(scene, rays, 200);
    }
}

// Deep trees of small boxes in large ones.
TEST(GpuTraversal, ExponentialSpacing)
{
    SNELL_NEEDS_GPU();
    PackedScene scene;
    for (int i = 0; i < 60; ++i) {
        const float x = std::exp2(static_cast<float>(-i));
        add_triangle(scene, vec3(x, -x, -x), vec3(x, x, -x), vec3(x, 0.0f, x));
    }
    end_world(scene);
    expect_agreement(scene, 50);
}

// The test can fail: a device that does not follow what has changed finds old hits.
TEST(GpuTraversal, FollowsWhatHasMoved)
{
    SNELL_NEEDS_GPU();
    Random random(8);
    PackedScene scene;
    add_soup(scene, random, 500, 0.3f);
    end_world(scene);
    const std::vector<Ray> rays = random_rays(random, 1000);
    const AccelInfo& layout = *find_accel("bvh8q");
    const std::unique_ptr<Accel> accel = layout.make(scene, {});
    const std::unique_ptr<DeviceScene> on_device = make_device_scene(test_device(), scene, layout, {}, accel.get());
    auto& vulkan = dynamic_cast<VulkanScene&>(*on_device);
    const auto trace = [&] {
        RayBatch batch(vulkan, rays);
        batch.intersect();
        return batch.hits();
    };
    const std::vector<Hit> before = trace();
    move_vertices(scene, vec3(0.3f, 0.0f, 0.0f));
    PackedChanges changes;
    changes.world = true;
    EXPECT_EQ(std::memcmp(trace().data(), before.data(), before.size() * sizeof(Hit)), 0);
    on_device->update(changes);
    EXPECT_LT(on_device->uploaded_bytes, on_device->bytes());
    std::vector<Hit> expected(rays.size());
    find_accel("brute")->make(scene, {})->intersect(rays, expected);
    const std::vector<Hit> after = trace();
    int wrong = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) wrong += !agree(after[i], expected[i]);
    EXPECT_EQ(wrong, 0);
    EXPECT_NE(std::memcmp(after.data(), before.data(), before.size() * sizeof(Hit)), 0);
    on_device->update({});
    EXPECT_EQ(on_device->uploaded_bytes, 0u);
}

} // namespace
} // namespace snell::test
