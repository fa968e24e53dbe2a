#include "snell/core/error.h"
#include "snell/scene/scene.h"
#include "snell/scene/shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace snell {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float inf = std::numeric_limits<float>::infinity();

// One quad named 'floor' with a grey material.
Scene floor_scene()
{
    Scene scene;
    const auto grey = add(scene, MaterialDesc{});
    place(scene, make_quad("floor", {0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}, grey));
    return scene;
}

std::string notes_of(const Scene& scene)
{
    std::string all;
    for (const Note& note : scene.notes) all += note.text + "\n";
    return all;
}

std::string error_of(Scene scene)
{
    try {
        validate(scene);
    } catch (const Error& error) {
        return error.what();
    }
    return "no error";
}

#define EXPECT_SAYS(text, part) EXPECT_NE((text).find(part), std::string::npos) << (text)

TEST(Validate, LeavesAGoodSceneAlone)
{
    Scene scene = floor_scene();
    validate(scene);
    EXPECT_EQ(notes_of(scene), "");
    EXPECT_EQ(scene.meshes[0].triangles.size(), 2u);
}

TEST(Validate, NamesAVertexOutOfRange)
{
    Scene scene = floor_scene();
    scene.meshes[0].triangles[1].y = 99;
    EXPECT_SAYS(error_of(scene), "mesh 'floor': triangle 1 refers to vertex 99 of 4");
    scene.meshes[0].name.clear();
    EXPECT_SAYS(error_of(scene), "mesh 0: triangle 1");
}

TEST(Validate, FindsTheFirstBadTriangleOfMany)
{
    Scene scene = floor_scene();
    scene.meshes[0].triangles.assign(1'000'000, uvec3(0, 1, 2));
    for (std::size_t i = 765'432; i < 1'000'000; i += 1000) scene.meshes[0].triangles[i].z = 7;
    EXPECT_SAYS(error_of(scene), "triangle 765432 refers to vertex 7 of 4");
}

TEST(Validate, RefusesAttributesOfTheWrongLength)
{
    for (int which = 0; which < 4; ++which) {
        Scene scene = floor_scene();
        Mesh& mesh = scene.meshes[0];
        if (which == 0) mesh.normals.resize(3, vec3(0, 1, 0));
        if (which == 1) mesh.uvs.resize(5);
        if (which == 2) mesh.colors.resize(1, vec4(1.0f));
        if (which == 3) mesh.triangle_materials.resize(3, mesh.material);
        EXPECT_SAYS(error_of(scene), "mesh 'floor' has ") << which;
    }
}

TEST(Validate, RefusesReferencesOutOfRange)
{
    Scene scene = floor_scene();
    scene.meshes[0].material.value = 5;
    EXPECT_SAYS(error_of(scene), "mesh 'floor' refers to material 5 of 1");
    scene = floor_scene();
    scene.meshes[0].triangle_materials = {{0}, {3}};
    EXPECT_SAYS(error_of(scene), "mesh 'floor': triangle 1 refers to material 3 of 1");
    scene = floor_scene();
    scene.groups[0].meshes.push_back({8});
    EXPECT_SAYS(error_of(scene), "group 'floor' refers to mesh 8 of 1");
    scene = floor_scene();
    scene.groups[0].spheres.push_back({0});
    EXPECT_SAYS(error_of(scene), "group 'floor' refers to sphere 0 of 0");
    scene = floor_scene();
    scene.instances[0].group.value = 2;
    EXPECT_SAYS(error_of(scene), "instance 'floor' refers to group 2 of 1");
    scene = floor_scene();
    scene.materials[0].base_texture.image.value = 1;
    EXPECT_SAYS(error_of(scene), "material 0 refers to image 1 of 0");
    scene = floor_scene();
    scene.materials[0].kind = 17;
    EXPECT_SAYS(error_of(scene), "unknown kind 17");
}

TEST(Validate, RefusesBadTransforms)
{
    Scene scene = floor_scene();
    scene.instances[0].transform = scaling({1, 0, 1});
    EXPECT_SAYS(error_of(scene), "instance 'floor': the transform is singular");
    scene.instances[0].transform = translation({0, nan, 0});
    EXPECT_SAYS(error_of(scene), "instance 'floor': the transform has a number that is NaN");
}

TEST(Validate, DropsTrianglesWithoutSurface)
{
    Scene scene = floor_scene();
    Mesh& mesh = scene.meshes[0];
    mesh.positions.insert(mesh.positions.end(), {{nan, 0, 0}, {0, inf, 0}, {0, 0, 0.5f}});
    mesh.uvs.resize(7);
    mesh.triangles = {{0, 1, 4}, {0, 1, 2}, {0, 0, 1}, {5, 1, 2}, {0, 6, 1}, {0, 2, 3}};
    mesh.triangle_materials.assign(6, Index<MaterialDesc>{0});
    mesh.triangle_materials[5] = add(scene, MaterialDesc{});
    validate(scene);
    ASSERT_EQ(scene.meshes[0].triangles.size(), 2u);
    EXPECT_EQ(scene.meshes[0].triangles[0], uvec3(0, 1, 2));
    EXPECT_EQ(scene.meshes[0].triangles[1], uvec3(0, 2, 3));
    EXPECT_EQ(scene.meshes[0].triangle_materials[1].value, 1u);
    EXPECT_SAYS(notes_of(scene), "mesh 'floor': dropped 2 triangles with a vertex that is NaN");
    EXPECT_SAYS(notes_of(scene), "mesh 'floor': dropped 2 triangles without area");
}

TEST(Validate, KeepsTinyAndThinTriangles)
{
    Scene scene = floor_scene();
    Mesh& mesh = scene.meshes[0];
    mesh.uvs.clear();
    mesh.positions = {{0, 0, 0}, {1e-18f, 0, 0}, {0, 1e-18f, 0}, {100, 100, 100}, {200, 200, 200.0001f}};
    mesh.triangles = {{0, 1, 2}, {0, 3, 4}};
    validate(scene);
    EXPECT_EQ(scene.meshes[0].triangles.size(), 2u) << notes_of(scene);
}

TEST(Validate, ReplacesBadNormals)
{
    Scene scene = floor_scene();
    scene.meshes[0].normals = {{0, 0, 0}, {nan, 0, 0}, {1, 0, 0}, {0, -inf, 0}};
    validate(scene);
    const std::vector<vec3>& normals = scene.meshes[0].normals;
    for (const int i : {0, 1, 3}) EXPECT_EQ(normals[static_cast<std::size_t>(i)], vec3(0, 1, 0)) << i;
    EXPECT_EQ(normals[2], vec3(1, 0, 0));
    EXPECT_SAYS(notes_of(scene), "replaced 3 zero or non-finite normals");
}

TEST(Validate, MendsCoordinatesAndColours)
{
    Scene scene = floor_scene();
    scene.meshes[0].uvs[2] = {nan, 0.5f};
    scene.meshes[0].colors = {{1, 1, 1, 1}, {2, 1, 0, 0.5f}, {-1, 0.5f, 0, 2}, {nan, 0, 0, nan}};
    validate(scene);
    EXPECT_EQ(scene.meshes[0].uvs[2], vec2(0.0f));
    EXPECT_EQ(scene.meshes[0].colors[1], vec4(1.0f, 0.5f, 0.0f, 0.5f));
    EXPECT_EQ(scene.meshes[0].colors[2], vec4(0.0f, 0.5f, 0.0f, 1.0f));
    EXPECT_EQ(scene.meshes[0].colors[3], vec4(1.0f));
    EXPECT_SAYS(notes_of(scene), "replaced 1 non-finite texture coordinate");
    EXPECT_SAYS(notes_of(scene), "mended 3 vertex colours");
}

TEST(Validate, MendsMaterials)
{
    Scene scene = floor_scene();
    MaterialDesc& m = scene.materials[0];
    m.name = "paint";
    m.kind = material_mix;
    m.base_color = {2.0f, 1.0f, 0.5f};
    m.specular = {0.25f, 0.25f, 0.25f};
    m.emission = {nan, 1.0f, -1.0f};
    m.alpha = 7.0f;
    m.ior = 0.0f;
    validate(scene);
    const MaterialDesc& mended = scene.materials[0];
    EXPECT_LE(max3(mended.base_color + mended.specular), 1.00001f);
    EXPECT_NEAR(mended.base_color.x / mended.base_color.z, 4.0f, 1e-5f);
    EXPECT_EQ(mended.emission, vec3(0, 1, 0));
    EXPECT_EQ(mended.alpha, 1.0f);
    EXPECT_EQ(mended.ior, 1.5f);
    EXPECT_SAYS(notes_of(scene), "material 'paint'");
    const std::size_t said = scene.notes.size();
    validate(scene); // once is enough
    EXPECT_EQ(scene.notes.size(), said) << notes_of(scene);
}

TEST(Validate, GivesAGreyToWhatHasNoMaterial)
{
    Scene scene;
    Mesh quad = make_quad("floor", {0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}, {});
    place(scene, quad);
    quad.triangle_materials.resize(2);
    place(scene, quad);
    place(scene, SphereDesc{});
    add(scene, PlaneDesc{});
    validate(scene);
    ASSERT_EQ(scene.materials.size(), 1u);
    EXPECT_EQ(scene.meshes[0].material.value, 0u);
    EXPECT_EQ(scene.meshes[1].triangle_materials[1].value, 0u);
    EXPECT_EQ(scene.spheres[0].material.value, 0u);
    EXPECT_EQ(scene.planes[0].material.value, 0u);
    EXPECT_SAYS(notes_of(scene), "mesh 'floor' and 3 more have no material");
}

TEST(Validate, DropsSpheresWithoutExtent)
{
    Scene scene;
    const auto grey = add(scene, MaterialDesc{});
    Group group;
    for (const float radius : {1.0f, 0.0f, nan, -1.0f, inf, 2.0f})
        group.spheres.push_back(add(scene, SphereDesc{"", vec3(0.0f), radius, grey}));
    add(scene, group);
    validate(scene);
    ASSERT_EQ(scene.groups[0].spheres.size(), 2u);
    EXPECT_EQ(scene.groups[0].spheres[1].value, 5u);
    EXPECT_EQ(scene.spheres.size(), 6u);
    EXPECT_SAYS(notes_of(scene), "dropped 4 spheres");
}

TEST(Validate, RefusesPlanesWithoutDirection)
{
    Scene scene;
    add(scene, PlaneDesc{"ground", vec3(0.0f), vec3(0.0f), add(scene, MaterialDesc{})});
    EXPECT_SAYS(error_of(scene), "plane 'ground' has the normal (0, 0, 0)");
}

TEST(Validate, MendsLights)
{
    Scene scene;
    LightDesc light;
    light.name = "lamp";
    light.kind = light_spot;
    light.direction = vec3(0.0f);
    light.emission = {inf, 1, 1};
    light.inner_degrees = 60.0f;
    light.outer_degrees = 20.0f;
    add(scene, light);
    light = {};
    light.position = {nan, 0, 0};
    add(scene, light);
    scene.environment.radiance = {1, nan, 1};
    validate(scene);
    EXPECT_EQ(scene.lights[0].direction, vec3(0, -1, 0));
    EXPECT_EQ(scene.lights[0].emission, vec3(0, 1, 1));
    EXPECT_LE(scene.lights[0].inner_degrees, scene.lights[0].outer_degrees);
    EXPECT_EQ(scene.lights[1].emission, vec3(0.0f));
    EXPECT_EQ(scene.environment.radiance, vec3(1, 0, 1));
    EXPECT_SAYS(notes_of(scene), "light 'lamp'");
    EXPECT_SAYS(notes_of(scene), "environment");

    scene.lights[0].kind = light_sphere;
    EXPECT_SAYS(error_of(scene), "kind 4 is not a point, directional or spot light");
}

TEST(Validate, ChecksCameras)
{
    Scene scene;
    add(scene, CameraDesc{});
    scene.cameras[0].up = {0, 0, 3}; // along the view
    validate(scene);
    EXPECT_SAYS(notes_of(scene), "up direction");
    EXPECT_EQ(scene.cameras[0].up, vec3(0, 1, 0));

    scene.cameras[0].fov_degrees = 180.0f;
    EXPECT_SAYS(error_of(scene), "field of view of 180");
    scene.cameras[0] = {};
    scene.cameras[0].target = scene.cameras[0].eye;
    EXPECT_SAYS(error_of(scene), "eye and target are the same");
    scene.cameras[0].target.x = nan;
    EXPECT_SAYS(error_of(scene), "NaN");
}

TEST(Validate, ChecksImages)
{
    Scene scene;
    Image image;
    image.name = "wood.png";
    image.width = image.height = 2;
    image.bytes.resize(15);
    scene.images = {image};
    EXPECT_SAYS(error_of(scene), "image 'wood.png': 2 x 2 texels need 16 values, but there are 15");
    scene.images[0].width = 0;
    EXPECT_SAYS(error_of(scene), "no texels");
    scene.images[0] = image;
    scene.images[0].format = 9;
    EXPECT_SAYS(error_of(scene), "format 9");

    image.format = texels_rgba32f;
    image.bytes.clear();
    image.floats.assign(16, 0.5f);
    image.floats[3] = nan;
    image.floats[4] = 3.0f;
    scene.images = {image};
    MaterialDesc material;
    material.base_texture.image = {0};
    scene.materials = {material};
    validate(scene);
    EXPECT_EQ(scene.images[0].floats[3], 0.0f);
    EXPECT_EQ(scene.images[0].floats[4], 1.0f);
    EXPECT_SAYS(notes_of(scene), "2 values outside [0, 1]");
}

} // namespace
} // namespace snell
