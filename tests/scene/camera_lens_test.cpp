// Cameras with lenses: what they do to light from before, in and behind the distance that is sharp.
#include "snell/scene/camera_models.h"

#include <gtest/gtest.h>

#include <cmath>

namespace snell {
namespace {

constexpr int width = 600, height = 400;
constexpr uint side = 48; // samples of a lens, each way

CameraDesc looking_ahead(uint kind, float focus)
{
    CameraDesc desc{"test", {0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 30.0f};
    desc.model = usual_model(kind);
    desc.model.focus_distance = focus;
    return desc;
}

// Where the rays of one point of the picture meet the plane at a distance: their mean, and the root of the mean square
// of the way from it. The rays count by their weights.
struct Spot
{
    vec2 center{0.0f};
    double radius = 0.0, weight = 0.0; // weight: in the mean of all samples
};

Spot spot_of(const Camera& camera, vec2 pixel, float distance)
{
    double sum = 0, x = 0, y = 0, squares = 0;
    for (uint i = 0; i < side * side; ++i) {
        const vec2 u((static_cast<float>(i % side) + 0.5f) / side, (static_cast<float>(i / side) + 0.5f) / side);
        const CameraSample s = sample_camera(camera, pixel, u, camera_green);
        if (!(s.weight > 0.0f)) continue;
        const float t = (distance + s.ray.origin.z) / -s.ray.direction.z;
        const vec3 p = s.ray.origin + t * s.ray.direction;
        const double w = static_cast<double>(s.weight), px = static_cast<double>(p.x), py = static_cast<double>(p.y);
        sum += w, x += w * px, y += w * py, squares += w * (px * px + py * py);
    }
    x /= sum, y /= sum;
    return {vec2(x, y), std::sqrt(std::max(squares / sum - x * x - y * y, 0.0)), sum / (side * side)};
}

// Blur at half and at twice the distance that is sharp, of a disk of that radius: a uniform disk's root mean square is
// its radius over sqrt(2). sharp: what may be left of it in focus.
void expect_disk(const Camera& camera, float focus, double lens_radius, double tolerance, double sharp)
{
    const vec2 middle(0.5f * width, 0.5f * height);
    EXPECT_LT(spot_of(camera, middle, focus).radius, sharp);
    for (const float part : {0.5f, 2.0f}) {
        const double expected = lens_radius * std::abs(1.0 - static_cast<double>(part)) / std::sqrt(2.0);
        EXPECT_NEAR(spot_of(camera, middle, part * focus).radius, expected, tolerance * expected) << part;
    }
}

TEST(CameraLens, ThinLensBlursToADisk)
{
    CameraDesc desc = looking_ahead(camera_pinhole, 3.0f);
    desc.model.lens_radius = 0.05f;
    expect_disk(make_camera(desc, width, height), 3.0f, 0.05, 0.01, 1e-5);
    // A polygon in the disk: the mean square of one of n corners is R^2 / 2 (2 + cos(2 pi / n)) / 3.
    desc.model.blades = 5;
    const double radius = spot_of(make_camera(desc, width, height), {300, 200}, 6.0f).radius;
    EXPECT_NEAR(radius, 0.05 * std::sqrt((2 + std::cos(2 * 3.14159265 / 5)) / 6), 0.0005);
}

// As much light in the middle, and as much depth of field, as the thin lens with its entrance pupil has.
TEST(CameraLens, GlassIsAThinLensInTheMiddle)
{
    constexpr double aberration = 0.02 / 50.36; // 20 micrometres of film, at 50 mm: spherical aberration
    for (const float focus : {0.8f, 3.0f}) {
        SCOPED_TRACE(focus);
        const CameraDesc desc = looking_ahead(camera_lens, focus);
        const ReadyCamera camera = make_camera(desc, width, height);
        expect_disk(camera, focus, 0.001 * cardinal(desc.model.lens).entrance_radius, 0.06,
                    aberration * static_cast<double>(focus));
        EXPECT_NEAR(spot_of(camera, {300, 200}, focus).weight, 1.0, 0.01);
        const CameraDesc thin = looking_ahead(camera_pinhole, focus);
        EXPECT_EQ(spot_of(make_camera(thin, width, height), {300, 200}, focus).weight, 1.0);
    }
    CameraDesc stopped = looking_ahead(camera_lens, 3.0f);
    stopped.model.stop_diameter = 0.25f * stop_diameter(stopped.model.lens); // f/8
    const ReadyCamera camera = make_camera(stopped, width, height);
    expect_disk(camera, 3.0f, 0.00025 * cardinal(stopped.model.lens).entrance_radius, 0.06, 0.1 * aberration * 3.0);
    EXPECT_NEAR(spot_of(camera, {300, 200}, 3.0f).weight, 1.0, 0.02);
}

TEST(CameraLens, CornersAreDarker)
{
    for (const LensPrescription& lens : known_lenses()) {
        SCOPED_TRACE(lens.name);
        CameraDesc desc = looking_ahead(camera_lens, 3.0f);
        desc.model.lens = lens;
        const ReadyCamera camera = make_camera(desc, width, height);
        double before = 1.01;
        for (const float part : {0.0f, 0.2f, 0.4f, 0.6f, 0.75f}) { // the fisheye's picture is a circle, not much larger
            const double light = spot_of(camera, {300 + 300 * part, 200 + 200 * part}, 3.0f).weight;
            EXPECT_LE(light, before) << part;
            before = light;
        }
        EXPECT_GT(before, 0.05);
        EXPECT_LT(before, 0.8);
    }
}

// The picture is upright, and the unit of length scales the lens.
TEST(CameraLens, UprightAndToScale)
{
    CameraDesc desc = looking_ahead(camera_lens, 3.0f);
    ReadyCamera camera = make_camera(desc, width, height);
    const vec3 upper_right = camera_ray(camera, {450, 100}).direction;
    EXPECT_GT(upper_right.x, 0.05f);
    EXPECT_GT(upper_right.y, 0.05f);
    const vec3 seen = camera_project(camera, {0.3f, 0.2f, -3.0f});
    EXPECT_GT(seen.x, 300.0f);
    EXPECT_LT(seen.y, 200.0f);
    // 50.36 mm in focus at 3 m on 24 mm of film: 2 atan(12 / 51.2) = 26.4 degrees.
    const vec3 top = camera_ray(camera, {300, 0}).direction, bottom = camera_ray(camera, {300, 400}).direction;
    EXPECT_NEAR(std::acos(dot(top, bottom)) * 57.29578f, 26.4f, 0.5f);

    desc.model.millimetre = 1.0f, desc.model.focus_distance = 3000.0f;
    camera = make_camera(desc, width, height);
    const Spot spot = spot_of(camera, {300, 200}, 1500.0f);
    EXPECT_NEAR(spot.radius, 0.5 * cardinal(desc.model.lens).entrance_radius / std::sqrt(2.0), 0.3);
}

// Nobody else holds the glass when the scene's description changes: the camera does.
TEST(CameraLens, CamerasKeepTheirGlass)
{
    const ReadyCamera first = make_camera(looking_ahead(camera_lens, 3.0f), width, height);
    const vec3 direction = camera_ray(first, {500, 50}).direction;
    for (int i = 0; i < 20; ++i) make_camera(looking_ahead(camera_lens, 4.0f + static_cast<float>(i)), width, height);
    EXPECT_EQ(camera_ray(first, {500, 50}).direction, direction);
    const ReadyCamera again = make_camera(looking_ahead(camera_lens, 3.0f), width, height);
    EXPECT_EQ(camera_ray(again, {500, 50}).direction, direction);
}

TEST(CameraLens, StereoEyesStandApart)
{
    CameraDesc desc = looking_ahead(camera_pinhole, 0.0f);
    desc.model.eye_distance = 0.08f;
    for (const bool mirrored : {false, true}) {
        desc.mirrored = mirrored;
        const ReadyCamera left = make_camera(stereo_eye(desc, 0), width, height);
        const ReadyCamera right = make_camera(stereo_eye(desc, 1), width, height);
        EXPECT_NEAR(dot(right.origin - left.origin, normalize(left.right)), 0.08f, 1e-6f);
        EXPECT_EQ(left.forward, right.forward);
        // What is near is farther to the right for the left eye.
        EXPECT_GT(camera_project(left, {0, 0, -2}).x, camera_project(right, {0, 0, -2}).x);
    }
}

} // namespace
} // namespace snell
