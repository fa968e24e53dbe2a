// Every camera model against its formula, and there and back again.
#include "snell/kernel/camera.h"
#include "snell/scene/camera_models.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace snell {
namespace {

constexpr int width = 800, height = 600;
constexpr double degree = 3.14159265358979 / 180;

CameraDesc desc_of(std::string_view name, float fov = 0.0f)
{
    const CameraModelInfo& info = *find_camera_model(name);
    CameraDesc desc{"test", {1, 2, 3}, {-2, 1, -4}, {0, 1, 0}, fov > 0.0f ? fov : info.usual_fov};
    desc.model = usual_model(info.kind);
    return desc;
}

// The worst distance in pixels between a pixel and where the points of its ray are seen, and how many rays there were.
struct Trip
{
    float worst = 0.0f;
    int rays = 0, lost = 0;
};

Trip trip(const Camera& camera)
{
    Trip trip;
    for (int y = 0; y < 61; ++y)
        for (int x = 0; x < 80; ++x)
            for (uint channel = 0; channel < 3; ++channel) {
                const vec2 pixel((static_cast<float>(x) + 0.5f) / 80.0f * width,
                                 (static_cast<float>(y) + 0.5f) / 61.0f * height);
                const Ray ray = camera_ray_through(camera, pixel, vec2(0.0f), channel);
                if (!camera_sees(ray)) continue;
                ++trip.rays;
                const vec3 point = ray.origin + 20.0f * ray.direction;
                const vec3 back = camera_project_eye(camera, point, camera_eye(camera, pixel.x), channel);
                if (!(back.z > 0.0f)) {
                    ++trip.lost;
                    continue;
                }
                trip.worst = std::max(trip.worst, length(vec2(back.x, back.y) - pixel));
            }
    return trip;
}

void expect_trip(const CameraDesc& desc, float most = 1e-3f)
{
    SCOPED_TRACE(std::string(camera_models()[desc.model.kind].name) + " " + std::to_string(desc.fov_degrees));
    ASSERT_EQ(camera_fault(desc), "");
    const Trip t = trip(make_camera(desc, width, height));
    EXPECT_GT(t.rays, 1000);
    EXPECT_EQ(t.lost, 0);
    EXPECT_LT(t.worst, most);
}

TEST(CameraModels, ThereAndBack)
{
    for (const CameraModelInfo& info : camera_models())
        for (const float part : {0.3f, 0.6f, 0.9f}) {
            CameraDesc desc = desc_of(info.name, part * std::min(info.largest_fov, 200.0f));
            // The ways through glass are found by bisection, between pupils that change from ring to ring.
            const float most = info.kind == camera_lens ? 0.02f : 1e-3f;
            expect_trip(desc, most);
            desc.mirrored = true;
            expect_trip(desc, most);
        }
}

TEST(CameraModels, DistortedThereAndBack)
{
    std::mt19937 random(11);
    std::uniform_real_distribution<float> range(-1.0f, 1.0f);
    int kept = 0;
    for (int i = 0; i < 60; ++i) {
        CameraDesc brown = desc_of("brown-conrady", 60.0f), kannala = desc_of("kannala-brandt", 120.0f),
                   hmd = desc_of("hmd", 90.0f);
        const float k[8] = {0.15f * range(random),  0.03f * range(random), 0.002f * range(random),
                            0.002f * range(random), 0.01f * range(random), 0.05f * range(random),
                            0.01f * range(random),  0.002f * range(random)};
        ASSERT_TRUE(set_distortion(brown.model, k));
        const float kb[4] = {0.05f * range(random), 0.01f * range(random), 0.003f * range(random),
                             0.0005f * range(random)};
        ASSERT_TRUE(set_distortion(kannala.model, kb));
        float kh[9];
        for (int c = 0; c < 9; ++c) kh[c] = (c % 3 == 0 ? 0.25f : 0.05f) * std::abs(range(random));
        ASSERT_TRUE(set_distortion(hmd.model, kh));
        for (const CameraDesc& desc : {brown, kannala, hmd})
            if (camera_fault(desc).empty()) ++kept, expect_trip(desc, 2e-3f);
    }
    EXPECT_GT(kept, 120);
}

// R over f of the fisheyes, by their definitions.
TEST(CameraModels, AnglesOfTheFisheyes)
{
    struct Definition
    {
        const char* name;
        double (*radius)(double theta);
    };
    const Definition definitions[] = {
        {"equidistant", [](double t) { return t; }},
        {"equisolid", [](double t) { return 2 * std::sin(t / 2); }},
        {"stereographic", [](double t) { return 2 * std::tan(t / 2); }},
        {"fisheye-orthographic", [](double t) { return std::sin(t); }},
    };
    for (const auto& [name, radius] : definitions) {
        SCOPED_TRACE(name);
        const CameraDesc desc = desc_of(name, 170.0f);
        const ReadyCamera camera = make_camera(desc, width, height);
        const double f = 0.5 * height / radius(85 * degree);
        for (const double angle : {0.0, 1.0, 20.0, 45.0, 70.0, 85.0}) {
            const double r = f * radius(angle * degree);
            const Ray ray = camera_ray(camera, {0.5f * width, 0.5f * height - static_cast<float>(r) * 0.99999f});
            ASSERT_TRUE(camera_sees(ray));
            EXPECT_NEAR(std::acos(std::min(1.0, static_cast<double>(dot(ray.direction, camera.forward)))) / degree,
                        angle, 0.05);
        }
    }
}

// Equisolid: the same solid angle in every pixel.
TEST(CameraModels, EquisolidPixelsHaveOneSolidAngle)
{
    const ReadyCamera camera = make_camera(desc_of("equisolid", 180.0f), width, height);
    const auto solid_angle = [&](float x, float y) {
        const vec3 d = camera_ray(camera, {x, y}).direction;
        return length(
            cross(camera_ray(camera, {x + 4, y}).direction - d, camera_ray(camera, {x, y + 4}).direction - d));
    };
    const float middle = solid_angle(400, 300);
    for (const vec2 at : {vec2(500, 300), vec2(600, 300), vec2(400, 80), vec2(560, 420)})
        EXPECT_NEAR(solid_angle(at.x, at.y) / middle, 1.0f, 0.03f);
}

TEST(CameraModels, OutsideThePictureNothingIsSeen)
{
    const ReadyCamera camera = make_camera(desc_of("fisheye-orthographic", 180.0f), width, height);
    EXPECT_TRUE(camera_sees(camera_ray(camera, {400, 300})));
    EXPECT_FALSE(camera_sees(camera_ray(camera, {5, 5})));
    EXPECT_FALSE(camera_sees(camera_ray(camera, {5, 300})));
}

TEST(CameraModels, OrthographicRaysAreParallel)
{
    const CameraDesc desc = desc_of("orthographic");
    const ReadyCamera camera = make_camera(desc, width, height);
    for (const vec2 at : {vec2(0, 0), vec2(800, 600), vec2(17, 400)})
        EXPECT_EQ(camera_ray(camera, at).direction, camera.forward);
    // As large as what a pinhole shows at the target.
    const float span = length(camera_ray(camera, {400, 0}).origin - camera_ray(camera, {400, 600}).origin);
    EXPECT_NEAR(span,
                2 * std::tan(0.5 * static_cast<double>(desc.fov_degrees) * degree) * length(desc.target - desc.eye),
                1e-3);
}

TEST(CameraModels, EquirectangularPolesAndSeam)
{
    CameraDesc desc = desc_of("equirectangular");
    desc.eye = vec3(0.0f), desc.target = vec3(0, 0, -1);
    const ReadyCamera camera = make_camera(desc, width, height);
    EXPECT_LT(length(camera_ray(camera, {400, 300}).direction - vec3(0, 0, -1)), 1e-6f);
    EXPECT_LT(length(camera_ray(camera, {600, 300}).direction - vec3(1, 0, 0)), 1e-6f);
    EXPECT_LT(length(camera_ray(camera, {123, 0}).direction - vec3(0, 1, 0)), 1e-6f);
    EXPECT_LT(length(camera_ray(camera, {456, 600}).direction - vec3(0, -1, 0)), 1e-6f);
    EXPECT_LT(length(camera_ray(camera, {0, 300}).direction - vec3(0, 0, 1)), 1e-6f);
    EXPECT_LT(length(camera_ray(camera, {800, 300}).direction - vec3(0, 0, 1)), 1e-6f);
}

// Rays of a thin lens meet where its focal plane is, and on the aperture before.
TEST(CameraModels, ThinLens)
{
    CameraDesc desc = desc_of("pinhole", 50.0f);
    desc.model.lens_radius = 0.2f, desc.model.focus_distance = 3.0f;
    const ReadyCamera camera = make_camera(desc, width, height);
    const vec2 pixel(700, 123);
    const Ray center = camera_ray_through(camera, pixel, {0, 0}, 1);
    const vec3 sharp = center.origin + 3.0f / dot(center.direction, camera.forward) * center.direction;
    for (const vec2 lens : {vec2(1, 0), vec2(-0.5f, 0.5f), vec2(0, -1)}) {
        const Ray ray = camera_ray_through(camera, pixel, lens, 1);
        EXPECT_NEAR(length(ray.origin - camera.origin), 0.2f * length(lens), 1e-6f);
        EXPECT_NEAR(dot(ray.origin - camera.origin, camera.forward), 0.0f, 1e-6f);
        const vec3 at = ray.origin + 3.0f / dot(ray.direction, camera.forward) * ray.direction;
        EXPECT_LT(length(at - sharp), 2e-6f * length(sharp - camera.origin) + 1e-6f);
    }
}

// The aperture is covered evenly: chi-square of as many cells as have equal areas.
TEST(CameraModels, ApertureIsUniform)
{
    std::mt19937 random(2);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    for (const uint blades : {3u, 5u, 6u, 9u}) {
        const float turn = 0.1f;
        const double apothem = std::cos(3.14159265358979 / blades);
        std::vector<int> cells(blades * 4);
        constexpr int count = 40000;
        for (int i = 0; i < count; ++i) {
            const vec2 p = sample_aperture(blades, turn, {unit(random), unit(random)});
            ASSERT_LE(length(p), 1.00001f);
            double angle =
                std::atan2(static_cast<double>(p.y), static_cast<double>(p.x)) / (2 * 3.14159265358979) - 0.1;
            angle -= std::floor(angle);
            const double in_piece = (angle * blades - std::floor(angle * blades) - 0.5) / blades * 2 * 3.14159265358979;
            const double depth = static_cast<double>(length(p)) * std::cos(in_piece) / apothem; // 1 on an edge
            ASSERT_LE(depth, 1.0001);
            const auto ring = std::min<std::size_t>(3, static_cast<std::size_t>(depth * depth * 4));
            const auto piece = std::min<std::size_t>(blades - 1, static_cast<std::size_t>(angle * blades));
            ++cells[piece * 4 + ring];
        }
        const double expected = static_cast<double>(count) / static_cast<double>(cells.size());
        double chi2 = 0;
        for (const int n : cells) chi2 += (n - expected) * (n - expected) / expected;
        const double freedom = static_cast<double>(cells.size()) - 1;
        EXPECT_LT(chi2, freedom + 4 * std::sqrt(2 * freedom)) << blades;
    }
}

// OpenCV's documented formulas, in double, with its fixed-point iteration for the way back.
TEST(CameraModels, BrownConradyIsOpenCVs)
{
    const double k[8] = {-0.21, 0.06, 0.0007, -0.0011, -0.009, 0.02, -0.005, 0.001}; // k1 k2 p1 p2 k3 k4 k5 k6
    CameraDesc desc = desc_of("brown-conrady");
    desc.eye = vec3(0.0f), desc.target = vec3(0, 0, -1);
    float floats[8];
    std::copy(k, k + 8, floats);
    ASSERT_TRUE(set_distortion(desc.model, floats));
    desc.model.calibrated_width = width, desc.model.calibrated_height = height;
    desc.model.focal = vec2(640, 650), desc.model.center = vec2(410, 290);
    ASSERT_EQ(camera_fault(desc), "");
    const ReadyCamera camera = make_camera(desc, width, height);
    const auto factors = [&](double x, double y, double& radial, double& dx, double& dy) {
        const double q = x * x + y * y;
        radial = (1 + q * (k[0] + q * (k[1] + q * k[4]))) / (1 + q * (k[5] + q * (k[6] + q * k[7])));
        dx = 2 * k[2] * x * y + k[3] * (q + 2 * x * x);
        dy = k[2] * (q + 2 * y * y) + 2 * k[3] * x * y;
    };
    for (double y = -0.35; y <= 0.36; y += 0.07)
        for (double x = -0.5; x <= 0.51; x += 0.1) {
            double radial = 0, dx = 0, dy = 0;
            factors(x, y, radial, dx, dy);
            const double u = 640 * (x * radial + dx) + 410, v = 650 * (y * radial + dy) + 290;
            // OpenCV's y points down and its z forward.
            const vec3 at = camera_project(camera, 5.0f * vec3(x, -y, -1));
            EXPECT_NEAR(at.x, u, 1e-3);
            EXPECT_NEAR(at.y, v, 1e-3);
            double a = (u - 410) / 640, b = (v - 290) / 650;
            const double a0 = a, b0 = b;
            for (int i = 0; i < 100; ++i) {
                factors(a, b, radial, dx, dy);
                a = (a0 - dx) / radial, b = (b0 - dy) / radial;
            }
            const vec3 d = camera_ray(camera, vec2(u, v)).direction;
            EXPECT_NEAR(d.x / -d.z, a, 3e-6);
            EXPECT_NEAR(-d.y / -d.z, b, 3e-6);
        }
}

TEST(CameraModels, KannalaBrandtIsOpenCVs)
{
    const double k[4] = {-0.02, 0.006, -0.003, 0.0004};
    CameraDesc desc = desc_of("kannala-brandt");
    desc.eye = vec3(0.0f), desc.target = vec3(0, 0, -1);
    float floats[4];
    std::copy(k, k + 4, floats);
    ASSERT_TRUE(set_distortion(desc.model, floats));
    desc.model.calibrated_width = width, desc.model.calibrated_height = height;
    desc.model.focal = vec2(240, 245), desc.model.center = vec2(396, 310);
    ASSERT_EQ(camera_fault(desc), "");
    const ReadyCamera camera = make_camera(desc, width, height);
    for (double turn = 0; turn < 6.2; turn += 0.7)
        for (const double theta : {0.01, 0.3, 0.8, 1.2, 1.5}) {
            const double t2 = theta * theta;
            const double d = theta * (1 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3]))));
            const double u = 240 * d * std::cos(turn) + 396, v = 245 * d * std::sin(turn) + 310;
            const vec3 direction(std::sin(theta) * std::cos(turn), -std::sin(theta) * std::sin(turn), -std::cos(theta));
            const vec3 at = camera_project(camera, 7.0f * direction);
            EXPECT_NEAR(at.x, u, 1e-3);
            EXPECT_NEAR(at.y, v, 1e-3);
            EXPECT_LT(length(camera_ray(camera, vec2(u, v)).direction - direction), 3e-6f);
        }
}

// Both eyes look ahead from places as far apart as they are; red is drawn elsewhere than green.
TEST(CameraModels, HeadMountedDisplay)
{
    CameraDesc desc = desc_of("hmd");
    desc.eye = vec3(0.0f), desc.target = vec3(0, 0, -1);
    const float k[9] = {0.20f, 0.02f, 0, 0.22f, 0.03f, 0, 0.25f, 0.04f, 0};
    ASSERT_TRUE(set_distortion(desc.model, k));
    const ReadyCamera camera = make_camera(desc, width, height);
    const Ray left = camera_ray(camera, {200, 300}), right = camera_ray(camera, {600, 300});
    EXPECT_NEAR(right.origin.x - left.origin.x, 0.064f, 1e-6f);
    EXPECT_LT(length(left.direction - right.direction), 1e-6f);
    EXPECT_TRUE(camera_disperses(camera));
    // The lens bends what is drawn at r outwards to tan(theta) = r (1 + k1 r^2 + k2 r^4).
    const double r = 100.0 / static_cast<double>(camera.focal.x);
    for (uint channel = 0; channel < 3; ++channel) {
        const vec3 d = camera_ray_through(camera, {300, 300}, {0, 0}, channel).direction;
        const double q = r * r, k1 = static_cast<double>(k[3 * channel]), k2 = static_cast<double>(k[3 * channel + 1]);
        EXPECT_NEAR(d.x / -d.z, r * (1 + q * (k1 + q * k2)), 1e-5);
    }
}

TEST(CameraModels, FaultsAreFound)
{
    const auto faulty = [](const CameraDesc& desc) { return !camera_fault(desc).empty(); };
    for (const CameraModelInfo& info : camera_models()) {
        EXPECT_FALSE(faulty(desc_of(info.name))) << info.name;
        EXPECT_TRUE(faulty(desc_of(info.name, 361.0f))) << info.name;
        CameraDesc without = desc_of(info.name);
        without.fov_degrees = std::nanf("");
        EXPECT_TRUE(faulty(without)) << info.name;
    }
    CameraDesc desc = desc_of("brown-conrady");
    const float folded[4] = {-3.0f, 0, 0, 0};
    ASSERT_TRUE(set_distortion(desc.model, folded));
    EXPECT_TRUE(faulty(desc));
    const float six[6] = {};
    EXPECT_FALSE(set_distortion(desc.model, six));
    desc = desc_of("pinhole");
    desc.model.lens_radius = -1.0f;
    EXPECT_TRUE(faulty(desc));
    desc = desc_of("lens");
    desc.model.focus_distance = 0.01f; // inside it
    EXPECT_NE(camera_fault(desc).find("focus farther away"), std::string::npos) << camera_fault(desc);
    desc = desc_of("lens");
    desc.model.lens.surfaces.clear();
    EXPECT_TRUE(faulty(desc));
    desc = desc_of("lens");
    desc.model.film_diagonal = 0.0f;
    EXPECT_TRUE(faulty(desc));
    EXPECT_EQ(find_camera_model("no such model"), nullptr);
    EXPECT_EQ(find_camera_model("rectilinear")->kind, camera_pinhole);
}

} // namespace
} // namespace snell
