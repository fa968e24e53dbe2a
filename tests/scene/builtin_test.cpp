#include "snell/core/error.h"
#include "snell/scene/builtin.h"
#include "snell/scene/packed.h"
#include "snell/scene/shapes.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <map>

namespace snell {
namespace {

TEST(Builtin, AllAreValidAndComplete)
{
    EXPECT_EQ(builtin_scenes().size(), 9u);
    for (const BuiltinScene& builtin : builtin_scenes()) {
        SCOPED_TRACE(builtin.name);
        EXPECT_FALSE(builtin.summary.empty());
        EXPECT_EQ(find_builtin_scene(builtin.name), &builtin);
        Scene scene = builtin.make();
        EXPECT_EQ(scene.name, builtin.name);
        validate(scene);
        complete(scene, 1.0f);
        for (const Note& note : scene.notes) ADD_FAILURE() << note.text;
        EXPECT_EQ(scene.cameras.size(), 1u);
        const PackedScene packed = pack(scene);
        EXPECT_GT(packed.triangles.size() + packed.spheres.size(), 0u);
        EXPECT_GT(packed.lights.size(), 0u);
    }
    EXPECT_EQ(find_builtin_scene("no such scene"), nullptr);
}

TEST(Builtin, ByNameAndNumber)
{
    for (const BuiltinScene& builtin : builtin_scenes()) {
        SCOPED_TRACE(builtin.name);
        const std::string prefix = std::string(builtin.name) + ":";
        EXPECT_EQ(make_builtin_scene(builtin.name)->name, builtin.name);
        EXPECT_EQ(builtin.make_with != nullptr, !builtin.parameter.empty());
        if (builtin.make_with == nullptr) {
            EXPECT_THROW(make_builtin_scene(prefix + "1"), Error);
            continue;
        }
        Scene least = make_builtin_scene(prefix + std::to_string(builtin.least)).value();
        validate(least);
        EXPECT_THROW(make_builtin_scene(prefix + std::to_string(builtin.least - 1)), Error);
        EXPECT_THROW(make_builtin_scene(prefix + std::to_string(builtin.most + 1)), Error);
        EXPECT_THROW(make_builtin_scene(prefix), Error);
        EXPECT_THROW(make_builtin_scene(prefix + "1x"), Error);
        EXPECT_THROW(make_builtin_scene(prefix + " 1"), Error);
    }
    EXPECT_EQ(make_builtin_scene("many-lights:3")->lights.size(), 1u); // and two balls
    EXPECT_FALSE(make_builtin_scene("no such scene").has_value());
    EXPECT_FALSE(make_builtin_scene("no such scene:3").has_value());
}

TEST(Builtin, SphereflakeCounts)
{
    std::size_t wanted = 0, generation = 1;
    for (int depth = 0; depth <= 6; ++depth) {
        wanted += generation;
        generation *= 9;
        Scene scene = make_sphereflake(depth);
        std::size_t count = 0;
        for (const InstanceDesc& instance : scene.instances) count += scene.groups[instance.group.value].spheres.size();
        EXPECT_EQ(count, wanted) << depth;
        EXPECT_LE(scene.spheres.size(), 820u + 91u); // instanced beyond depth 3
    }
    EXPECT_THROW(make_sphereflake(-1), Error);
    EXPECT_THROW(make_sphereflake(100), Error);
}

TEST(Builtin, SpheresOfAFlakeTouchButDoNotOverlap)
{
    const Scene scene = make_sphereflake(2);
    ASSERT_EQ(scene.spheres.size(), 91u);
    for (std::size_t i = 0; i < scene.spheres.size(); ++i) {
        float nearest = infinity();
        for (std::size_t j = 0; j < scene.spheres.size(); ++j) {
            if (i == j) continue;
            const SphereDesc &a = scene.spheres[i], &b = scene.spheres[j];
            nearest = std::min(nearest, length(a.center - b.center) - a.radius - b.radius);
        }
        EXPECT_NEAR(nearest, 0.0f, 1e-5f) << i;
    }
}

TEST(Builtin, ADeepSphereflakePacksFastAndSmall)
{
    const auto start = std::chrono::steady_clock::now();
    Scene scene = make_sphereflake(6);
    validate(scene);
    const PackedScene packed = pack(scene);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    EXPECT_EQ(packed.instances.size(), 729u);
    EXPECT_LT(packed.bytes(), 1u << 20); // 597,871 spheres
    EXPECT_LT(seconds.count(), 3.0);
}

TEST(Builtin, MengerCounts)
{
    std::size_t cubes = 1;
    for (int depth = 0; depth <= 4; ++depth, cubes *= 20) {
        const Scene scene = make_menger(depth);
        double volume = 0.0; // by the divergence theorem, over all placed triangles
        for (const InstanceDesc& instance : scene.instances) {
            for (const Index<Mesh> index : scene.groups[instance.group.value].meshes) {
                const Mesh& mesh = scene.meshes[index.value];
                double inside = 0.0;
                for (const uvec3 t : mesh.triangles) {
                    const glm::dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
                    inside += glm::dot(a, glm::cross(b, c)) / 6.0;
                }
                volume += inside * static_cast<double>(determinant(instance.transform));
            }
        }
        EXPECT_NEAR(volume, 8.0 * std::pow(20.0 / 27.0, depth), 1e-3) << depth;
    }
    EXPECT_THROW(make_menger(-1), Error);
    EXPECT_THROW(make_menger(30), Error);
}

TEST(Builtin, ManyLightsHasThatMany)
{
    for (const int count : {1, 2, 37, 1000}) {
        Scene scene = make_many_lights(count);
        validate(scene);
        EXPECT_EQ(pack(scene).lights.size(), static_cast<std::size_t>(count));
    }
    EXPECT_THROW(make_many_lights(0), Error);
}

TEST(Builtin, AFieldHasTheTrianglesAskedForAndLooksTheSameTwice)
{
    for (const int count : {1000, 20000, 123456}) {
        Scene scene = make_field(count);
        validate(scene);
        std::size_t triangles = 0;
        for (const Mesh& mesh : scene.meshes) triangles += mesh.triangles.size();
        EXPECT_GE(triangles, static_cast<std::size_t>(count));
        EXPECT_LE(triangles, static_cast<std::size_t>(1.3 * count));
        const Scene again = make_field(count);
        ASSERT_EQ(again.meshes.size(), scene.meshes.size());
        for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
            EXPECT_EQ(again.meshes[i].positions, scene.meshes[i].positions);
            EXPECT_EQ(again.meshes[i].triangles, scene.meshes[i].triangles);
        }
    }
    EXPECT_THROW(make_field(999), Error);
    EXPECT_THROW(make_field(-1), Error);
}

// Each edge of a closed mesh is used once in each direction, by position.
bool is_closed(const Mesh& mesh)
{
    const auto less = [](vec3 a, vec3 b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); };
    std::map<vec3, int, decltype(less)> numbers(less);
    for (const vec3 p : mesh.positions) numbers.emplace(p, static_cast<int>(numbers.size()));
    std::map<std::pair<int, int>, int> edges;
    for (const uvec3 t : mesh.triangles)
        for (int k = 0; k < 3; ++k) ++edges[{numbers[mesh.positions[t[k]]], numbers[mesh.positions[t[(k + 1) % 3]]]}];
    for (const auto& [edge, count] : edges) {
        const auto opposite = edges.find({edge.second, edge.first});
        if (opposite == edges.end() || opposite->second != count) return false;
    }
    return true;
}

TEST(Shapes, AreClosedAndFaceOutwards)
{
    const Mesh box = make_box("box", {-1, -2, -3}, {1, 2, 3}, {0});
    EXPECT_TRUE(is_closed(box));
    for (const uvec3 t : box.triangles) {
        const vec3 a = box.positions[t.x], b = box.positions[t.y], c = box.positions[t.z];
        EXPECT_GT(dot(cross(b - a, c - a), a + b + c), 0.0f);
    }
    const Mesh torus = make_torus("torus", 2.0f, 0.5f, 16, 9, {0});
    EXPECT_TRUE(is_closed(torus));
    for (const uvec3 t : torus.triangles) {
        const vec3 a = torus.positions[t.x], b = torus.positions[t.y], c = torus.positions[t.z];
        EXPECT_GT(dot(cross(b - a, c - a), torus.normals[t.x] + torus.normals[t.y] + torus.normals[t.z]), 0.0f);
    }
    EXPECT_TRUE(is_closed(make_field(1000).meshes[1])); // the boulders
    EXPECT_TRUE(is_closed(make_menger(1).meshes[0]));
    EXPECT_TRUE(is_closed(make_menger(2).meshes[0]));
}

TEST(Shapes, Checkerboard)
{
    const Mesh board = make_checkerboard("board", 4, 2, 0.5f, {7}, {8});
    ASSERT_EQ(board.triangles.size(), 16u);
    for (std::size_t i = 0; i < board.triangles.size(); ++i) {
        const uvec3 t = board.triangles[i];
        const vec3 a = board.positions[t.x], b = board.positions[t.y], c = board.positions[t.z];
        EXPECT_EQ(cross(b - a, c - a), vec3(0.0f, 0.25f, 0.0f));
        const vec3 middle = (a + b + c) / 3.0f - vec3(-1.0f, 0.0f, -0.5f);
        const int column = static_cast<int>(middle.x / 0.5f), row = static_cast<int>(middle.z / 0.5f);
        EXPECT_EQ(board.triangle_materials[i].value, (column + row) % 2 == 0 ? 7u : 8u);
    }
}

} // namespace
} // namespace snell
