// Before a device is used: a few rays whose hits are known.
#include "snell/bvh/accel.h"
#include "snell/core/error.h"
#include "snell/vulkan/trace_rays.h"

#include <cmath>

namespace snell {

namespace {
struct KnownRay
{
    Ray ray;
    Hit hit;
};

// A square of two triangles at z = -1, a ball in front of it, a floor, and the same square once more as an instance
// that has been moved to z = -5.
PackedScene test_scene()
{
    PackedScene scene;
    scene.positions = {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}};
    scene.triangles = {{0, 1, 2, 0}, {0, 2, 3, 0}, {0, 1, 2, 0}, {0, 2, 3, 0}};
    scene.spheres = {{vec3(3.0f, 0.0f, -1.0f), 0.5f, 0, 0, none, 0}};
    scene.planes = {{vec3(0.0f, 1.0f, 0.0f), -2.0f, 0, 0, 0, 0}};
    scene.world = {0, 2, 0, 1};
    scene.groups = {{2, 2, 1, 0}};
    Instance placed{};
    placed.to_world = {vec4(1, 0, 0, 0), vec4(0, 1, 0, 0), vec4(0, 0, 1, -4)};
    placed.to_object = {vec4(1, 0, 0, 0), vec4(0, 1, 0, 0), vec4(0, 0, 1, 4)};
    scene.instances = {placed};
    scene.materials.resize(1);
    scene.surfaces.resize(1);
    return scene;
}

std::vector<KnownRay> known_rays()
{
    const float far = std::numeric_limits<float>::infinity();
    const auto ray = [&](vec3 origin, vec3 direction, float t_max) { return make_ray(origin, direction, t_max); };
    const auto hit = [](float t, float u, float v, uint kind, uint index, uint instance) {
        return Hit{t, u, v, pack_primitive(kind, index), instance};
    };
    std::vector<KnownRay> rays;
    const vec3 ahead(0.0f, 0.0f, -1.0f);
    rays.push_back({ray(vec3(0.5f, 0.0f, 1.0f), ahead, far), hit(2.0f, 0.25f, 0.5f, kind_triangle, 0, none)});
    rays.push_back({ray(vec3(-0.5f, 0.0f, 1.0f), ahead, far), hit(2.0f, 0.25f, 0.25f, kind_triangle, 1, none)});
    rays.push_back({ray(vec3(0.0f, 0.0f, 1.0f), ahead, far), hit(2.0f, 0.0f, 0.5f, kind_triangle, 0, none)}); // both
    rays.push_back({ray(vec3(0.5f, 0.0f, -2.0f), ahead, far), hit(3.0f, 0.25f, 0.5f, kind_triangle, 2, 0)});
    rays.push_back({ray(vec3(3.0f, 0.0f, 1.0f), ahead, far), hit(1.5f, 0.0f, 0.0f, kind_sphere, 0, none)});
    rays.push_back({ray(vec3(0.0f, 0.0f, 4.0f), vec3(0, -2, 0), far), hit(1.0f, 0.0f, 0.0f, kind_plane, 0, none)});
    rays.push_back({ray(vec3(0.5f, 0.0f, 1.0f), ahead, 1.5f), miss(1.5f)});
    rays.push_back({ray(vec3(0.0f, 3.0f, 1.0f), ahead, 100.0f), miss(100.0f)});
    rays.push_back({ray(vec3(0.0f), vec3(0.0f), 100.0f), miss(100.0f)});
    return rays;
}

bool agree(float a, float b)
{
    return a == b || std::abs(a - b) < 1e-5f;
}
} // namespace

void test_gpu(std::shared_ptr<Gpu> gpu)
{
    const PackedScene scene = test_scene();
    const std::vector<KnownRay> known = known_rays();
    std::vector<Ray> rays;
    for (const KnownRay& k : known) rays.push_back(k.ray);
    const AccelInfo& layout = *find_accel("bvh8q");
    const std::unique_ptr<Accel> accel = layout.make(scene, {});
    VulkanScene on_device(gpu, scene, layout, {}, accel.get());
    RayBatch batch(on_device, rays);
    batch.intersect();
    const std::vector<Hit> hits = batch.hits();
    batch.occlude();
    const std::vector<std::uint8_t> blocked = batch.blocked();
    for (std::size_t i = 0; i < known.size(); ++i) {
        const Hit &expected = known[i].hit, &found = hits[i];
        if (expected.primitive == found.primitive && expected.instance == found.instance &&
            agree(expected.t, found.t) && agree(expected.u, found.u) && agree(expected.v, found.v) &&
            (blocked[i] != 0) == is_hit(expected))
            continue;
        throw Error(
            fmt::format("{} fails the self-test: ray {} should meet primitive {:#x} at {} and meets {:#x} at {}",
                        gpu->info().info.title, i, expected.primitive, expected.t, found.primitive, found.t),
            "update its driver, or use --device cpu");
    }
}

} // namespace snell
