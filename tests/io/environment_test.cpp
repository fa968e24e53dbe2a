// Environments from files: shape, orientation, rotation.
#include "snell/io/environment.h"

#include "snell/core/error.h"
#include "snell/io/image/write.h"
#include "snell/kernel/environment.h"
#include "snell/scene/packed.h"
#include "tests/io/image_helpers.h"

#include <gtest/gtest.h>

namespace snell {
namespace {

// Black but for one white texel.
Picture spot(int width, int height, int x, int y)
{
    Picture picture{width, height,
                    std::vector<vec3>(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), vec3(0.0f))};
    picture.at(x, y) = vec3(4.0f);
    return picture;
}

// Where the light of a map with one spot comes from.
vec3 light_from(const std::filesystem::path& file, float degrees)
{
    Scene scene;
    set_environment(scene, file, degrees);
    const PackedScene packed = pack(scene);
    const SceneView view = packed.view();
    vec3 sum(0.0f);
    for (int i = 0; i < 20'000; ++i) {
        const float z = 1.0f - (2.0f * static_cast<float>(i) + 1.0f) / 20'000.0f;
        const float r = std::sqrt(1.0f - z * z), turn = 2.3999632f * static_cast<float>(i);
        const vec3 w(r * std::cos(turn), z, r * std::sin(turn));
        sum += environment_radiance(view, w).y * w;
    }
    return normalize(sum);
}

void expect_near(vec3 a, vec3 b)
{
    EXPECT_LT(length(a - b), 0.15f) << a.x << " " << a.y << " " << a.z;
}

TEST(SetEnvironment, LatitudeLongitudeMaps)
{
    const TemporaryFolder folder;
    write_picture(folder / "ahead.pfm", spot(65, 32, 32, 15)); // not twice as wide
    Scene scene;
    EXPECT_THROW(set_environment(scene, folder / "ahead.pfm"), Error);

    write_picture(folder / "right.exr", spot(64, 32, 48, 16));
    expect_near(light_from(folder / "right.exr", 0.0f), vec3(1, 0, 0));
    expect_near(light_from(folder / "right.exr", 90.0f), vec3(0, 0, 1)); // further to the right: behind
    expect_near(light_from(folder / "right.exr", -90.0f), vec3(0, 0, -1));
    write_picture(folder / "up.hdr", spot(64, 32, 5, 0));
    expect_near(light_from(folder / "up.hdr", 30.0f), vec3(0, 1, 0));
}

TEST(SetEnvironment, SquareMapsAreOctahedralWithTheZenithInTheMiddle)
{
    const TemporaryFolder folder;
    write_picture(folder / "up.pfm", spot(33, 33, 16, 16));
    expect_near(light_from(folder / "up.pfm", 0.0f), vec3(0, 1, 0));
    write_picture(folder / "right.pfm", spot(33, 33, 32, 16)); // the middle of the right edge: +X of the map
    expect_near(light_from(folder / "right.pfm", 0.0f), vec3(1, 0, 0));
    expect_near(light_from(folder / "right.pfm", 90.0f), vec3(0, 0, 1));
    write_picture(folder / "bottom.pfm", spot(33, 33, 16, 32)); // +Y of the map lies ahead
    expect_near(light_from(folder / "bottom.pfm", 0.0f), vec3(0, 0, -1));
}

TEST(SetEnvironment, ReplacesWhatThereWasAndSaysSo)
{
    const TemporaryFolder folder;
    write_picture(folder / "a.exr", spot(8, 4, 1, 1));
    Scene scene;
    scene.environment.radiance = vec3(7.0f);
    scene.environment.to_world = rotation(vec3(1, 0, 0), 20.0f);
    scene.environment.visible = false;
    set_environment(scene, folder / "a.exr", 0.0f, 2.5f);
    EXPECT_EQ(scene.environment.radiance, vec3(2.5f));
    EXPECT_EQ(scene.environment.mapping, environment_equirectangular);
    EXPECT_FALSE(scene.environment.visible); // that is asked for by other means
    ASSERT_EQ(scene.images.size(), 1u);
    EXPECT_EQ(scene.images[0].format, texels_rgba32f);
    EXPECT_EQ(scene.images[0].floats[4 * 9], 4.0f);
    ASSERT_EQ(scene.notes.size(), 1u);
    EXPECT_NE(scene.notes[0].text.find("latitude-longitude"), std::string::npos);

    write_picture(folder / "b.png", spot(4, 4, 1, 1));
    set_environment(scene, folder / "b.png");
    EXPECT_EQ(scene.environment.mapping, environment_octahedral);
    EXPECT_EQ(scene.images.at(scene.environment.image.value).format, texels_rgba8_srgb);
    EXPECT_NE(scene.notes[1].text.find("octahedral"), std::string::npos);
}

TEST(SetEnvironment, RefusesWhatHasNoMeaning)
{
    const TemporaryFolder folder;
    write_picture(folder / "a.exr", spot(8, 4, 1, 1));
    write_picture(folder / "tall.exr", spot(4, 8, 1, 1));
    Scene scene;
    EXPECT_THROW(set_environment(scene, folder / "none.exr"), Error);
    EXPECT_THROW(set_environment(scene, folder / "a.exr", infinity()), Error);
    EXPECT_THROW(set_environment(scene, folder / "a.exr", 0.0f, -1.0f), Error);
    EXPECT_THROW(set_environment(scene, folder / "a.exr", 0.0f, std::nanf("")), Error);
    try {
        set_environment(scene, folder / "tall.exr");
        FAIL();
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("tall.exr"), std::string::npos);
        EXPECT_NE(std::string(error.what()).find("4 x 8"), std::string::npos);
    }
    EXPECT_TRUE(scene.images.empty()); // nothing half done
}

} // namespace
} // namespace snell
