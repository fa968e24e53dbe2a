// Environments from pictures: directions against the density, the maps from the square to the sphere and back.
#include "snell/kernel/environment.h"
#include "snell/scene/packed.h"
#include "tests/stat/chi_square.h"

#include <gtest/gtest.h>

namespace snell::test {
namespace {

constexpr double pi_d = std::numbers::pi;

Image noise_image(uint width, uint height, std::uint64_t stream)
{
    Draw draw(stream);
    Image image;
    image.width = width, image.height = height;
    image.format = texels_rgba32f;
    for (std::size_t i = 0; i < std::size_t{width} * height; ++i) {
        // smooth light, dark parts, and a few spots that outshine all of it
        const float u = draw.next();
        const float value = u < 0.2f ? 0.0f : u > 0.97f ? 200.0f * draw.next() : draw.next();
        for (int c = 0; c < 3; ++c) image.floats.push_back(value * draw.between(0.5f, 1.0f));
        image.floats.push_back(1.0f);
    }
    return image;
}

PackedScene packed_environment(uint width, uint height, uint mapping, const Transform& to_world, std::uint64_t stream)
{
    Scene scene;
    scene.environment.image = add(scene, noise_image(width, height, stream));
    scene.environment.mapping = mapping;
    scene.environment.radiance = vec3(1.0f, 0.7f, 1.2f);
    scene.environment.to_world = to_world;
    validate(scene);
    return pack(scene);
}

struct Case
{
    std::string name;
    uint width, height, mapping;
    Transform to_world;
};

std::vector<Case> cases()
{
    const Transform turned = rotation(vec3(1.0f, -2.0f, 0.5f), 50.0f);
    const Transform mirrored = compose(turned, scaling(vec3(1.0f, 1.0f, -1.0f)));
    return {{"latitude-longitude", 12, 6, environment_equirectangular, identity_transform()},
            {"latitude-longitude, turned", 7, 5, environment_equirectangular, turned},
            {"latitude-longitude, mirrored", 10, 5, environment_equirectangular, mirrored},
            {"octahedral", 8, 8, environment_octahedral, identity_transform()},
            {"octahedral, turned", 5, 5, environment_octahedral, turned},
            {"octahedral, mirrored", 6, 6, environment_octahedral, mirrored},
            {"one texel", 1, 1, environment_octahedral, turned}};
}

// Where directions fall on the picture, in squares of a third of a cell: within a cell the density per unit of the
// picture's area is constant, so it can be integrated exactly. (That picture and sphere belong together is for the
// tests of the maps below.)
TEST(Environment, DirectionsFollowTheDensity)
{
    std::uint64_t stream = 900;
    const int count = long_tests() ? 3'000'000 : 300'000;
    for (const Case& c : cases()) {
        SCOPED_TRACE(c.name);
        const PackedScene packed = packed_environment(c.width, c.height, c.mapping, c.to_world, stream++);
        const SceneView view = packed.view();
        const Environment& e = packed.environment;
        const uint columns = 3 * e.columns, rows = 3 * e.rows;
        std::vector<double> expected, observed(columns * rows + 1, 0.0);
        double total = 0;
        for (uint y = 0; y < rows; ++y)
            for (uint x = 0; x < columns; ++x) {
                const vec2 p((static_cast<float>(x) + 0.5f) / static_cast<float>(columns),
                             (static_cast<float>(y) + 0.5f) / static_cast<float>(rows));
                const float density = pdf_environment(view, environment_direction(e, p));
                expected.push_back(double{density} * double{environment_solid_angle(e, p)} / (columns * rows));
                total += expected.back();
            }
        EXPECT_NEAR(total, 1.0, 1e-5) << "the density does not integrate to 1";
        expected.push_back(0); // no sample
        for (double& value : expected) value *= count;
        Draw draw(stream++);
        for (int i = 0; i < count; ++i) {
            const LightSample s = sample_environment(view, draw.next2());
            const vec2 p = environment_point(e, s.direction);
            const uint x = std::min(static_cast<uint>(p.x * static_cast<float>(columns)), columns - 1);
            const uint y = std::min(static_cast<uint>(p.y * static_cast<float>(rows)), rows - 1);
            observed[s.pdf > 0.0f ? y * columns + x : columns * rows] += 1;
        }
        // rounding may carry one in a million over the edge of a cell that cannot be drawn
        for (std::size_t i = 0; i < observed.size(); ++i) {
            if (expected[i] == 0) {
                EXPECT_LE(observed[i], 3);
                observed[i] = 0;
            }
        }
        const ChiSquare test = chi_square(observed, expected);
        EXPECT_GE(test.p, significance())
            << "chi-square " << test.statistic << " with " << test.degrees << " degrees of freedom";
        EXPECT_GE(test.degrees, 8);
    }
}

TEST(Environment, SamplesCarryTheDensityAndTheRadianceOfTheirDirection)
{
    std::uint64_t stream = 930;
    for (const Case& c : cases()) {
        SCOPED_TRACE(c.name);
        const PackedScene packed = packed_environment(c.width, c.height, c.mapping, c.to_world, stream++);
        const SceneView view = packed.view();
        Draw draw(stream++);
        double flux = 0, by_sampling = 0;
        constexpr int count = 200'000;
        for (int i = 0; i < count; ++i) {
            const LightSample s = sample_environment(view, draw.next2());
            ASSERT_NEAR(double{length(s.direction)}, 1.0, 1e-5);
            EXPECT_EQ(s.is_infinite, 1u);
            ASSERT_EQ(s.pdf, pdf_environment(view, s.direction));
            ASSERT_EQ(s.radiance, environment_radiance(view, s.direction));
            if (s.pdf > 0.0f) by_sampling += double{s.radiance.y} / double{s.pdf} / count;
            flux += double{environment_radiance(view, draw.direction()).y} * 4 * pi_d / count;
        }
        EXPECT_NEAR(by_sampling, flux, 0.04 * flux); // over the whole sphere; the uniform estimate is the noisy one
    }
}

TEST(Environment, WhereThereIsLightThereIsDensity)
{
    std::uint64_t stream = 960;
    for (const Case& c : cases()) {
        const PackedScene packed = packed_environment(c.width, c.height, c.mapping, c.to_world, stream++);
        const SceneView view = packed.view();
        Draw draw(stream++);
        for (int i = 0; i < 50'000; ++i) {
            const vec3 w = draw.direction();
            if (is_black(environment_radiance(view, w))) continue;
            ASSERT_GT(pdf_environment(view, w), 0.0f) << c.name;
        }
    }
}

TEST(Environment, DirectionsAndPointsAreInverse)
{
    for (const Case& c : cases()) {
        SCOPED_TRACE(c.name);
        const PackedScene packed = packed_environment(c.width, c.height, c.mapping, c.to_world, 1);
        const Environment& e = packed.environment;
        Draw draw(980);
        for (int i = 0; i < 100'000; ++i) {
            const vec3 w = draw.direction();
            const vec2 p = environment_point(e, w);
            ASSERT_TRUE(p.x >= 0.0f && p.x <= 1.0f && p.y >= 0.0f && p.y <= 1.0f) << p.x << " " << p.y;
            ASSERT_LT(length(environment_direction(e, p) - w), 4e-6f);
            const vec2 q = draw.next2();
            const vec3 v = environment_direction(e, q);
            ASSERT_NEAR(length(v), 1.0f, 2e-6f);
            ASSERT_LT(length(environment_direction(e, environment_point(e, v)) - v), 4e-6f);
            const bool is_pole = environment_solid_angle(e, q) < 0.05f; // there all longitudes are one
            if (is_pole) continue;
            ASSERT_LT(length(environment_point(e, v) - q), 3e-5f) << q.x << " " << q.y;
        }
    }
}

TEST(Environment, KnownDirections)
{
    Environment e = {};
    e.row_x = vec3(1, 0, 0), e.row_y = vec3(0, 1, 0), e.row_z = vec3(0, 0, 1);
    const auto expect_at = [&](vec2 p, vec3 w) {
        EXPECT_LT(length(environment_direction(e, p) - w), 1e-6f) << p.x << " " << p.y;
    };
    e.mapping = environment_equirectangular;
    expect_at(vec2(0.5f, 0.5f), vec3(0, 0, -1));
    expect_at(vec2(0.75f, 0.5f), vec3(1, 0, 0));
    expect_at(vec2(0.25f, 0.5f), vec3(-1, 0, 0));
    expect_at(vec2(0.0f, 0.5f), vec3(0, 0, 1));
    expect_at(vec2(0.3f, 0.0f), vec3(0, 1, 0));
    expect_at(vec2(0.3f, 1.0f), vec3(0, -1, 0));
    e.mapping = environment_octahedral;
    expect_at(vec2(0.5f, 0.5f), vec3(0, 0, 1));
    expect_at(vec2(1.0f, 0.5f), vec3(1, 0, 0));
    expect_at(vec2(0.0f, 0.5f), vec3(-1, 0, 0));
    expect_at(vec2(0.5f, 1.0f), vec3(0, 1, 0));
    expect_at(vec2(0.5f, 0.0f), vec3(0, -1, 0));
    for (const vec2 corner : {vec2(0, 0), vec2(1, 0), vec2(0, 1), vec2(1, 1)}) expect_at(corner, vec3(0, 0, -1));
}

// The solid angle of a small square around a point, by the cross product of the map's derivatives.
TEST(Environment, SolidAnglesAreThoseOfTheMaps)
{
    for (const uint mapping : {environment_equirectangular, environment_octahedral}) {
        Environment e = {};
        e.row_x = vec3(1, 0, 0), e.row_y = vec3(0, 1, 0), e.row_z = vec3(0, 0, 1);
        e.mapping = mapping;
        Draw draw(990);
        for (int i = 0; i < 20'000; ++i) {
            constexpr float h = 2e-3f;
            const vec2 p(draw.between(2 * h, 1 - 2 * h), draw.between(2 * h, 1 - 2 * h));
            if (mapping == environment_octahedral) { // not across the folds, nor where differences are too coarse
                const float u = abs(2 * p.x - 1), v = abs(2 * p.y - 1);
                if (abs(u + v - 1) < 4 * h || u < 4 * h || v < 4 * h || u + v < 0.1f || u + v > 1.9f) continue;
            }
            const glm::dvec3 du = glm::dvec3(environment_direction(e, p + vec2(h, 0))) -
                                  glm::dvec3(environment_direction(e, p - vec2(h, 0)));
            const glm::dvec3 dv = glm::dvec3(environment_direction(e, p + vec2(0, h))) -
                                  glm::dvec3(environment_direction(e, p - vec2(0, h)));
            const double by_difference = glm::length(glm::cross(du, dv)) / (4.0 * double{h} * double{h});
            ASSERT_NEAR(by_difference, double{environment_solid_angle(e, p)}, 0.03 + 0.003 * by_difference)
                << mapping << " " << p.x << " " << p.y;
        }
    }
}

TEST(Environment, NoSeamBehind)
{
    const PackedScene packed = packed_environment(4, 2, environment_equirectangular, identity_transform(), 3);
    const SceneView view = packed.view();
    for (float y = -0.9f; y <= 0.9f; y += 0.1f) {
        const float r = std::sqrt(1 - y * y);
        const vec3 left = environment_radiance(view, normalize(vec3(-1e-5f, y, r)));
        const vec3 right = environment_radiance(view, normalize(vec3(1e-5f, y, r)));
        const vec3 middle = environment_radiance(view, vec3(0.0f, y, r));
        EXPECT_LT(length(left - right), 1e-3f * length(left)) << y;
        EXPECT_LT(length(left - middle), 1e-3f * length(left)) << y;
    }
}

TEST(Environment, RandomNumbersAtTheEndsFindCellsWithLight)
{
    for (std::uint64_t stream = 0; stream < 50; ++stream) {
        const PackedScene packed = packed_environment(9, 4, environment_equirectangular, identity_transform(), stream);
        const SceneView view = packed.view();
        const std::vector<float>& cdf = packed.environment_cdf;
        for (const float u : {0.0f, 0x1p-24f, 0.5f, 1.0f - 0x1p-24f}) {
            const uint y = find_cell(view, 0u, view.environment.rows, u);
            EXPECT_GT(cdf[y + 1], cdf[y]);
            const uint row = view.environment.rows + 1 + y * (view.environment.columns + 1);
            const uint x = find_cell(view, row, view.environment.columns, u);
            EXPECT_GT(cdf[row + x + 1], cdf[row + x]);
            const float place = place_in_cell(view, row + x, u);
            EXPECT_TRUE(place >= 0.0f && place < 1.0f);
        }
    }
}

} // namespace
} // namespace snell::test
