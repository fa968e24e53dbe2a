#include "snell/core/error.h"
#include "snell/scene/scene.h"
#include "snell/scene/shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace snell {
namespace {

// How far towards the picture's edge the outermost corner of the bounds comes, in x and in y: 1 is on the edge.
// Infinite if a corner is behind the camera.
vec2 reach(const CameraDesc& camera, const Bounds& bounds, float aspect)
{
    const vec3 forward = normalize(camera.target - camera.eye);
    const vec3 right = normalize(cross(forward, camera.up));
    const vec3 up = cross(right, forward);
    const float tan_short = std::tan(0.5f * camera.fov_degrees * pi / 180.0f);
    const vec2 tangent = aspect > 1.0f ? vec2(tan_short * aspect, tan_short) : vec2(tan_short, tan_short / aspect);
    vec2 most(0.0f);
    for (int i = 0; i < 8; ++i) {
        const vec3 corner(i & 1 ? bounds.upper.x : bounds.lower.x, i & 2 ? bounds.upper.y : bounds.lower.y,
                          i & 4 ? bounds.upper.z : bounds.lower.z);
        const vec3 d = corner - camera.eye;
        const float depth = dot(d, forward);
        if (depth <= 0.0f) return vec2(infinity());
        most = max(most, abs(vec2(dot(d, right), dot(d, up))) / (depth * tangent));
    }
    return most;
}

Scene box_scene(vec3 lower, vec3 upper)
{
    Scene scene;
    place(scene, make_box("box", lower, upper, add(scene, MaterialDesc{})));
    return scene;
}

TEST(Complete, SeesAllCornersAndNotMuchMore)
{
    std::mt19937 engine(5);
    std::uniform_real_distribution<float> number(-1.0f, 1.0f);
    for (int i = 0; i < 300; ++i) {
        vec3 center, half;
        for (int k = 0; k < 3; ++k) {
            center[k] = 20.0f * number(engine);
            half[k] = std::exp(2.0f * number(engine));
        }
        Scene scene = box_scene(center - half, center + half);
        const float aspect = std::exp(1.2f * number(engine));
        complete(scene, aspect);
        ASSERT_EQ(scene.cameras.size(), 1u);
        EXPECT_EQ(scene.cameras[0].fov_degrees, 40.0f);
        const vec2 most = reach(scene.cameras[0], scene_bounds(scene), aspect);
        EXPECT_LT(std::max(most.x, most.y), 1.0f);
        EXPECT_GT(std::max(most.x, most.y), 0.85f);
        // Along -Z, a bit from above.
        EXPECT_GT(scene.cameras[0].eye.z, scene_bounds(scene).upper.z);
        EXPECT_GT(scene.cameras[0].eye.y, scene.cameras[0].target.y);
        EXPECT_NEAR(scene.cameras[0].eye.x, scene.cameras[0].target.x, 1e-3f);
    }
}

TEST(Complete, AlsoFlatThings)
{
    for (const vec3 half : {vec3(1, 0, 1), vec3(0, 1, 1), vec3(1, 1, 0)}) {
        Scene scene;
        const auto grey = add(scene, MaterialDesc{});
        const vec3 u = half.x > 0.0f ? vec3(1, 0, 0) : vec3(0, 1, 0), v = half.z > 0.0f ? vec3(0, 0, 1) : vec3(0, 1, 0);
        place(scene, make_quad("", -u - v, u - v, u + v, -u + v, grey));
        complete(scene, 1.0f);
        const vec2 most = reach(scene.cameras[0], scene_bounds(scene), 1.0f);
        EXPECT_LT(std::max(most.x, most.y), 1.0f);
        // It must not be seen edge on.
        const vec3 forward = normalize(scene.cameras[0].target - scene.cameras[0].eye);
        EXPECT_GT(std::abs(dot(forward, normalize(cross(u, v)))), 0.4f) << half.x << half.y << half.z;
    }
}

TEST(Complete, LooksIntoARoomAtLevel)
{
    Scene scene;
    const auto grey = add(scene, MaterialDesc{});
    place(scene, make_quad("floor", {-1, 0, -1}, {-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, grey));
    place(scene, make_quad("ceiling", {-1, 2, -1}, {1, 2, -1}, {1, 2, 1}, {-1, 2, 1}, grey));
    place(scene, make_quad("back", {-1, 0, -1}, {1, 0, -1}, {1, 2, -1}, {-1, 2, -1}, grey));
    complete(scene, 1.0f);
    EXPECT_NEAR(scene.cameras[0].eye.x, 0.0f, 1e-5f);
    EXPECT_NEAR(scene.cameras[0].eye.y, 1.0f, 1e-5f);
    EXPECT_NEAR(scene.cameras[0].target.y, 1.0f, 1e-5f);
    EXPECT_GT(scene.cameras[0].eye.z, 3.0f);
    EXPECT_LT(scene.cameras[0].eye.z, 5.0f);
}

TEST(Complete, AddsLightOnlyWhereThereIsNone)
{
    Scene dark = box_scene(vec3(-1), vec3(1));
    complete(dark, 1.0f);
    EXPECT_TRUE(dark.environment.image.valid()); // the studio: see environment_test.cpp
    EXPECT_TRUE(dark.lights.empty());
    ASSERT_EQ(dark.notes.size(), 2u);
    EXPECT_NE(dark.notes[1].text.find("no light: a neutral studio"), std::string::npos);

    Scene lit = box_scene(vec3(-1), vec3(1));
    add(lit, LightDesc{});
    complete(lit, 1.0f);
    EXPECT_EQ(lit.lights.size(), 1u);
    EXPECT_EQ(lit.environment.radiance, vec3(0.0f));
    EXPECT_FALSE(lit.environment.image.valid());

    Scene sky = box_scene(vec3(-1), vec3(1));
    sky.environment.radiance = vec3(0.1f);
    complete(sky, 1.0f);
    EXPECT_FALSE(sky.environment.image.valid());

    Scene glowing = box_scene(vec3(-1), vec3(1));
    glowing.materials[0].emission = vec3(1.0f);
    complete(glowing, 1.0f);
    EXPECT_FALSE(glowing.environment.image.valid());

    // An emissive material that nothing has does not light anything.
    Scene unused = box_scene(vec3(-1), vec3(1));
    MaterialDesc glow;
    glow.emission = vec3(1.0f);
    add(unused, glow);
    add(unused, SphereDesc{"", vec3(0.0f), 1.0f, {1}}); // not placed
    complete(unused, 1.0f);
    EXPECT_TRUE(unused.environment.image.valid());
}

TEST(Complete, KeepsTheCamerasThereAre)
{
    Scene scene = box_scene(vec3(-1), vec3(1));
    add(scene, CameraDesc{"mine", {1, 2, 3}, {0, 0, 0}, {0, 1, 0}, 25.0f});
    complete(scene, 1.0f);
    ASSERT_EQ(scene.cameras.size(), 1u);
    EXPECT_EQ(scene.cameras[0].name, "mine");
}

TEST(Complete, EmptyScenesAndPlanesGetADefault)
{
    Scene empty;
    complete(empty, 1.0f);
    ASSERT_EQ(empty.cameras.size(), 1u);
    EXPECT_EQ(empty.notes[0].kind, Note::Kind::warning);
    EXPECT_NE(empty.notes[0].text.find("empty"), std::string::npos);
    validate(empty);

    for (const vec3 normal : {vec3(0, 2, 0), vec3(0, 0, 1), vec3(0, 0, -3), vec3(1, 1, 0)}) {
        Scene planes;
        const auto grey = add(planes, MaterialDesc{});
        add(planes, PlaneDesc{"", {1, 2, 3}, normal, grey});
        complete(planes, 1.0f);
        const CameraDesc& camera = planes.cameras.at(0);
        EXPECT_GT(dot(camera.eye - vec3(1, 2, 3), normal), 0.0f);
        EXPECT_LT(dot(camera.target - camera.eye, normal), 0.0f); // looks at it
        const std::size_t said = planes.notes.size();
        validate(planes);
        EXPECT_EQ(planes.notes.size(), said);
    }
}

TEST(Complete, RefusesAnImpossibleAspect)
{
    Scene scene;
    EXPECT_THROW(complete(scene, 0.0f), Error);
    EXPECT_THROW(complete(scene, infinity()), Error);
}

} // namespace
} // namespace snell
