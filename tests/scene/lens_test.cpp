// Lenses against textbook optics: ray transfer matrices, Snell's law, the thin lens, cos^4.
#include "snell/core/error.h"
#include "snell/scene/lens.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace snell {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

LensRay make_lens_ray(vec3 origin, vec3 to)
{
    LensRay ray;
    ray.origin = origin;
    ray.direction = normalize(to - origin);
    ray.weight = 1.0f;
    return ray;
}

// A biconvex lens of 100 mm, so thin that the thin lens's equation holds, with a stop in front.
LensPrescription thin_lens(float diameter = 10.0f)
{
    return {"thin", {{0.0f, 0.001f, 1.0f, diameter}, {100.0f, 0.01f, 1.5f, 40.0f}, {-100.0f, 100.0f, 1.0f, 40.0f}}};
}

TEST(Lens, PatentsHaveTheirFocalLengths)
{
    const Cardinal gauss = cardinal(*find_lens("double-gauss"));
    EXPECT_NEAR(gauss.focal_length, 50.36, 0.05);
    EXPECT_NEAR(gauss.back_focus, 36.11, 0.02); // where the prescription puts the film
    EXPECT_NEAR(gauss.f_number(), 2.0, 0.1);
    const Cardinal fisheye = cardinal(*find_lens("fisheye"));
    EXPECT_NEAR(fisheye.focal_length, 15.0, 0.05);
    EXPECT_NEAR(fisheye.f_number(), 4.0, 0.3);
    EXPECT_EQ(find_lens("no such lens"), nullptr);
}

TEST(Lens, ThinLensLimit)
{
    const Cardinal c = cardinal(thin_lens());
    EXPECT_NEAR(c.focal_length, 100.0, 0.01); // the lensmaker's equation
    for (const double s : {150.0, 200.0, 300.0, 1000.0, 1e5})
        EXPECT_NEAR(1 / focused_film_distance(thin_lens(), s) + 1 / s, 1 / 100.0, 2e-6) << s;
    EXPECT_NEAR(focused_film_distance(thin_lens(), infinite), 100.0, 0.01);
    EXPECT_THROW(focused_film_distance(thin_lens(), 50.0), Error); // a virtual picture
    EXPECT_THROW(focused_film_distance(thin_lens(), -1.0), Error);
}

TEST(Lens, TracedFocalLengthIsTheParaxialOne)
{
    for (const LensPrescription& lens : known_lenses()) {
        SCOPED_TRACE(lens.name);
        const Cardinal c = cardinal(lens);
        const FocusedLens focused = focus_lens(lens, infinite, 30.0);
        const LensSystem system = focused.view();
        // Parallel light, a little off the axis, crosses the axis at the film, under the slope of the focal length.
        const float h = 0.02f * static_cast<float>(c.focal_length);
        const LensRay ray = trace_lens_to_film(system, make_lens_ray({h, 0, 200}, {h, 0, 0}));
        ASSERT_GT(ray.weight, 0.0f);
        const float slope = ray.direction.x / ray.direction.z; // z < 0, x < 0
        EXPECT_NEAR(h / slope, c.focal_length, 0.01 * c.focal_length);
        EXPECT_NEAR(ray.origin.x - slope * ray.origin.z, 0.0f, 0.01f * h);
    }
}

TEST(Lens, RaysMeetInTheFocusedPoint)
{
    const FocusedLens focused = focus_lens(*find_lens("double-gauss"), 1000.0, 43.2, 6.0);
    const LensSystem system = focused.view();
    const vec2 film(2.0f, 1.0f);
    std::mt19937 random(1);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    const float z = system.entrance_z + 1000.0f;
    std::vector<vec2> hits;
    for (int i = 0; i < 2000; ++i) {
        const LensRay ray = sample_lens(system, film, {unit(random), unit(random)});
        if (ray.weight == 0.0f) continue;
        const vec3 p = ray.origin + (z - ray.origin.z) / ray.direction.z * ray.direction;
        hits.emplace_back(p.x, p.y);
    }
    ASSERT_GT(hits.size(), 500u);
    vec2 mean(0.0f);
    for (const vec2 p : hits) mean += p / static_cast<float>(hits.size());
    double spread = 0;
    for (const vec2 p : hits) spread += std::pow(length(p - mean), 2) / static_cast<double>(hits.size());
    // The magnification is about film distance over object distance; the spot a small part of the blur elsewhere.
    EXPECT_LT(mean.x, 0.0f); // upside down
    EXPECT_NEAR(mean.x / mean.y, 2.0f, 0.02f);
    EXPECT_LT(std::sqrt(spread), 0.15); // 0.008 mm on the film
}

TEST(Lens, SnellsLawAtEachSurface)
{
    std::mt19937 random(7);
    std::uniform_real_distribution<float> range(-1.0f, 1.0f);
    int crossed = 0, reflected = 0;
    for (int i = 0; i < 20000; ++i) {
        const float radius = (range(random) > 0 ? 1.0f : -1.0f) * (15.0f + 20.0f * std::abs(range(random)));
        const LensInterface face{20.0f, radius, 1.0f, 10.0f};
        const float from = 1.0f + 0.8f * std::abs(range(random)), to = 1.0f + 0.8f * std::abs(range(random));
        const bool to_scene = range(random) > 0;
        const LensRay ray = make_lens_ray({9 * range(random), 9 * range(random), to_scene ? 0.0f : 40.0f},
                                          {9 * range(random), 9 * range(random), 20.0f});
        const LensRay onward = cross_lens_interface(ray, face, from, to);
        if (onward.weight == 0.0f) {
            ++reflected;
            continue;
        }
        ++crossed;
        const vec3 center(0.0f, 0.0f, 20.0f - radius);
        EXPECT_NEAR(length(onward.origin - center), std::abs(radius), 1e-4f * std::abs(radius));
        EXPECT_GT((onward.origin.z - center.z) * radius, 0.0f); // the half that is glass
        const vec3 n = normalize(onward.origin - center);
        // n x d times the index stays: both the angle and the plane of incidence
        EXPECT_LT(length(from * cross(n, ray.direction) - to * cross(n, onward.direction)), 2e-5f);
        EXPECT_GT(dot(n, ray.direction) * dot(n, onward.direction), 0.0f);
        EXPECT_NEAR(length(onward.direction), 1.0f, 1e-5f);
    }
    EXPECT_GT(crossed, 10000);
    EXPECT_GT(reflected, 100);
}

// Both ways through the lens are the same way.
TEST(Lens, LightIsReversible)
{
    for (const LensPrescription& lens : known_lenses()) {
        SCOPED_TRACE(lens.name);
        const FocusedLens focused = focus_lens(lens, 3000.0, 30.0);
        const LensSystem system = focused.view();
        std::mt19937 random(3);
        std::uniform_real_distribution<float> unit(0.0f, 1.0f);
        int passed = 0;
        for (int i = 0; i < 3000; ++i) {
            const vec2 film(30.0f * unit(random) - 15.0f, 20.0f * unit(random) - 10.0f);
            const LensRay out = sample_lens(system, film, {unit(random), unit(random)});
            if (out.weight == 0.0f) continue;
            LensRay back = out;
            back.origin = out.origin + 10.0f * out.direction;
            back.direction = -out.direction;
            back = trace_lens_to_film(system, back);
            if (back.weight == 0.0f) continue; // at a rim
            ++passed;
            const vec3 at = back.origin - back.origin.z / back.direction.z * back.direction;
            EXPECT_NEAR(at.x, film.x, 2e-3f);
            EXPECT_NEAR(at.y, film.y, 2e-3f);
        }
        EXPECT_GT(passed, 500);
    }
}

double mean_weight(const LensSystem& system, vec2 film, int side = 200)
{
    double sum = 0;
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x)
            sum += static_cast<double>(sample_lens(system, film,
                                                   {(static_cast<float>(x) + 0.5f) / static_cast<float>(side),
                                                    (static_cast<float>(y) + 0.5f) / static_cast<float>(side)})
                                           .weight);
    return sum / (side * side);
}

// A constant environment is 1 in the middle, cos^4 beside it while only the stop limits the light, and less where the
// rims of other glasses do.
TEST(Lens, ConstantEnvironmentShowsTheVignetting)
{
    const FocusedLens thin = focus_lens(thin_lens(), infinite, 60.0);
    EXPECT_NEAR(mean_weight(thin.view(), {0, 0}), 1.0, 0.01);
    for (const float r : {5.0f, 15.0f, 25.0f}) {
        const double cos4 = std::pow(std::cos(std::atan(static_cast<double>(r) / 100.0)), 4);
        EXPECT_NEAR(mean_weight(thin.view(), {r, 0}), cos4, 0.015 * cos4) << r;
        EXPECT_NEAR(mean_weight(thin.view(), {-0.6f * r, 0.8f * r}), cos4, 0.015 * cos4) << r; // round
    }
    const FocusedLens gauss = focus_lens(*find_lens("double-gauss"), infinite, 43.2);
    EXPECT_NEAR(mean_weight(gauss.view(), {0, 0}), 1.0, 0.01);
    double before = 1.01;
    for (const float r : {5.0f, 10.0f, 15.0f, 20.0f}) {
        const double weight = mean_weight(gauss.view(), {r, 0});
        EXPECT_LT(weight, before);
        before = weight;
    }
    EXPECT_LT(before, std::pow(std::cos(std::atan(20.0 / 50.0)), 4)); // vignetting on top
    EXPECT_GT(before, 0.05);
}

// No light is lost outside the bounds: a grid over the whole rear element finds none.
TEST(Lens, PupilBoundsHoldAllLight)
{
    for (const LensPrescription& lens : known_lenses()) {
        SCOPED_TRACE(lens.name);
        const FocusedLens focused = focus_lens(lens, 2000.0, 30.0);
        const LensSystem system = focused.view();
        const float half = 0.6f * lens.surfaces.back().diameter;
        std::mt19937 random(5);
        std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
        int passed = 0, outside = 0;
        for (int i = 0; i < 200000; ++i) {
            const float r = 15.0f * std::abs(unit(random));
            const vec2 at(half * unit(random), half * unit(random));
            if (trace_lens_to_scene(system, make_lens_ray({r, 0, 0}, {at.x, at.y, system.rear_z})).weight == 0.0f)
                continue;
            ++passed;
            const uint ring = min(static_cast<uint>(r / 15.0f * 64.0f), 63u);
            const vec4 box = lens_pupil(system, ring);
            outside += at.x < box.x || at.x > box.z || at.y < box.y || at.y > box.w;
        }
        EXPECT_GT(passed, 5000);
        EXPECT_EQ(outside, 0);
    }
}

TEST(Lens, FilmRadiusInvertsTheChiefRay)
{
    for (const LensPrescription& lens : known_lenses()) {
        SCOPED_TRACE(lens.name);
        const FocusedLens focused = focus_lens(lens, 2000.0, 28.0);
        const LensSystem system = focused.view();
        int found = 0;
        float worst = 0.0f;
        for (int i = 0; i <= 100; ++i) {
            const float r = 0.13f * static_cast<float>(i);
            const LensRay ray = lens_chief_ray(system, r);
            if (ray.weight == 0.0f) continue;
            ++found;
            for (const float t : {300.0f, 2000.0f, 50000.0f}) {
                const vec3 p = ray.origin + t * ray.direction;
                const float back = lens_film_radius(system, std::max(-p.x, 0.0f), p.z);
                worst = std::max(worst, std::abs(back - r));
            }
        }
        EXPECT_GT(found, 80);
        EXPECT_LT(worst, 2e-5f * 14.0f); // of a film of 1000 pixels across the diagonal: 0.01 pixel
        RecordProperty(lens.name, std::to_string(worst));
        EXPECT_EQ(lens_film_radius(system, 1e6f, -1e6f), -1.0f); // behind
    }
}

TEST(Lens, ASmallerStopLetsLessThroughAndNothingElseChanges)
{
    const LensPrescription& lens = *find_lens("double-gauss");
    const LensSystem open = focus_lens(lens, 2000.0, 43.2).system;
    const LensSystem closed = focus_lens(lens, 2000.0, 43.2, 4.0).system;
    EXPECT_EQ(open.rear_z, closed.rear_z);
    EXPECT_GT(closed.gain, 10.0f * open.gain); // (17.1 / 4)^2 = 18 times less light
    EXPECT_THROW(focus_lens(lens, 5.0, 43.2), Error);
}

} // namespace
} // namespace snell
