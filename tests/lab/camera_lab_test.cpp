// What the camera laboratory says of cameras with a known answer.
#include "snell/lab/camera_lab.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace snell {
namespace {

Camera pinhole(float tangent, float width, float height)
{
    return make_pinhole({1, 2, 3}, {-2, 1, -4}, {0, 1, 0}, tangent, width, height);
}

TEST(CameraLab, DistortionCurveOfAPinhole)
{
    const std::vector<CurvePoint> curve = distortion_curve(pinhole(1.0f, 640, 480), 11);
    ASSERT_EQ(curve.size(), 11u);
    EXPECT_NEAR(curve.back().radius, 400.0f, 0.1f); // half the diagonal
    for (const CurvePoint& point : curve) {
        ASSERT_TRUE(point.angle);
        EXPECT_NEAR(std::tan(*point.angle * 3.14159265f / 180.0f), point.radius / 240.0f, 1e-3f); // R = f tan(theta)
    }
}

TEST(CameraLab, FieldOfViewOfAPinhole)
{
    const FieldOfView fov = field_of_view(pinhole(0.75f, 640, 480));
    const auto angle = [](double tangent) { return static_cast<float>(2 * std::atan(tangent) * 180 / 3.14159265); };
    EXPECT_NEAR(fov.vertical, angle(0.75), 1e-2f);
    EXPECT_NEAR(fov.horizontal, angle(1.0), 1e-2f);
    EXPECT_NEAR(fov.diagonal, angle(1.25), 1e-2f);
}

TEST(CameraLab, RoundTripOfPinholes)
{
    for (const float tangent : {0.05f, 0.5f, 2.0f, 5.0f}) {
        const RoundTrip trip = round_trip(pinhole(tangent, 1920, 1080), 24, 3.0f);
        EXPECT_EQ(trip.points, 24u * 24u * 3u);
        EXPECT_EQ(trip.lost, 0u);
        EXPECT_EQ(trip.unseeing, 0u);
        EXPECT_GT(trip.worst, 0.0f);
        EXPECT_LE(trip.mean, trip.worst);
        EXPECT_LT(trip.worst, tangent < 0.1f ? 1e-2f : 1e-3f) << tangent; // the narrower, the more pixels a radian has
    }
}

TEST(CameraLab, VignettingOfLenses)
{
    const double infinite = std::numeric_limits<double>::infinity();
    const FocusedLens focused = focus_lens(*find_lens("double-gauss"), infinite, 43.2);
    const std::vector<VignettingPoint> curve = vignetting(focused.view(), 10);
    ASSERT_EQ(curve.size(), 10u);
    EXPECT_NEAR(curve.front().light, 1.0f, 0.02f);
    EXPECT_EQ(curve.front().cos4, 1.0f);
    EXPECT_NEAR(curve.front().angle.value(), 0.0f, 1e-3f);
    EXPECT_FLOAT_EQ(curve.back().radius, 21.6f);
    for (std::size_t i = 1; i < curve.size(); ++i) EXPECT_LT(curve[i].light, curve[i - 1].light + 0.005f);
    // Half of 35 mm film under 50 mm: an angle of 23 degrees in the corner.
    for (const VignettingPoint& point : curve) {
        if (!point.angle) continue;
        EXPECT_NEAR(std::tan(*point.angle / 57.29578f), point.radius / 50.36f, 0.03f);
    }

    const FocusedLens wide = focus_lens(*find_lens("fisheye"), infinite, 40.0);
    float widest = 0.0f;
    for (const VignettingPoint& point : vignetting(wide.view(), 80)) {
        if (!point.angle || point.light == 0.0f) continue;
        widest = std::max(widest, *point.angle);
        EXPECT_NEAR(point.radius, 15.0f * *point.angle / 57.29578f, 0.1f * point.radius + 0.1f); // nearly R = f theta
    }
    EXPECT_GT(2.0f * widest, 140.0f); // its designer says 156
    EXPECT_LT(2.0f * widest, 175.0f);
}

} // namespace
} // namespace snell
