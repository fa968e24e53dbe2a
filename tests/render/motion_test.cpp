// What moves without being packed and built anew makes the pictures that it would make if it were.
#include "snell/io/load.h"
#include "tests/render/scenes.h"
#include "tests/scene/moving_scene.h"

#include <cmath>
#include <filesystem>
#include <iostream>

namespace snell::test {
namespace {

RenderSettings moving_picture(const std::string& integrator)
{
    RenderSettings settings = small_picture(integrator);
    settings.keep_motion = true;
    return settings;
}

const float moments[] = {0.0f, 0.4f, 1.0f, 1.8f, 0.2f};

// All but the steps of rays, which are those of another tree once one was refitted.
void expect_same_but_steps(Film a, const Film& b)
{
    EXPECT_EQ(a.layers.steps.size(), b.layers.steps.size());
    a.layers.steps = b.layers.steps;
    expect_same_film(a, b);
}

void expect_update_is_anew(Scene scene, const RenderSettings& settings)
{
    pose(scene, first_animation, 1.5f);
    const auto prepared = prepare(scene, settings);
    for (const float seconds : moments) {
        SCOPED_TRACE(seconds);
        pose(scene, first_animation, seconds);
        prepared->update(scene);
        EXPECT_TRUE(prepared->updated);
        expect_same_but_steps(render(*prepared, settings).film, render(scene, settings).film);
    }
}

class Motion : public testing::TestWithParam<const char*>
{
};

INSTANTIATE_TEST_SUITE_P(, Motion, testing::Values("path", "whitted", "normals", "uv"),
                         [](const auto& integrator) { return std::string(integrator.param); });

TEST_P(Motion, AnUpdateIsWhatPreparingAnewGives)
{
    expect_update_is_anew(moving_scene(), moving_picture(GetParam()));
}

TEST(MotionSettings, WithoutTextures)
{
    RenderSettings settings = moving_picture("path");
    settings.image_textures = false;
    expect_update_is_anew(moving_scene(), settings);
    settings.force_diffuse = true;
    expect_update_is_anew(moving_scene(), settings);
}

TEST(MotionSettings, EveryPolicyAndStructure)
{
    for (const UpdatePolicy policy : {UpdatePolicy::automatic, UpdatePolicy::refit, UpdatePolicy::rebuild})
        for (const char* accel : {"", "bvh8q", "brute"}) {
            SCOPED_TRACE(accel);
            RenderSettings settings = moving_picture("path");
            settings.layers = false;
            settings.spp = 1;
            settings.accel = accel;
            settings.accel_options.update = policy;
            expect_update_is_anew(moving_scene(), settings);
        }
}

TEST(MotionSettings, TheCameraIsFollowed)
{
    Scene scene = moving_scene();
    scene.cameras[0].node = add_node(scene, "dolly", {0, 1, 6});
    animate(scene, scene.cameras[0].node, AnimatedProperty::translation, {0, 2}, {0, 1, 6, 3, 1, 6});
    expect_update_is_anew(scene, moving_picture("path"));
}

TEST(MotionSettings, ASceneWithoutCameraIsRefused)
{
    Scene scene = moving_scene();
    const auto prepared = prepare(scene, moving_picture("path"));
    scene.cameras.clear();
    EXPECT_THROW(prepared->update(scene), Error);
}

// What stays apart is not what is moved into world space, bit for bit; but it shows the same.
TEST(MotionSettings, KeptMotionShowsWhatBakedMotionShows)
{
    Scene scene = moving_scene();
    for (const float seconds : moments) {
        SCOPED_TRACE(seconds);
        pose(scene, first_animation, seconds);
        for (const char* integrator : {"normals", "path"}) {
            RenderSettings settings = moving_picture(integrator);
            settings.spp = integrator == std::string("path") ? 64 : 11;
            const Picture kept = render(scene, settings).film.picture();
            settings.keep_motion = false;
            const Picture baked = render(scene, settings).film.picture();
            double sum = 0, difference = 0;
            for (std::size_t i = 0; i < kept.pixels.size(); ++i) {
                sum += static_cast<double>(kept.pixels[i].x + kept.pixels[i].y);
                difference +=
                    static_cast<double>(kept.pixels[i].x - baked.pixels[i].x + kept.pixels[i].y - baked.pixels[i].y);
            }
            EXPECT_LT(std::abs(difference), 0.01 * sum) << integrator;
        }
    }
}

// ---- real models ----

const char* const models[] = {
    "AnimatedMorphCube/glTF-Binary/AnimatedMorphCube.glb",
    "BoxAnimated/glTF/BoxAnimated.gltf",
    "CesiumMan/glTF-Binary/CesiumMan.glb",
    "CesiumMilkTruck/glTF/CesiumMilkTruck.gltf",
    "Fox/glTF/Fox.gltf",
    "InterpolationTest/glTF-Binary/InterpolationTest.glb",
    "MorphStressTest/glTF-Binary/MorphStressTest.glb",
    "RiggedFigure/glTF-Binary/RiggedFigure.glb",
    "SimpleMorph/glTF/SimpleMorph.gltf",
    "SimpleSkin/glTF-Embedded/SimpleSkin.gltf",
};

TEST(MotionOfModels, UpdatesAreWhatPreparingAnewGives)
{
    const std::filesystem::path folder = SNELL_SOURCE_DIR "/../shared/scenes/gltf";
    int missing = 0;
    for (const char* model : models) {
        SCOPED_TRACE(model);
        if (!std::filesystem::exists(folder / model)) {
            ++missing;
            continue;
        }
        Scene scene = load_scene(folder / model);
        complete(scene, 1.0f);
        ASSERT_FALSE(scene.animations.empty());
        RenderSettings settings = moving_picture("path");
        settings.layers = false;
        settings.width = settings.height = 24;
        settings.spp = 2;
        const auto prepared = prepare(scene, settings);
        bool moved = false;
        for (uint animation = 0; animation < scene.animations.size(); ++animation)
            for (const float part : {0.1f, 0.7f}) {
                SCOPED_TRACE(testing::Message() << "animation " << animation << " at " << part);
                pose(scene, {animation}, part * scene.animations[animation].duration);
                prepared->update(scene);
                const auto anew = prepare(scene, settings);
                expect_same_packed(prepared->packed, anew->packed);
                expect_same_film(render(*prepared, settings).film, render(*anew, settings).film);
                moved = moved || prepared->changes.any();
                EXPECT_FALSE(prepared->changes.world) << "what moves lies apart";
            }
        EXPECT_TRUE(moved);
    }
    if (missing > 0) std::cout << missing << " animated models of shared/scenes/gltf are not there: left out\n";
}

} // namespace
} // namespace snell::test
