// The studio that dark scenes get, which scenes count as dark, and how environments are packed.
#include "snell/core/error.h"
#include "snell/kernel/environment.h"
#include "snell/scene/lit.h"
#include "snell/scene/packed.h"
#include "snell/scene/shapes.h"
#include "snell/scene/studio.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace snell {
namespace {

// Evenly over the sphere.
std::vector<vec3> directions(int count)
{
    std::vector<vec3> result;
    for (int i = 0; i < count; ++i) {
        const double z = 1 - (2 * i + 1.0) / count, r = std::sqrt(1 - z * z), turn = 2.399963229728653 * i;
        result.emplace_back(r * std::cos(turn), z, r * std::sin(turn));
    }
    return result;
}

Scene box_scene(float emission = 0.0f)
{
    Scene scene;
    MaterialDesc material;
    material.emission = vec3(emission);
    place(scene, make_box("box", vec3(-1.0f), vec3(1.0f), add(scene, material)));
    return scene;
}

// Irradiance / pi: what a white diffuse surface with that normal shows.
double shown(const SceneView& view, vec3 normal)
{
    double sum = 0;
    const std::vector<vec3> all = directions(20'000);
    for (const vec3 w : all)
        sum += static_cast<double>(std::max(dot(w, normal), 0.0f) * environment_radiance(view, w).y);
    return 4 * sum / static_cast<double>(all.size());
}

TEST(Studio, TheKeyLightIsOverTheCamerasLeftShoulder)
{
    std::mt19937 engine(3);
    std::uniform_real_distribution<float> number(-1.0f, 1.0f);
    for (int i = 0; i < 20; ++i) {
        Scene scene = box_scene();
        CameraDesc camera;
        camera.target = vec3(number(engine), number(engine), number(engine));
        camera.eye = camera.target + 5.0f * vec3(number(engine), 0.3f * number(engine), number(engine) + 1.5f);
        camera.up = i % 2 == 0 ? vec3(0, 1, 0) : vec3(0, 0.1f, 2.0f);
        if (i % 2 == 1) std::swap(camera.eye.y, camera.eye.z); // nor along its up
        camera.mirrored = i % 4 >= 2;
        add(scene, camera);
        add_studio(scene);
        validate(scene);
        const PackedScene packed = pack(scene);
        const SceneView view = packed.view();
        const vec3 up = normalize(camera.up);
        const vec3 across = normalize(cross(camera.target - camera.eye, up));
        const vec3 back = cross(across, up);
        const vec3 right = across * (camera.mirrored ? -1.0f : 1.0f); // of the picture
        vec3 key(0.0f);                                               // about the brightest on the camera's side
        for (const vec3 w : directions(5000))
            if (dot(w, back) > 0.0f) key += sqr(sqr(environment_radiance(view, w).y)) * w;
        key = normalize(key);
        EXPECT_LT(dot(key, right), -0.4f) << i;
        EXPECT_GT(dot(key, up), 0.3f) << i;
        EXPECT_GT(shown(view, -right), 1.5 * shown(view, right)) << i;
        EXPECT_GT(shown(view, up), 3.0 * shown(view, -up)) << i;
    }
}

TEST(Studio, AGreyOfOneHalfIsAMidTone)
{
    Scene scene = box_scene();
    add(scene, CameraDesc{});
    add_studio(scene);
    const PackedScene packed = pack(scene);
    const SceneView view = packed.view();
    const double key = shown(view, normalize(vec3(-0.95f, 0.8f, 0.55f)));
    const double front = shown(view, vec3(0, 0, 1)), shadow = shown(view, normalize(vec3(0.6f, -0.6f, 0.5f)));
    EXPECT_NEAR(0.5 * key, 0.45, 0.1);
    EXPECT_NEAR(0.5 * front, 0.23, 0.06); // 0.214 is the middle of sRGB
    EXPECT_NEAR(0.5 * shadow, 0.09, 0.04);
    for (const vec3 w : directions(300)) {
        const vec3 l = environment_radiance(view, w);
        EXPECT_TRUE(l.x == l.y && l.y == l.z && l.x > 0.0f); // neutral, and nowhere black
    }
}

TEST(Lit, LampsLightAndGlowingDetailsDoNot)
{
    EXPECT_FALSE(is_lit(box_scene()));
    EXPECT_TRUE(is_lit(box_scene(1.0f)));

    Scene detail = box_scene(); // a small lamp of a device
    MaterialDesc glow;
    glow.emission = vec3(1.0f, 0.0f, 0.0f);
    const auto red = add(detail, glow);
    place(detail, SphereDesc{"", vec3(0.0f), 0.05f, red});
    EXPECT_FALSE(is_lit(detail));
    detail.spheres[0].radius = 1.0f;
    EXPECT_TRUE(is_lit(detail));
    detail.spheres[0].radius = 0.05f;
    detail.materials[1].emission = vec3(1.1f); // brighter than any display
    EXPECT_TRUE(is_lit(detail));

    Scene textured = box_scene(1.0f); // most of the texture is black
    Image image;
    image.width = 20, image.height = 20;
    image.bytes.assign(4 * 400, 0);
    for (std::size_t i = 0; i < 3; ++i) image.bytes[i] = 255;
    textured.materials[0].emission_texture.image = add(textured, image);
    EXPECT_FALSE(is_lit(textured));
    for (std::size_t i = 0; i < 400; ++i) textured.images[0].bytes[i] = 255;
    EXPECT_TRUE(is_lit(textured));
    textured.materials[0].emission = vec3(5.0f);
    textured.images[0].bytes.assign(4 * 400, 0); // black altogether
    EXPECT_FALSE(is_lit(textured));

    Scene unlit = box_scene();
    unlit.materials[0].kind = material_unlit;
    EXPECT_TRUE(is_lit(unlit));
    add(unlit, MaterialDesc{});
    EXPECT_FALSE(is_lit(unlit));

    Scene plane;
    glow.emission = vec3(0.01f);
    const auto dim = add(plane, glow);
    add(plane, PlaneDesc{"", vec3(0.0f), vec3(0, 1, 0), dim});
    EXPECT_TRUE(is_lit(plane));

    // scaled: it is the placed size that counts
    Scene scaled = box_scene();
    glow.emission = vec3(1.0f);
    const auto small = add(scaled, glow);
    place(scaled, make_box("", vec3(-0.02f), vec3(0.02f), small));
    EXPECT_FALSE(is_lit(scaled));
    scaled.instances[1].transform = scaling(vec3(20.0f));
    EXPECT_TRUE(is_lit(scaled));
}

Image float_image(uint width, uint height, float value)
{
    Image image;
    image.width = width, image.height = height;
    image.format = texels_rgba32f;
    image.floats.assign(std::size_t{4} * width * height, value);
    return image;
}

TEST(PackEnvironment, CellsFollowThePicture)
{
    Scene scene = box_scene();
    Image image = float_image(6, 3, 0.0f);
    image.floats[4 * (1 * 6 + 4) + 1] = 10.0f; // the texel (4, 1), green
    scene.environment.image = add(scene, image);
    scene.environment.radiance = vec3(1.0f, 2.0f, 1.0f);
    validate(scene);
    const PackedScene packed = pack(scene);
    EXPECT_EQ(packed.environment.columns, 6u);
    EXPECT_EQ(packed.environment.rows, 3u);
    EXPECT_EQ(packed.environment.select_pdf, 1.0f);
    const std::vector<float>& cdf = packed.environment_cdf;
    ASSERT_EQ(cdf.size(), 4u + 3u * 7u);
    for (std::size_t row = 0; row < 4; ++row) {
        const std::size_t begin = row == 0 ? 0 : 4 + 7 * (row - 1), end = row == 0 ? 3 : begin + 6;
        EXPECT_EQ(cdf[begin], 0.0f);
        EXPECT_EQ(cdf[end], 1.0f);
        for (std::size_t i = begin; i < end; ++i) EXPECT_LE(cdf[i], cdf[i + 1]);
    }
    const auto share = [&](uint x, uint y) {
        return (cdf[y + 1] - cdf[y]) * (cdf[4 + 7 * y + x + 1] - cdf[4 + 7 * y + x]);
    };
    EXPECT_GT(share(4, 1), 0.4f);
    EXPECT_GT(share(3, 1), 0.0f); // light that filtering brings over
    EXPECT_GT(share(4, 0), 0.0f);
    EXPECT_EQ(share(1, 1), 0.0f);
}

TEST(PackEnvironment, BlackPicturesAreNoLight)
{
    Scene scene = box_scene();
    scene.environment.image = add(scene, float_image(4, 2, 0.0f));
    scene.environment.radiance = vec3(1.0f);
    validate(scene);
    const PackedScene packed = pack(scene);
    EXPECT_TRUE(is_black(packed.environment.radiance));
    EXPECT_EQ(packed.environment.columns, 0u);
}

TEST(PackEnvironment, LargePicturesAreSampledInFewerCells)
{
    Scene scene = box_scene();
    Image image = float_image(2500, 3, 0.0f);
    image.floats[4 * 2499] = 1.0f; // the last texel of the first row: its light reaches over the seam
    scene.environment.image = add(scene, image);
    scene.environment.radiance = vec3(1.0f);
    validate(scene);
    const PackedScene packed = pack(scene);
    EXPECT_EQ(packed.environment.columns, 1024u);
    const SceneView view = packed.view();
    for (const float u : {0.99999f, 0.9998f, 0.9996f, 0.9994f, 0.00001f, 0.0001f}) {
        const vec3 w = environment_direction(packed.environment, vec2(u, 0.2f));
        EXPECT_EQ(pdf_environment(view, w) > 0.0f, true) << u;
    }
}

TEST(ValidateEnvironment, MendsTexelsAndRefusesShear)
{
    Scene scene = box_scene();
    Image image = float_image(4, 2, 1.0f);
    image.floats[0] = -1.0f;
    image.floats[5] = std::nanf("");
    image.floats[10] = infinity();
    scene.environment.image = add(scene, image);
    scene.environment.radiance = vec3(1.0f);
    validate(scene);
    const std::vector<float>& floats = scene.images[0].floats;
    EXPECT_EQ(floats[0], 0.0f);
    EXPECT_EQ(floats[5], 0.0f);
    EXPECT_EQ(floats[10], 1e9f);
    ASSERT_FALSE(scene.notes.empty());
    EXPECT_NE(scene.notes.back().text.find("3 values"), std::string::npos) << scene.notes.back().text;

    scene.environment.to_world = rotation(vec3(1, 2, 3), 77.0f);
    EXPECT_NO_THROW(validate(scene));
    scene.environment.to_world = compose(scaling(vec3(-1, 1, 1)), rotation(vec3(1, 2, 3), 77.0f));
    EXPECT_NO_THROW(validate(scene));
    scene.environment.to_world = scaling(vec3(1.0f, 1.1f, 1.0f));
    EXPECT_THROW(validate(scene), Error);
    scene.environment.to_world = identity_transform();
    scene.environment.image = {7};
    EXPECT_THROW(validate(scene), Error);
}

TEST(PackMaterials, UnlitShowsItsColourAndNoLamp)
{
    Scene scene = box_scene(3.0f);
    scene.materials[0].kind = material_unlit;
    validate(scene);
    EXPECT_TRUE(pack(scene).lights.empty());
}

} // namespace
} // namespace snell
