// Both samplers as random numbers: uniform in every dimension, and independent between dimensions, pixels and seeds.
#include "snell/kernel/path_state.h"
#include "snell/kernel/random.h"
#include "tests/stat/chi_square.h"

#include <gtest/gtest.h>

#include <functional>

namespace snell::test {
namespace {

class Sampler : public testing::TestWithParam<uint>
{
};

INSTANTIATE_TEST_SUITE_P(, Sampler, testing::Values(sampler_independent, sampler_sobol), [](const auto& param_info) {
    return param_info.param == sampler_sobol ? "Sobol" : "Independent";
});

void expect_uniform(std::span<const double> counts, double total)
{
    const std::vector<double> expected(counts.size(), total / static_cast<double>(counts.size()));
    const ChiSquare test = chi_square(counts, expected);
    EXPECT_GE(test.p, significance()) << test.statistic << " / " << test.degrees;
}

// Many pixels, one sample each: the numbers of different pixels are independent, so plain chi-square holds for both.
TEST_P(Sampler, UniformOverPixels)
{
    constexpr uint width = 512, cells = 64;
    for (const uint dimension : {0u, 1u, 2u, 3u, 4u, 5u, 17u, 100u}) {
        for (const uint index : {0u, 1u, 77u}) {
            SCOPED_TRACE(testing::Message() << "dimension " << dimension << ", sample " << index);
            std::vector<double> x(cells, 0.0), y(cells, 0.0), plane(cells * cells, 0.0);
            for (uint pixel = 0; pixel < width * width; ++pixel) {
                const vec2 u = random_2d(make_sample_key(GetParam(), pixel, index, 0), dimension);
                ASSERT_TRUE(u.x >= 0.0f && u.x < 1.0f && u.y >= 0.0f && u.y < 1.0f);
                const uint i = static_cast<uint>(u.x * cells), j = static_cast<uint>(u.y * cells);
                x[i] += 1, y[j] += 1, plane[j * cells + i] += 1;
            }
            expect_uniform(x, width * width);
            expect_uniform(y, width * width);
            expect_uniform(plane, width * width);
        }
    }
}

// One pixel, many samples. Sobol points are more even than chance: there the statistic must be small, not only not
// large.
TEST_P(Sampler, UniformOverSamples)
{
    constexpr uint count = 65536, cells = 32;
    for (const uint pixel : {0u, 1u, 12345u})
        for (const uint dimension : {0u, 2u, 3u, 21u}) {
            std::vector<double> plane(cells * cells, 0.0);
            for (uint i = 0; i < count; ++i) {
                const vec2 u = random_2d(make_sample_key(GetParam(), pixel, i, 5), dimension);
                plane[static_cast<uint>(u.y * cells) * cells + static_cast<uint>(u.x * cells)] += 1;
            }
            expect_uniform(plane, count);
            if (GetParam() == sampler_sobol) {
                for (const double n : plane) ASSERT_EQ(n, count / (cells * cells));
            }
        }
}

using Number = std::function<float(uint)>;

// Joint distribution of two numbers over n draws, on a grid: finds any dependence, not only a linear one.
void expect_independent(uint n, const Number& a, const Number& b)
{
    constexpr uint cells = 16;
    std::vector<double> joint(cells * cells, 0.0);
    for (uint i = 0; i < n; ++i) joint[static_cast<uint>(a(i) * cells) * cells + static_cast<uint>(b(i) * cells)] += 1;
    expect_uniform(joint, n);
}

TEST_P(Sampler, DimensionsAreIndependent)
{
    const uint kind = GetParam();
    constexpr uint n = 1u << 16;
    for (const uint d1 : {0u, 2u, 3u})
        for (const uint d2 : {1u, 4u, 5u, 6u, 10u, 18u}) {
            SCOPED_TRACE(testing::Message() << "dimensions " << d1 << " and " << d2);
            // over pixels
            expect_independent(
                n, [&](uint i) { return random_2d(make_sample_key(kind, i, 3, 0), d1).x; },
                [&](uint i) { return random_2d(make_sample_key(kind, i, 3, 0), d2).x; });
            expect_independent(
                n, [&](uint i) { return random_2d(make_sample_key(kind, i, 3, 0), d1).x; },
                [&](uint i) { return random_2d(make_sample_key(kind, i, 3, 0), d2).y; });
            // over the samples of a pixel: the pairs are shuffled apart
            expect_independent(
                n, [&](uint i) { return random_2d(make_sample_key(kind, 9, i, 0), d1).x; },
                [&](uint i) { return random_2d(make_sample_key(kind, 9, i, 0), d2).x; });
            expect_independent(
                n, [&](uint i) { return random_2d(make_sample_key(kind, 9, i, 0), d1).y; },
                [&](uint i) { return random_2d(make_sample_key(kind, 9, i, 0), d2).y; });
        }
}

TEST_P(Sampler, PixelsAreIndependent)
{
    const uint kind = GetParam();
    constexpr uint n = 1u << 16, width = 256;
    for (const uint step : {1u, 2u, width, width + 1u, 64u * width}) { // neighbours in the picture
        SCOPED_TRACE(testing::Message() << "pixels apart " << step);
        expect_independent(
            n, [&](uint i) { return random_2d(make_sample_key(kind, i, 0, 0), 2).x; },
            [&](uint i) { return random_2d(make_sample_key(kind, i + step, 0, 0), 2).x; });
        // the same two pixels, over their samples
        expect_independent(
            n, [&](uint i) { return random_2d(make_sample_key(kind, 1000, i, 0), 2).x; },
            [&](uint i) { return random_2d(make_sample_key(kind, 1000 + step, i, 0), 2).x; });
    }
}

TEST_P(Sampler, SeedsAreIndependent)
{
    const uint kind = GetParam();
    for (const uint other : {1u, 2u, 1000u})
        expect_independent(
            1u << 16, [&](uint i) { return random_2d(make_sample_key(kind, i, 0, 0), 2).x; },
            [&](uint i) { return random_2d(make_sample_key(kind, i, 0, other), 2).x; });
}

// (Consecutive Sobol points avoid each other: that is their purpose.)
TEST(IndependentSampler, ConsecutiveSamplesAndBothNumbersOfAPair)
{
    const uint kind = sampler_independent;
    expect_independent(
        1u << 16, [&](uint i) { return random_2d(make_sample_key(kind, 7, i, 0), 2).x; },
        [&](uint i) { return random_2d(make_sample_key(kind, 7, i + 1, 0), 2).x; });
    expect_independent(
        1u << 16, [&](uint i) { return random_2d(make_sample_key(kind, 7, i, 0), 2).x; },
        [&](uint i) { return random_2d(make_sample_key(kind, 7, i, 0), 2).y; });
}

// Every dimension of a long path is a pair of its own.
TEST(Dimensions, VerticesDoNotShareDimensions)
{
    std::vector<uint> seen = {0, 1};
    for (uint depth = 0; depth < 50; ++depth)
        for (const uint which : {dimension_bsdf, dimension_lobe, dimension_light, dimension_select})
            seen.push_back(vertex_dimension(depth, which));
    std::sort(seen.begin(), seen.end());
    EXPECT_EQ(std::adjacent_find(seen.begin(), seen.end()), seen.end());
}

// Each bit of the hashes flips each bit of the result half of the time.
TEST(Hash, Avalanche)
{
    constexpr int n = 20'000;
    Draw draw(310);
    std::vector<double> flips(32 * 32, 0.0);
    for (int i = 0; i < n; ++i) {
        const uint x = draw.bits();
        for (uint in = 0; in < 32; ++in) {
            const uint d = hash_uint(x) ^ hash_uint(x ^ (1u << in));
            for (uint out = 0; out < 32; ++out) flips[in * 32 + out] += (d >> out) & 1u;
        }
    }
    for (const double f : flips) EXPECT_NEAR(f / n, 0.5, 0.03);
}

// Sums over many samples of a product of two dimensions: convergence to what independent uniforms give.
TEST_P(Sampler, MomentsOverPixelsAndSamples)
{
    constexpr uint pixels = 4096, samples = 16;
    for (const uint d : {0u, 2u, 5u}) {
        double xx = 0, xy = 0, xz = 0;
        for (uint p = 0; p < pixels; ++p)
            for (uint s = 0; s < samples; ++s) {
                const SampleKey key = make_sample_key(GetParam(), p, s, 42);
                const vec2 u = random_2d(key, d), v = random_2d(key, d + 1);
                xx += double{u.x} * double{u.x};
                xy += double{u.x} * double{u.y};
                xz += double{u.y} * double{v.x};
            }
        constexpr double n = pixels * samples;
        // standard deviations of x^2 and of x y: sqrt(4/45) and sqrt(7)/12
        EXPECT_NEAR(xx / n, 1.0 / 3, 4.5 * 0.298 / std::sqrt(n));
        EXPECT_NEAR(xy / n, 0.25, 4.5 * 0.220 / std::sqrt(n));
        EXPECT_NEAR(xz / n, 0.25, 4.5 * 0.220 / std::sqrt(n));
    }
}

} // namespace
} // namespace snell::test
