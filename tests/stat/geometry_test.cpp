// The small tools under everything: circle, frames, offsets, camera, MIS weights.
#include "snell/kernel/camera.h"
#include "snell/kernel/intersect.h"
#include "snell/kernel/mis.h"
#include "snell/kernel/surface.h"
#include "tests/stat/chi_square.h"

#include <gtest/gtest.h>

namespace snell::test {
namespace {

TEST(Geometry, UnitCircle)
{
    for (int i = 0; i <= 1'000'000; ++i) {
        const float turn = static_cast<float>(i) / 1'000'000.0f;
        const vec2 p = unit_circle(turn);
        const double a = 2 * std::numbers::pi * double{turn};
        ASSERT_NEAR(p.x, std::cos(a), 5e-7) << turn;
        ASSERT_NEAR(p.y, std::sin(a), 5e-7) << turn;
    }
}

TEST(Geometry, FramesAreOrthonormal)
{
    Draw draw(200);
    for (int i = 0; i < 200'000; ++i) {
        vec3 n = draw.direction();
        if (i < 100) // around the poles, where the construction changes sign
            n = normalize(vec3(draw.between(-1e-4f, 1e-4f), draw.between(-1e-4f, 1e-4f), i % 2 == 0 ? 1.0f : -1.0f));
        if (i == 100) n = vec3(0.0f, 0.0f, -1.0f);
        if (i == 101) n = vec3(1.0f, 0.0f, -0.0f);
        const Frame f = make_frame(n);
        ASSERT_NEAR(length(f.s), 1.0f, 1e-6f);
        ASSERT_NEAR(length(f.t), 1.0f, 1e-6f);
        ASSERT_NEAR(dot(f.s, f.t), 0.0f, 1e-6f);
        ASSERT_NEAR(dot(f.s, n), 0.0f, 1e-6f);
        ASSERT_NEAR(dot(f.t, n), 0.0f, 1e-6f);
        ASSERT_GT(dot(cross(f.s, f.t), n), 0.99f) << "right-handed";
        const vec3 w = draw.direction();
        const vec3 back = to_world(f, to_local(f, w));
        ASSERT_NEAR(length(back - w), 0.0f, 2e-6f);
        ASSERT_NEAR(to_local(f, n).z, 1.0f, 1e-6f);
    }
}

// From a point on a triangle, as rounded as it is, moved to one side: a ray to that side misses the triangle, a ray to
// the other side meets it.
TEST(Geometry, OffsetPointsLeaveTheSurface)
{
    Draw draw(201);
    for (const float size : {0.01f, 1.0f, 100.0f})
        for (const float away : {0.0f, 1.0f, 10'000.0f}) {
            int back = 0;
            for (int i = 0; i < 20'000; ++i) {
                // as far from the origin as floats can tell the corners apart
                const vec3 middle = away * size * draw.direction();
                const vec3 a = middle + size * draw.direction(), b = middle + size * draw.direction(),
                           c = middle + size * draw.direction();
                const vec3 raw = cross(b - a, c - a);
                if (length(raw) < 0.2f * size * size) continue;
                const vec3 n = normalize(raw);
                const vec2 u = draw.next2();
                const float v = (1.0f - u.x) * u.y;
                const vec3 p = a + u.x * (b - a) + v * (c - a);
                vec3 w = draw.direction();
                if (dot(w, n) < 0.0f) w = -w;
                if (dot(w, n) < 0.01f) continue;
                const vec3 start = offset_toward(p, n, w);
                const Ray leaving = make_ray(start, w, infinity());
                ASSERT_FALSE(intersect_triangle_watertight(leaving, shear_ray(leaving), a, b, c).ok)
                    << "size " << size << " at distance " << away;
                const Ray returning = make_ray(start, -n, infinity());
                back += intersect_triangle_watertight(returning, shear_ray(returning), a, b, c).ok ? 1 : 0;
                ASSERT_LT(length(start - p), 1e-4f * max(max3(abs(p)), 1.0f)) << "and not far";
            }
            EXPECT_GT(back, 5'000);
        }
}

TEST(Geometry, CameraProjectsWhereItsRaysGo)
{
    Draw draw(202);
    for (int i = 0; i < 2'000; ++i) {
        const vec3 eye = 10.0f * draw.direction();
        const vec3 target = eye + draw.between(0.1f, 5.0f) * draw.direction();
        const vec3 up = draw.direction();
        const vec3 view = normalize(target - eye);
        if (length(cross(view, up)) < 0.1f) continue;
        const float width = std::floor(draw.between(1.0f, 2000.0f)), height = std::floor(draw.between(1.0f, 2000.0f));
        const float tan_half = draw.between(0.05f, 2.0f);
        const Camera camera = make_pinhole(eye, target, up, tan_half, width, height);

        // the middle looks at the target, the shorter side spans the field of view
        EXPECT_NEAR(length(camera_ray(camera, vec2(0.5f * width, 0.5f * height)).direction - view), 0.0f, 3e-6f);
        const vec2 edge = width < height ? vec2(width, 0.5f * height) : vec2(0.5f * width, height);
        const vec3 e = camera_ray(camera, edge).direction;
        EXPECT_NEAR(dot(e, view), 1.0f / std::sqrt(1.0f + tan_half * tan_half), 3e-6f);
        // x goes to the right, y down, and up is up
        const vec3 right = camera_ray(camera, vec2(width, 0.5f * height)).direction;
        EXPECT_GT(dot(right, cross(view, up)), 0.0f);
        EXPECT_GT(dot(camera_ray(camera, vec2(0.5f * width, 0.0f)).direction, up - dot(up, view) * view), 0.0f);

        const vec2 pixel(draw.between(0.0f, width), draw.between(0.0f, height));
        const Ray ray = camera_ray(camera, pixel);
        EXPECT_NEAR(length(ray.direction), 1.0f, 1e-6f);
        const float t = draw.between(1.0f, 20.0f);
        const vec3 p = camera_project(camera, ray_at(ray, t));
        EXPECT_NEAR(p.x, pixel.x, 2e-4f * width);
        EXPECT_NEAR(p.y, pixel.y, 2e-4f * height);
        EXPECT_NEAR(p.z, t * dot(ray.direction, view), 1e-4f * t);
        EXPECT_LT(camera_project(camera, eye - view).z, 0.0f) << "behind the camera";
    }
}

TEST(Geometry, MisWeightsSumToOne)
{
    Draw draw(203);
    for (int i = 0; i < 100'000; ++i) {
        const float a = std::exp(draw.between(-40.0f, 40.0f)), b = std::exp(draw.between(-40.0f, 40.0f));
        EXPECT_NEAR(power_heuristic(a, b) + power_heuristic(b, a), 1.0f, 1e-6f) << a << " " << b;
        EXPECT_NEAR(balance_heuristic(a, b) + balance_heuristic(b, a), 1.0f, 1e-6f) << a << " " << b;
        EXPECT_GE(power_heuristic(a, b) >= 0.5f, a > b);
    }
    EXPECT_NEAR(power_heuristic(3.0f, 1.0f), 0.9f, 1e-6f);
    EXPECT_NEAR(balance_heuristic(3.0f, 1.0f), 0.75f, 1e-6f);
    EXPECT_EQ(power_heuristic(1.0f, 0.0f), 1.0f);
    EXPECT_EQ(power_heuristic(0.0f, 1.0f), 0.0f);
    EXPECT_EQ(power_heuristic(0.0f, 0.0f), 0.0f);
    EXPECT_EQ(power_heuristic(1.0f, infinity()), 0.0f);
    EXPECT_EQ(power_heuristic(1e30f, 1e30f), 0.5f) << "no overflow";
}

} // namespace
} // namespace snell::test
