// The Owen-scrambled Sobol points: their net property, their structure against a slow implementation of the textbook,
// and that they do what one takes them for: integrate smooth functions faster than random points.
#include "snell/kernel/random.h"
#include "tests/stat/chi_square.h"

#include <gtest/gtest.h>

#include <functional>

#include <array>

namespace snell::test {
namespace {

// Elementary intervals: of 2^k points, each box of 2^-i by 2^-(k-i) holds exactly one. So does each aligned run of the
// sequence.
void expect_net(uint k, uint first, const std::function<uvec2(uint)>& point)
{
    const uint n = 1u << k;
    for (uint i = 0; i <= k; ++i) {
        std::vector<uint> count(n, 0);
        for (uint s = 0; s < n; ++s) {
            const uvec2 p = point(first + s);
            const uint column = i == 0 ? 0 : p.x >> (32 - i), row = i == k ? 0 : p.y >> (32 - (k - i));
            ++count[(row << i) + column];
        }
        for (const uint c : count) ASSERT_EQ(c, 1u) << "boxes of 2^-" << i << " by 2^-" << k - i;
    }
}

TEST(Sobol, ElementaryIntervalsHoldOnePoint)
{
    Draw draw(320);
    for (uint k = 0; k <= 12; ++k)
        for (int repeat = 0; repeat < 4; ++repeat) {
            const uint hash = repeat == 0 ? 0u : draw.bits();
            expect_net(k, 0, [&](uint i) { return scrambled_sobol(reverse_bits(i), hash); });
            expect_net(k, (draw.bits() >> 16) << k, [&](uint i) { return scrambled_sobol(reverse_bits(i), hash); });
        }
}

// The renderer's numbers, after their conversion to float.
TEST(Sobol, ElementaryIntervalsOfTheRenderersNumbers)
{
    for (const uint pixel : {0u, 3u, 99999u})
        for (const uint dimension : {0u, 2u, 14u})
            for (uint k = 0; k <= 10; ++k)
                expect_net(k, 0, [&](uint i) {
                    const vec2 u = random_2d(make_sample_key(sampler_sobol, pixel, i, 1), dimension);
                    return uvec2(static_cast<uint>(double{u.x} * 4294967296.0),
                                 static_cast<uint>(double{u.y} * 4294967296.0));
                });
}

// Sobol 1967 as in textbooks (Bratley and Fox 1988): direction numbers from the primitive polynomials 1 (van der
// Corput) and x + 1, one XOR for each bit of the index.
std::array<uint, 32> direction_numbers(uint dimension)
{
    std::array<uint, 32> v{};
    if (dimension == 0) {
        for (uint i = 0; i < 32; ++i) v[i] = 1u << (31 - i);
        return v;
    }
    // degree 1, no inner coefficients, m_1 = 1: m_i = 2 m_(i-1) xor m_(i-1)
    uint m = 1;
    for (uint i = 0; i < 32; ++i) {
        v[i] = m << (31 - i);
        m = (m << 1) ^ m;
    }
    return v;
}

uint slow_sobol(uint index, uint dimension)
{
    static const std::array<uint, 32> numbers[2] = {direction_numbers(0), direction_numbers(1)};
    uint x = 0;
    for (uint bit = 0; bit < 32; ++bit)
        if (index >> bit & 1u) x ^= numbers[dimension][bit];
    return x;
}

TEST(Sobol, SecondDimensionIsTheTextbooks)
{
    Draw draw(321);
    for (uint i = 0; i < 100'000; ++i) {
        const uint index = i < 4096 ? i : draw.bits();
        ASSERT_EQ(reverse_bits(sobol_1_reversed(index)), slow_sobol(index, 1)) << index;
        ASSERT_EQ(reverse_bits(index), slow_sobol(index, 0)) << index;
    }
}

TEST(Sobol, BitReversal)
{
    Draw draw(322);
    for (int i = 0; i < 10'000; ++i) {
        const uint x = draw.bits();
        uint slow = 0;
        for (uint b = 0; b < 32; ++b) slow |= (x >> b & 1u) << (31 - b);
        ASSERT_EQ(reverse_bits(x), slow);
    }
}

// Nested uniform scrambling: whether a digit flips depends on the digits before it and on nothing else. `scramble` maps
// 0.32 fixed point to the same. Numbers with the same first k digits must keep the same first k digits, and the digit
// after must flip for both or for none.
void expect_nested(const std::function<uint(uint)>& scramble)
{
    Draw draw(323);
    for (int i = 0; i < 20'000; ++i) {
        const uint a = draw.bits();
        const uint k = draw.bits() % 32u; // common digits
        const uint rest = k == 0 ? ~0u : ~0u >> k;
        const uint b = (a & ~rest) | (draw.bits() & rest);
        const uint difference = scramble(a) ^ scramble(b);
        ASSERT_EQ(difference & ~rest, 0u) << "common digits stay common";
        const uint digit = 1u << (31 - k);
        ASSERT_EQ(difference & digit, (a ^ b) & digit) << "the next digit flips in both or in none";
    }
}

TEST(Sobol, ScramblingIsNested)
{
    Draw draw(324);
    for (int i = 0; i < 16; ++i) {
        const uint seed = draw.bits();
        expect_nested([&](uint x) { return reverse_bits(owen_scramble_reversed(reverse_bits(x), seed)); });
    }
}

// With a random seed each digit flips in half of the cases, and different prefixes flip independently of each other:
// this is what makes the estimate unbiased and the points better than random (Owen 1995).
TEST(Sobol, ScramblingFlipsHalfOfAllDigits)
{
    constexpr int n = 40'000;
    std::vector<double> flips(32, 0.0);
    std::vector<double> pairs(24 * 24, 0.0);
    Draw draw(325);
    for (int i = 0; i < n; ++i) {
        const uint seed = hash_uint(draw.bits());
        const auto flip = [&](uint x) { return reverse_bits(owen_scramble_reversed(reverse_bits(x), seed)) ^ x; };
        const uint f = flip(0x9abcdef1u);
        for (uint b = 0; b < 32; ++b) flips[b] += f >> (31 - b) & 1u;
        // the flip of the fifth digit, after each of 16 prefixes of four digits: pairs of prefixes
        uint fifth = 0;
        for (uint prefix = 0; prefix < 16; ++prefix) fifth |= (flip(prefix << 28) >> 27 & 1u) << prefix;
        for (uint p = 0; p < 16; ++p)
            for (uint q = 0; q < p; ++q) pairs[p * 24 + q] += (fifth >> p & 1u) == (fifth >> q & 1u) ? 1 : 0;
    }
    for (uint b = 0; b < 32; ++b) EXPECT_NEAR(flips[b] / n, 0.5, 0.015) << "digit " << b;
    for (uint p = 0; p < 16; ++p)
        for (uint q = 0; q < p; ++q) EXPECT_NEAR(pairs[p * 24 + q] / n, 0.5, 0.03) << "prefixes " << p << " " << q;
}

// The whole thing against the definition: the points of scrambled_sobol are Sobol points of a nested permutation of the
// indices (which keeps each aligned run together), with each coordinate scrambled in a nested way of its own.
TEST(Sobol, IsANestedScramblingOfTheSequence)
{
    Draw draw(326);
    for (int repeat = 0; repeat < 8; ++repeat) {
        const uint hash = draw.bits();
        const auto shuffle = [&](uint i) { return reverse_bits(owen_scramble_reversed(reverse_bits(i), hash)); };
        expect_nested(shuffle);
        // what scrambles x and y, found from the outside: as a map from Sobol coordinates to points
        for (const int axis : {0, 1}) {
            std::vector<std::pair<uint, uint>> map;
            for (uint i = 0; i < 1024; ++i) {
                const uvec2 p = scrambled_sobol(reverse_bits(i), hash);
                map.emplace_back(slow_sobol(shuffle(i), static_cast<uint>(axis)), axis == 0 ? p.x : p.y);
            }
            std::sort(map.begin(), map.end());
            // neighbours in the order share the most digits
            for (std::size_t i = 0; i + 1 < map.size(); ++i) {
                const uint in = map[i].first ^ map[i + 1].first, out = map[i].second ^ map[i + 1].second;
                ASSERT_NE(in, 0u);
                ASSERT_EQ(__builtin_clz(in), __builtin_clz(out)) << "the same number of common digits";
            }
        }
    }
}

// Root mean square error over many pixels of the mean of a smooth function.
double integration_error(uint kind, uint samples, const std::function<double(vec2)>& f, double exact)
{
    constexpr uint pixels = 400;
    double sum = 0;
    for (uint p = 0; p < pixels; ++p) {
        double mean = 0;
        for (uint s = 0; s < samples; ++s) mean += f(random_2d(make_sample_key(kind, p, s, 0), 2)) / samples;
        sum += (mean - exact) * (mean - exact);
    }
    return std::sqrt(sum / pixels);
}

// Random points: error falls as n^-1/2. Owen-scrambled Sobol: n^-3/2 for smooth functions (Owen 1997), where
// unscrambled or merely shifted points give about n^-1.
TEST(Sobol, ConvergesFasterThanOneOverN)
{
    const auto f = [](vec2 u) { return std::exp(double{u.x}) * std::sin(2 * double{u.y}); };
    const double exact = (std::numbers::e - 1) * 0.5 * (1 - std::cos(2.0));
    const double few = integration_error(sampler_sobol, 16, f, exact);
    const double many = integration_error(sampler_sobol, 1024, f, exact);
    const double order = std::log(few / many) / std::log(64.0);
    EXPECT_GT(order, 1.3) << "error " << few << " at 16 samples, " << many << " at 1024";
    EXPECT_LT(order, 1.8);

    const double random_order = std::log(integration_error(sampler_independent, 16, f, exact) /
                                         integration_error(sampler_independent, 1024, f, exact)) /
                                std::log(64.0);
    EXPECT_NEAR(random_order, 0.5, 0.08);
}

// Each point by itself is uniform over the scramblings: the estimate is unbiased at any number of samples, and so is a
// render that takes a part of the sequence.
TEST(Sobol, UnbiasedAtAnySampleCount)
{
    const auto f = [](vec2 u) { return double{u.x} * double{u.x} + (u.y > 0.3f ? 1.0 : 0.0); };
    const double exact = 1.0 / 3 + 0.7;
    for (const uint first : {0u, 5u, 64u}) {
        for (const uint samples : {1u, 3u, 7u, 16u}) {
            double sum = 0, squares = 0;
            constexpr uint pixels = 20'000;
            for (uint p = 0; p < pixels; ++p) {
                double mean = 0;
                for (uint s = 0; s < samples; ++s)
                    mean += f(random_2d(make_sample_key(sampler_sobol, p, first + s, 9), 2)) / samples;
                sum += mean, squares += mean * mean;
            }
            const double mean = sum / pixels;
            const double error = std::sqrt((squares / pixels - mean * mean) / pixels);
            EXPECT_NEAR(mean, exact, 4 * error) << samples << " samples from " << first;
        }
    }
}

} // namespace
} // namespace snell::test
