#include "snell/view/navigation.h"

#include "snell/core/error.h"
#include "snell/kernel/camera.h"
#include "snell/render/params.h"
#include "snell/view/camera_text.h"

#include <gtest/gtest.h>

#include <cmath>

namespace snell::view {

static CameraDesc camera_at(vec3 eye, vec3 target)
{
    CameraDesc camera;
    camera.eye = eye, camera.target = target;
    return camera;
}

static void expect_near(vec3 a, vec3 b, float tolerance = 1e-5f)
{
    EXPECT_NEAR(a.x, b.x, tolerance);
    EXPECT_NEAR(a.y, b.y, tolerance);
    EXPECT_NEAR(a.z, b.z, tolerance);
}

// Where a point appears, in the unit square of the picture.
static vec2 seen_at(const CameraDesc& desc, vec3 point)
{
    const ReadyCamera camera = make_camera(desc, 1000, 1000);
    const vec3 p = camera_project(camera, point);
    EXPECT_GT(p.z, 0.0f);
    return {p.x / 1000.0f, p.y / 1000.0f};
}

TEST(Navigation, FliesAlongThePicturesAxes)
{
    const CameraDesc start = camera_at({0, 0, 5}, {0, 0, 0});
    expect_near(fly(start, 0, 0, 2).eye, {0, 0, 3});
    expect_near(fly(start, 1, 0, 0).eye, {1, 0, 5});
    expect_near(fly(start, 0, 1, 0).eye, {0, 1, 5});
    expect_near(fly(start, 1, 2, 3).target, {1, 2, -3});
    CameraDesc mirrored = start;
    mirrored.mirrored = true;
    expect_near(fly(mirrored, 1, 0, 0).eye, {-1, 0, 5});
}

TEST(Navigation, WhatIsTurnedToGoesToTheMiddle)
{
    for (const bool is_mirrored : {false, true}) {
        CameraDesc start = camera_at({0, 1, 5}, {0, 1, 0});
        start.mirrored = is_mirrored;
        const vec3 point(0.2f, 1.3f, 0.0f);
        const vec2 before = seen_at(start, point);
        const float to_right = (before.x - 0.5f) * 0.5f, upwards = (0.5f - before.y) * 0.5f;
        const vec2 after = seen_at(turn(start, to_right, upwards), point);
        EXPECT_LT(std::abs(after.x - 0.5f), std::abs(before.x - 0.5f));
        EXPECT_LT(std::abs(after.y - 0.5f), std::abs(before.y - 0.5f));
        expect_near(turn(start, 0.3f, 0.2f).eye, start.eye);
        EXPECT_NEAR(length(turn(start, 0.3f, 0.2f).target - start.eye), 5.0f, 1e-4f);
    }
}

TEST(Navigation, NeverTurnsOverThePoles)
{
    CameraDesc camera = camera_at({0, 0, 5}, {0, 0, 0});
    for (int i = 0; i < 100; ++i) camera = turn(camera, 0.01f, 0.1f);
    const vec3 view = normalize(camera.target - camera.eye);
    EXPECT_GT(view.y, 0.99f);
    EXPECT_LT(view.y, 1.0f);
    EXPECT_GT(camera_axes(camera).up.y, 0.0f);
    for (int i = 0; i < 100; ++i) camera = orbit(camera, {1, 2, 3}, 0.01f, 0.1f);
    EXPECT_GT(camera_axes(camera).up.y, 0.0f);
}

TEST(Navigation, OrbitKeepsThePivotWhereItIsInThePicture)
{
    const CameraDesc start = camera_at({1, 2, 6}, {0, 0.5f, 0});
    const vec3 pivot(0.4f, 0.8f, -0.3f);
    const vec2 before = seen_at(start, pivot);
    const CameraDesc turned = orbit(start, pivot, 0.7f, -0.2f);
    const vec2 after = seen_at(turned, pivot);
    EXPECT_NEAR(before.x, after.x, 1e-4f);
    EXPECT_NEAR(before.y, after.y, 1e-4f);
    EXPECT_NEAR(length(turned.eye - pivot), length(start.eye - pivot), 1e-4f);
    // What lies in front of the pivot follows the hand to the right.
    const vec3 nearer = pivot + 0.1f * normalize(start.eye - pivot);
    EXPECT_GT(seen_at(orbit(start, pivot, 0.1f, 0.0f), nearer).x, seen_at(start, nearer).x);
    EXPECT_LT(seen_at(orbit(start, pivot, 0.0f, 0.1f), nearer).y, seen_at(start, nearer).y);
}

TEST(Navigation, DollyHalvesTheDistance)
{
    const CameraDesc start = camera_at({0, 0, 8}, {0, 0, 4});
    const CameraDesc nearer = dolly(start, {0, 0, 0}, 0.5f);
    expect_near(nearer.eye, {0, 0, 4});
    expect_near(nearer.target, {0, 0, 0});
}

TEST(Navigation, FrameShowsAllCorners)
{
    Bounds box;
    box.extend({-3, -1, 2});
    box.extend({5, 2, 9});
    for (const float aspect : {0.5f, 1.0f, 2.5f}) {
        const CameraDesc framed = frame(camera_at({40, 30, 20}, {0, 0, 0}), box, aspect);
        const ReadyCamera camera = make_camera(framed, static_cast<int>(400 * aspect), 400);
        float widest = 0.0f;
        for (int corner = 0; corner < 8; ++corner) {
            const vec3 p((corner & 1) ? box.upper.x : box.lower.x, (corner & 2) ? box.upper.y : box.lower.y,
                         (corner & 4) ? box.upper.z : box.lower.z);
            const vec3 seen = camera_project(camera, p);
            EXPECT_GT(seen.z, 0.0f);
            const float x = std::abs(2.0f * seen.x / camera.width - 1.0f);
            const float y = std::abs(2.0f * seen.y / camera.height - 1.0f);
            EXPECT_LT(x, 1.0f);
            EXPECT_LT(y, 1.0f);
            widest = std::max({widest, x, y});
        }
        EXPECT_GT(widest, 0.6f) << aspect; // and not from afar
    }
}

TEST(Navigation, PathGoesThroughItsViewsSmoothly)
{
    const std::vector<CameraDesc> views = {camera_at({0, 0, 5}, {0, 0, 0}), camera_at({4, 0, 5}, {1, 0, 0}),
                                           camera_at({6, 3, 1}, {1, 1, 0}), camera_at({6, 3, 1}, {0, 2, 0})};
    for (std::size_t i = 0; i < views.size(); ++i) {
        const CameraDesc at = along(views, static_cast<float>(i) / 3.0f);
        expect_near(at.eye, views[i].eye, 1e-3f);
        expect_near(at.target, views[i].target, 1e-3f);
    }
    vec3 before = along(views, 0.0f).eye;
    for (int i = 1; i <= 300; ++i) {
        const vec3 now = along(views, static_cast<float>(i) / 300.0f).eye;
        EXPECT_LT(length(now - before), 0.2f) << i;
        before = now;
    }
    expect_near(along({views.data(), 1}, 0.7f).eye, views[0].eye);
}

TEST(Navigation, CamerasComeBackFromText)
{
    CameraDesc camera = camera_at({0.1f, 1e-7f, -12345.678f}, {1.0f / 3.0f, 2, 3});
    camera.fov_degrees = 33.3f;
    const CameraDesc back = parse_camera(camera_options(camera), CameraDesc{});
    EXPECT_EQ(back.eye, camera.eye);
    EXPECT_EQ(back.target, camera.target);
    EXPECT_EQ(back.fov_degrees, camera.fov_degrees);
    EXPECT_THROW(parse_camera("--eye 1,2", camera), std::exception);
    EXPECT_THROW(parse_camera("--eye 1,2,x", camera), std::exception);
    EXPECT_THROW(parse_camera("--fov", camera), std::exception);
    EXPECT_THROW(parse_camera("--fov 0", camera), std::exception);
    EXPECT_THROW(parse_camera("--eye 1,2,3 --target 1,2,3", camera), std::exception);
}

TEST(Navigation, CameraModelsComeBackFromText)
{
    for (const CameraModelInfo& info : camera_models()) {
        CameraDesc camera = camera_at({1, 2, 3}, {4, 5, 7});
        camera.fov_degrees = info.usual_fov;
        camera.model = usual_model(info.kind);
        camera.model.focus_distance = 0.7f;
        if (info.kind == camera_pinhole)
            camera.model.lens_radius = 0.1f, camera.model.blades = 6, camera.model.blade_rotation_degrees = 12.5f;
        if (info.kind == camera_orthographic) camera.model.half_side = 1.3f;
        if (info.kind == camera_hmd) camera.model.eye_distance = 0.07f, camera.model.k = {0.1f, 0, 0.2f, 0, 0.3f};
        if (info.kind == camera_brown_conrady) camera.model.k = {0.1f, 0, 0.01f, 0, 0, 0, 0, 0.002f};
        if (info.kind == camera_lens)
            camera.model.lens = *find_lens("fisheye"), camera.model.film_diagonal = 20.0f,
            camera.model.stop_diameter = 3.0f, camera.model.millimetre = 0.01f;
        EXPECT_EQ(parse_camera(camera_options(camera), CameraDesc{}).model, camera.model) << camera_options(camera);
    }
    for (const char* nonsense :
         {"--camera-model none", "--lens no-such-lens", "--lens-radius x", "--distortion 1,2", "--lens-radius -1",
          "--camera-model hmd --distortion 1,2", "--lens double-gauss --focus-distance 0.001"})
        EXPECT_THROW(parse_camera(nonsense, camera_at({1, 2, 3}, {4, 5, 7})), Error) << nonsense;

    // A line keeps what the one before it said, so a pinhole after another model says that it is one.
    std::vector<CameraDesc> views(3, camera_at({1, 2, 3}, {4, 5, 7}));
    views[0].model = usual_model(camera_equidistant), views[1].model.lens_radius = 0.2f;
    const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "models.txt";
    write_views(file, views);
    const std::vector<CameraDesc> back = read_views(file);
    ASSERT_EQ(back.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(back[i].model, views[i].model) << i;
}

} // namespace snell::view
