// No ray leaves a closed mesh, wherever it is aimed.
#include "tests/bvh/scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <map>

namespace snell::test {
namespace {

// A closed surface around the origin with shared vertices: an icosahedron, subdivided, its vertices moved at random
// along their radius, so that every ray from near the centre must hit it.
struct ClosedMesh
{
    std::vector<vec3> vertices;
    std::vector<uvec3> triangles;
};

ClosedMesh make_icosphere(int subdivisions, float bumps, Random& random)
{
    const float g = 0.5f + 0.5f * std::sqrt(5.0f);
    ClosedMesh mesh;
    mesh.vertices = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                     {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
    mesh.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                      {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                      {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
    for (int level = 0; level < subdivisions; ++level) {
        std::map<std::pair<uint, uint>, uint> middles;
        const auto middle = [&](uint a, uint b) {
            const auto [at, is_new] = middles.try_emplace(std::minmax(a, b), static_cast<uint>(mesh.vertices.size()));
            if (is_new) mesh.vertices.push_back(0.5f * (mesh.vertices[a] + mesh.vertices[b]));
            return at->second;
        };
        std::vector<uvec3> finer;
        for (const uvec3& t : mesh.triangles) {
            const uint ab = middle(t.x, t.y), bc = middle(t.y, t.z), ca = middle(t.z, t.x);
            finer.insert(finer.end(), {{t.x, ab, ca}, {t.y, bc, ab}, {t.z, ca, bc}, {ab, bc, ca}});
        }
        mesh.triangles = finer;
    }
    for (vec3& v : mesh.vertices) v = normalize(v) * (1.0f + bumps * random.uniform());
    return mesh;
}

PackedScene to_scene(const ClosedMesh& mesh, vec3 offset)
{
    PackedScene scene;
    for (const vec3& v : mesh.vertices) scene.positions.push_back(v + offset);
    for (const uvec3& t : mesh.triangles) scene.triangles.push_back({t.x, t.y, t.z, 0});
    end_world(scene);
    return scene;
}

// Rays from inside, in turn random, at a vertex, at the middle of an edge, at a random point of an edge, along an
// edge's line of sight scaled to awkward lengths.
Ray aim(const PackedScene& scene, vec3 center, Random& random, int kind)
{
    const vec3 from = kind < 5 ? center + random.in_box(0.3f) : center;
    const Triangle& tri = scene.triangles[random.bits() % scene.triangles.size()];
    const vec3 a = scene.positions[tri.v0], b = scene.positions[tri.v1];
    if (kind % 5 == 0) return make_ray(from, random.direction(), infinity());
    vec3 to = a;
    if (kind % 5 == 2) to = 0.5f * (a + b);
    if (kind % 5 == 3) to = a + random.uniform() * (b - a);
    Ray ray = ray_between(from, to);
    if (kind % 5 == 4) ray.direction *= std::exp2(random.range(-20.0f, 20.0f));
    return ray;
}

void expect_no_leak(const PackedScene& scene, vec3 center, std::size_t count, uint seed)
{
    const auto accel = accels().front().make(scene, {});
    Random random(seed);
    constexpr std::size_t batch = 4096;
    std::vector<Ray> rays(batch);
    std::vector<Hit> hits(batch);
    std::vector<std::uint8_t> blocked(batch);
    std::size_t leaks = 0, shadow_leaks = 0;
    for (std::size_t done = 0; done < count; done += batch) {
        for (std::size_t i = 0; i < batch; ++i) rays[i] = aim(scene, center, random, static_cast<int>(i % 10));
        accel->intersect(rays, hits);
        accel->occluded(rays, blocked);
        for (std::size_t i = 0; i < batch; ++i) {
            leaks += !is_hit(hits[i]);
            shadow_leaks += blocked[i] == 0;
        }
    }
    EXPECT_EQ(leaks, 0u);
    EXPECT_EQ(shadow_leaks, 0u);
}

bool long_run()
{
    return std::getenv("SNELL_LONG") != nullptr;
}

TEST(Watertight, BumpySpheres)
{
    const std::size_t count = long_run() ? 10'000'000 : 600'000;
    std::size_t share = count / 3;
    for (const int subdivisions : {0, 3, 6}) {
        SCOPED_TRACE(subdivisions);
        Random random(static_cast<uint>(subdivisions));
        const PackedScene scene = to_scene(make_icosphere(subdivisions, 0.3f, random), vec3(0.0f));
        expect_no_leak(scene, vec3(0.0f), share, 1);
    }
}

// Away from the origin the vertices lie on a coarse lattice of floats, and many triangles are slivers or have no area.
TEST(Watertight, FarFromTheOrigin)
{
    const std::size_t count = long_run() ? 2'000'000 : 200'000;
    for (const float offset : {1000.0f, 30000.0f, 300000.0f}) {
        SCOPED_TRACE(offset);
        Random random(4);
        const vec3 center(offset, -offset, 0.5f * offset);
        expect_no_leak(to_scene(make_icosphere(5, 0.3f, random), center), center, count / 3, 2);
    }
}

// A sphere squeezed to a millionth in one axis: triangles seen edge-on everywhere.
TEST(Watertight, SqueezedSphere)
{
    Random random(5);
    ClosedMesh mesh = make_icosphere(5, 0.0f, random);
    for (vec3& v : mesh.vertices) v.z *= 1e-6f;
    const PackedScene scene = to_scene(mesh, vec3(0.0f));
    const auto accel = accels().front().make(scene, {});
    std::vector<Ray> rays;
    for (int i = 0; i < 100'000; ++i) {
        vec3 d = random.direction();
        if (i % 2) d.z *= 1e-6f;
        rays.push_back(make_ray(vec3(0.0f), d, infinity()));
    }
    std::vector<Hit> hits(rays.size());
    accel->intersect(rays, hits);
    for (std::size_t i = 0; i < rays.size(); ++i) ASSERT_TRUE(is_hit(hits[i])) << i;
}

} // namespace
} // namespace snell::test
