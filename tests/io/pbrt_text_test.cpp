// Parts of a scene as text: read again, they are the same parts.
#include "snell/io/pbrt/write.h"
#include "snell/scene/shapes.h"
#include "tests/io/pbrt_files.h"

#include <gtest/gtest.h>

#include <filesystem>

namespace snell::test {
namespace {

TEST(PbrtText, OfAMaterial)
{
    Scene scene;
    scene.images.push_back({"wood", 2, 2, texels_rgba8_srgb, {}, {}}); // an outline's: without texels
    MaterialDesc m;
    m.name = "glowing oak";
    m.kind = material_principled;
    m.base_color = vec3(0.1f, 0.2f, 0.3f);
    m.emission = vec3(2.0f, 1.0f, 0.5f);
    m.principled.clearcoat = 0.75f;
    const Index<MaterialDesc> plain = add(scene, m);
    m.base_texture.image = {0};
    const Index<MaterialDesc> textured = add(scene, m);
    const Scene back =
        read_pbrt("WorldBegin\n" + pbrt_text(scene, plain) + "NamedMaterial \"glowing oak\"\nShape \"sphere\"\n");
    ASSERT_EQ(back.materials.size(), 1u);
    EXPECT_EQ(back.materials[0].name, "glowing oak");
    EXPECT_EQ(back.materials[0].kind, material_principled);
    EXPECT_EQ(back.materials[0].base_color, m.base_color);
    EXPECT_EQ(back.materials[0].emission, m.emission);
    EXPECT_EQ(back.materials[0].principled.clearcoat, 0.75f);
    EXPECT_NE(pbrt_text(scene, textured).find("scene_textures/000.png"), std::string::npos);
    EXPECT_FALSE(std::filesystem::exists("scene_textures")) << "nothing is written";
}

TEST(PbrtText, OfALightACameraAndTheEnvironment)
{
    LightDesc spot;
    spot.kind = light_spot;
    spot.name = "key";
    spot.position = vec3(1, 2, 3);
    spot.emission = vec3(4, 5, 6);
    CameraDesc camera;
    camera.eye = vec3(7, 1, 2);
    camera.fov_degrees = 33.0f;
    EnvironmentDesc sky;
    sky.radiance = vec3(0.1f, 0.2f, 0.4f);
    const Scene back = read_pbrt(pbrt_text(camera) + "WorldBegin\n" + pbrt_text(spot) + pbrt_text(Scene{}, sky));
    ASSERT_EQ(back.lights.size(), 1u);
    EXPECT_EQ(back.lights[0].name, "key");
    EXPECT_EQ(back.lights[0].position, spot.position);
    EXPECT_EQ(back.lights[0].emission, spot.emission);
    ASSERT_EQ(back.cameras.size(), 1u);
    EXPECT_EQ(back.cameras[0].eye, camera.eye);
    EXPECT_EQ(back.cameras[0].fov_degrees, 33.0f);
    EXPECT_EQ(back.environment.radiance, sky.radiance);
}

TEST(PbrtText, OfAWholeScene)
{
    Scene scene;
    SphereDesc ball;
    ball.material = add(scene, MaterialDesc{});
    place(scene, ball);
    add(scene, CameraDesc{});
    const Scene back = read_pbrt(pbrt_text(scene));
    EXPECT_EQ(back.spheres.size(), 1u);
    EXPECT_EQ(back.cameras.size(), 1u);
}

TEST(PbrtText, OfALargeMeshNamesAFileThatNobodyWrites)
{
    Scene scene;
    place(scene, make_torus("ring", 1.0f, 0.3f, 100, 50, add(scene, MaterialDesc{})));
    EXPECT_NE(pbrt_text(scene).find("scene_meshes/000.ply"), std::string::npos);
    EXPECT_FALSE(std::filesystem::exists("scene_meshes"));
}

} // namespace
} // namespace snell::test
