#include "snell/core/error.h"
#include "snell/kernel/ray.h"
#include "snell/kernel/tone.h"
#include "snell/scene/packed.h"
#include "snell/scene/shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <set>

namespace snell {
namespace {

void expect_near(vec3 a, vec3 b, float tolerance)
{
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], tolerance) << "component " << i;
}

vec3 triangle_cross(const PackedScene& packed, std::size_t t)
{
    const Triangle triangle = packed.triangles[t];
    const vec3 a = packed.positions[triangle.v0];
    return cross(packed.positions[triangle.v1] - a, packed.positions[triangle.v2] - a);
}

// Each surface's triangles lie together, in the order of the surfaces.
void expect_consecutive_surfaces(const PackedScene& packed)
{
    for (std::size_t t = 0; t < packed.triangles.size(); ++t) {
        const uint s = packed.triangles[t].surface;
        ASSERT_LT(s, packed.surfaces.size());
        const bool first = t == 0 || packed.triangles[t - 1].surface != s;
        ASSERT_EQ(first, packed.surfaces[s].first_triangle == t) << "triangle " << t;
        if (t > 0 && first) {
            ASSERT_EQ(packed.triangles[t - 1].surface + 1, s);
        }
    }
}

TEST(Pack, BakesWhatIsPlacedOnce)
{
    Scene scene;
    const auto grey = add(scene, MaterialDesc{});
    Mesh mesh = make_torus("torus", 1.0f, 0.3f, 12, 8, grey);
    const Transform m = compose(translation({1, 2, 3}), compose(rotation({1, 2, 0}, 50.0f), scaling({1, 2, 3})));
    place(scene, mesh, m);
    const PackedScene packed = pack(scene);
    EXPECT_TRUE(packed.instances.empty());
    EXPECT_TRUE(packed.groups.empty());
    EXPECT_EQ(packed.world.triangle_count, mesh.triangles.size());
    ASSERT_EQ(packed.positions.size(), mesh.positions.size());
    ASSERT_EQ(packed.normals.size(), mesh.normals.size());
    ASSERT_EQ(packed.surfaces.size(), 1u);
    EXPECT_EQ(packed.surfaces[0].color_base, none);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        expect_near(packed.positions[i], transform_point(m, mesh.positions[i]), 1e-5f);
        EXPECT_NEAR(length(packed.normals[i]), 1.0f, 1e-6f);
        EXPECT_EQ(packed.uvs[i], mesh.uvs[i]);
    }
    // The shading normals still agree with the surface.
    for (std::size_t t = 0; t < packed.triangles.size(); ++t)
        EXPECT_GT(dot(triangle_cross(packed, t), packed.normals[packed.triangles[t].v0]), 0.0f);
    const Bounds bounds = scene_bounds(scene);
    expect_near(packed.center, bounds.center(), 1e-6f);
    for (const vec3 p : packed.positions) EXPECT_LE(length(p - packed.center), packed.radius * 1.00001f);
}

TEST(Pack, SharesWhatIsPlacedOften)
{
    Scene scene;
    const auto grey = add(scene, MaterialDesc{}), other = add(scene, MaterialDesc{});
    const auto mesh = add(scene, make_torus("torus", 1.0f, 0.3f, 12, 8, grey));
    const auto box = add(scene, make_box("box", vec3(0), vec3(1), other));
    const auto sphere = add(scene, SphereDesc{"", {1, 0, 0}, 0.5f, grey});
    const auto often = add(scene, Group{"often", {mesh, box}, {sphere}});
    const auto also = add(scene, Group{"also", {mesh}, {}});
    const auto once = add(scene, Group{"once", {mesh, box}, {sphere}});
    add(scene, Group{"never", {mesh, box, box}, {sphere}});
    for (int i = 0; i < 5; ++i) add(scene, InstanceDesc{"", often, translation({static_cast<float>(i), 0, 0})});
    add(scene, InstanceDesc{"", once, translation({0, 5, 0})});
    for (int i = 0; i < 2; ++i) add(scene, InstanceDesc{"", also, translation({0, 0, static_cast<float>(i)})});
    const PackedScene packed = pack(scene);

    const uint torus_triangles = 12 * 8 * 2;
    EXPECT_EQ(packed.world.triangle_count, torus_triangles + 12);
    EXPECT_EQ(packed.world.sphere_count, 1u);
    ASSERT_EQ(packed.groups.size(), 2u);
    ASSERT_EQ(packed.instances.size(), 7u);
    EXPECT_EQ(packed.groups[0].triangle_count, torus_triangles + 12);
    EXPECT_EQ(packed.groups[1].triangle_count, torus_triangles);
    EXPECT_EQ(packed.triangles.size(), 3 * torus_triangles + 24);
    // Vertices once in world space and once in object space, texture coordinates once.
    const std::size_t torus_vertices = scene.meshes[0].positions.size();
    EXPECT_EQ(packed.positions.size(), 2 * (torus_vertices + 8));
    EXPECT_EQ(packed.normals.size(), 2 * torus_vertices);
    EXPECT_EQ(packed.uvs.size(), torus_vertices);
    expect_consecutive_surfaces(packed);

    for (const Instance& instance : packed.instances) {
        const InstanceDesc& desc = scene.instances[instance.object];
        EXPECT_EQ(instance.group, desc.group == often ? 0u : 1u);
        expect_near(transform_point(instance.to_world, {1, 2, 3}), transform_point(desc.transform, {1, 2, 3}), 0.0f);
        expect_near(transform_point(instance.to_object, transform_point(desc.transform, {1, 2, 3})), {1, 2, 3}, 1e-6f);
    }
    const Triangle in_group = packed.triangles[packed.groups[1].first_triangle];
    EXPECT_EQ(packed.positions[in_group.v1], scene.meshes[0].positions[scene.meshes[0].triangles[0].y]);
}

TEST(Pack, SortsTrianglesByMaterial)
{
    Scene scene;
    for (int i = 0; i < 4; ++i) add(scene, MaterialDesc{});
    Mesh mesh;
    for (uint i = 0; i < 300; ++i) {
        const float x = static_cast<float>(i);
        mesh.positions.insert(mesh.positions.end(), {{x, 0, 0}, {x + 1, 0, 0}, {x, 1, 0}});
        mesh.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
        mesh.triangle_materials.push_back({(i * 7 + i / 10) % 3 + 1});
    }
    place(scene, make_box("box", vec3(0), vec3(1), {0}));
    place(scene, mesh);
    const PackedScene packed = pack(scene);
    ASSERT_EQ(packed.surfaces.size(), 4u);
    expect_consecutive_surfaces(packed);
    std::set<uint> seen;
    for (std::size_t t = 12; t < packed.triangles.size(); ++t) {
        const Triangle triangle = packed.triangles[t];
        const uint source = (triangle.v0 - 8) / 3;
        seen.insert(source);
        EXPECT_EQ(packed.surfaces[triangle.surface].material, mesh.triangle_materials[source].value);
        EXPECT_EQ(packed.surfaces[triangle.surface].object, 1u);
        EXPECT_EQ(packed.surfaces[triangle.surface].first_vertex, 8u);
        if (packed.triangles[t - 1].surface == triangle.surface) {
            EXPECT_LT(packed.triangles[t - 1].v0, triangle.v0); // stable
        }
    }
    EXPECT_EQ(seen.size(), 300u);
}

TEST(Pack, AttributesAreFoundFromTheBase)
{
    Scene scene;
    const auto grey = add(scene, MaterialDesc{});
    place(scene, make_box("plain", vec3(0), vec3(1), grey));
    Mesh mesh = make_torus("torus", 1.0f, 0.3f, 12, 8, grey);
    for (const vec3 n : mesh.normals) mesh.colors.push_back(vec4(0.5f + 0.5f * n, 1.0f));
    place(scene, mesh);
    mesh.name = "second";
    mesh.normals.clear();
    place(scene, mesh);
    const PackedScene packed = pack(scene);
    ASSERT_EQ(packed.surfaces.size(), 3u);
    EXPECT_EQ(packed.surfaces[0].normal_base, none);
    EXPECT_EQ(packed.surfaces[0].uv_base, none);
    EXPECT_EQ(packed.surfaces[2].normal_base, none);
    for (const uint s : {1u, 2u}) {
        const Surface& surface = packed.surfaces[s];
        for (uint i = 0; i < mesh.positions.size(); ++i) {
            const uint v = surface.first_vertex + i;
            EXPECT_EQ(packed.positions[v], mesh.positions[i]);
            EXPECT_EQ(packed.uvs[v - surface.first_vertex + surface.uv_base], mesh.uvs[i]);
            EXPECT_EQ(packed.colors[v - surface.first_vertex + surface.color_base], mesh.colors[i]);
        }
    }
}

TEST(Pack, MirroringKeepsTheSideOfTheNormal)
{
    for (const vec3 factors : {vec3(1, 1, 1), vec3(-1, 1, 1), vec3(-1, -2, 1), vec3(-1, -1, -1)}) {
        Scene scene;
        const auto grey = add(scene, MaterialDesc{});
        place(scene, make_box("box", vec3(-1), vec3(1), grey), scaling(factors));
        const PackedScene packed = pack(scene);
        for (std::size_t t = 0; t < packed.triangles.size(); ++t)
            EXPECT_GT(dot(triangle_cross(packed, t), packed.positions[packed.triangles[t].v0]), 0.0f)
                << "a face of the box points inwards";
    }
}

TEST(Pack, SpheresAreBakedOnlyIfTheyStaySpheres)
{
    Scene scene;
    const auto grey = add(scene, MaterialDesc{});
    MaterialDesc textured;
    textured.base_texture.image = add(scene, make_checker_image("checker", vec3(1), vec3(0)));
    const auto checkered = add(scene, textured);
    const auto plain = add(scene, Group{"", {}, {add(scene, SphereDesc{"", {1, 0, 0}, 0.5f, grey})}});
    const auto mapped = add(scene, Group{"", {}, {add(scene, SphereDesc{"", {1, 0, 0}, 0.5f, checkered})}});

    add(scene, InstanceDesc{"", plain, compose(rotation({0, 1, 0}, 90.0f), scaling(vec3(2.0f)))});
    PackedScene packed = pack(scene);
    ASSERT_EQ(packed.world.sphere_count, 1u);
    expect_near(packed.spheres[0].center, {0, 0, -2}, 1e-6f);
    EXPECT_NEAR(packed.spheres[0].radius, 1.0f, 1e-6f);

    scene.instances[0].transform = scaling({1, 2, 1});
    packed = pack(scene);
    EXPECT_EQ(packed.world.sphere_count, 0u);
    ASSERT_EQ(packed.instances.size(), 1u);
    EXPECT_EQ(packed.groups[0].sphere_count, 1u);
    EXPECT_EQ(packed.spheres[0].radius, 0.5f);

    scene.instances[0] = InstanceDesc{"", mapped, rotation({0, 1, 0}, 90.0f)};
    EXPECT_EQ(pack(scene).instances.size(), 1u);
    scene.instances[0] = InstanceDesc{"", mapped, compose(translation({0, 1, 0}), scaling(vec3(3.0f)))};
    EXPECT_EQ(pack(scene).instances.size(), 0u);
}

TEST(Pack, MaterialsPlanesAndObjects)
{
    Scene scene;
    MaterialDesc m;
    m.kind = material_dielectric;
    m.alpha = 0.0009f;
    m.absorption = vec3(1, 2, 3);
    m.two_sided_emission = true;
    add(scene, m);
    m.alpha = 0.0011f;
    m.two_sided_emission = false;
    add(scene, m);
    add(scene, PlaneDesc{"", {1, 2, 3}, {0, 5, 0}, {1}});
    place(scene, make_box("", vec3(0), vec3(1), {0}));
    place(scene, SphereDesc{"", vec3(0.0f), 1.0f, {0}});
    scene.environment.radiance = {0.1f, 0.2f, 0.3f};
    const PackedScene packed = pack(scene);
    EXPECT_EQ(packed.materials[0].alpha, 0.0f); // as good as smooth
    EXPECT_EQ(packed.materials[1].alpha, 0.0011f);
    EXPECT_EQ(packed.materials[0].flags, material_two_sided_emission);
    EXPECT_EQ(packed.materials[1].flags, 0u);
    EXPECT_EQ(packed.materials[1].absorption, vec3(1, 2, 3));
    EXPECT_EQ(packed.planes[0].normal, vec3(0, 1, 0));
    EXPECT_EQ(packed.planes[0].offset, 2.0f);
    EXPECT_EQ(packed.planes[0].material, 1u);
    EXPECT_EQ(std::set<uint>({packed.surfaces[0].object, packed.spheres[0].object, packed.planes[0].object}).size(),
              3u);
    const SceneView view = packed.view();
    EXPECT_EQ(view.plane_count, 1u);
    EXPECT_EQ(view.light_count, 0u);
    EXPECT_EQ(view.environment.radiance, scene.environment.radiance);
    EXPECT_EQ(view.planes.at, packed.planes.data());
    EXPECT_EQ(view.scene_radius, packed.radius);
    ASSERT_EQ(packed.srgb.size(), 256u);
    EXPECT_EQ(packed.srgb[0], 0.0f);
    EXPECT_EQ(packed.srgb[128], srgb_decode(128.0f / 255.0f));
    EXPECT_NEAR(packed.srgb[255], 1.0f, 1e-6f);
}

TEST(Pack, TexelsLieOneAfterTheOther)
{
    Scene scene;
    Image bytes;
    bytes.width = 2;
    bytes.height = 1;
    bytes.bytes = {1, 2, 3, 4, 5, 6, 7, 8};
    Image floats;
    floats.width = floats.height = 1;
    floats.format = texels_rgba32f;
    floats.floats = {0.25f, 0.5f, 0.75f, 1.0f};
    add(scene, bytes);
    add(scene, floats);
    add(scene, bytes);
    const PackedScene packed = pack(scene);
    ASSERT_EQ(packed.texels.size(), 2u + 4u + 2u);
    EXPECT_EQ(packed.texels[0], 0x04030201u);
    EXPECT_EQ(packed.texels[7], 0x08070605u);
    EXPECT_EQ(uintBitsToFloat(packed.texels[3]), 0.5f);
    EXPECT_EQ(packed.textures[1].offset, 2u);
    EXPECT_EQ(packed.textures[1].format, texels_rgba32f);
    EXPECT_EQ(packed.textures[2].offset, 6u);
    EXPECT_EQ(packed.textures[2].width, 2u);
}

TEST(Pack, AnEmptySceneIsEmpty)
{
    const PackedScene packed = pack(Scene{});
    EXPECT_EQ(packed.radius, 1.0f);
    EXPECT_EQ(packed.world.triangle_count, 0u);
    EXPECT_EQ(packed.view().light_count, 0u);
}

TEST(Pack, IsLean)
{
    Scene scene;
    const auto grey = add(scene, MaterialDesc{});
    place(scene, make_torus("torus", 1.0f, 0.3f, 512, 200, grey)); // with normals and texture coordinates
    const PackedScene packed = pack(scene);
    EXPECT_LT(static_cast<double>(packed.bytes()) / static_cast<double>(packed.triangles.size()), 40.0);
    EXPECT_GE(packed.bytes(), packed.triangles.size() * sizeof(Triangle) + packed.positions.size() * sizeof(vec3));
}

} // namespace
TEST(Pack, WindingFollowsTheNormals)
{
    Scene scene;
    MaterialDesc glow;
    glow.emission = vec3(1.0f);
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
    mesh.normals.assign(4, vec3(0, 0, -1));
    mesh.triangles = {{0, 1, 2}, {1, 2, 3}}; // the first one is wound towards +Z, the second one towards -Z
    mesh.material = add(scene, glow);
    for (const float side : {1.0f, -1.0f}) { // as it is, and mirrored
        Scene one = scene;
        place(one, mesh, scaling({side, 1, 1}));
        validate(one);
        const PackedScene packed = pack(one);
        ASSERT_EQ(packed.lights.size(), 2u);
        for (const Light& light : packed.lights) EXPECT_LT(cross(light.direction, light.edge).z, 0.0f) << side;
    }
}

} // namespace snell
