// Pearson's chi-square test and the random numbers that feed it.
//
// All tests of this folder together have a chance of 1 % to fail by bad luck alone (Sidak's correction); with the fixed
// seed below they fail always or never. SNELL_TEST_SEED chooses another seed, SNELL_LONG=1 takes more samples.
#pragma once

#include "snell/core/vec.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <random>
#include <span>
#include <vector>

namespace snell::test {

inline bool long_tests()
{
    const char* value = std::getenv("SNELL_LONG");
    return value != nullptr && *value != '\0' && *value != '0';
}

inline std::uint64_t test_seed()
{
    const char* value = std::getenv("SNELL_TEST_SEED");
    return value != nullptr ? std::strtoull(value, nullptr, 10) : 20240607;
}

// Uniform numbers in [0, 1), from a generator that shares nothing with the renderer's.
class Draw
{
  public:
    explicit Draw(std::uint64_t stream) : engine_(test_seed() * 0x9e3779b97f4a7c15u + stream) {}

    float next() { return static_cast<float>(engine_() >> 40) * 0x1p-24f; }
    vec2 next2()
    {
        const float x = next();
        return vec2(x, next());
    }
    float between(float a, float b) { return a + (b - a) * next(); }
    uint bits() { return static_cast<uint>(engine_() >> 32); }
    vec3 direction()
    {
        std::normal_distribution<double> gauss;
        const double x = gauss(engine_), y = gauss(engine_), z = gauss(engine_);
        return vec3(glm::normalize(glm::dvec3(x, y, z)));
    }

  private:
    std::mt19937_64 engine_;
};

// Upper tail Q(a, x) of the regularised incomplete gamma function: series for small x, Lentz's continued fraction for
// large x (Abramowitz and Stegun 6.5.29 and 6.5.31).
inline double gamma_q(double a, double x)
{
    if (x <= 0) return 1;
    const double front = std::exp(a * std::log(x) - x - std::lgamma(a));
    if (x < a + 1) {
        double term = 1 / a, sum = term;
        for (double n = a + 1; term > sum * 1e-16; ++n) sum += term *= x / n;
        return 1 - front * sum;
    }
    double b = x + 1 - a, c = 1e300, d = 1 / b, h = d;
    for (int i = 1; i < 10000; ++i) {
        const double an = -i * (i - a);
        b += 2;
        d = 1 / (an * d + b);
        c = b + an / c;
        h *= d * c;
        if (std::abs(d * c - 1) < 1e-15) break;
    }
    return front * h;
}

struct ChiSquare
{
    double statistic = 0;
    int degrees = 0;
    double p = 1; // probability of a statistic at least this large if observed follows expected
};

// observed and expected: counts by cell; they should have the same sum. Cells are pooled, rarest first, until each has
// an expectation of at least 5. A count in a cell that cannot have any gives p = 0.
inline ChiSquare chi_square(std::span<const double> observed, std::span<const double> expected)
{
    std::vector<std::size_t> order(observed.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return expected[a] < expected[b]; });
    ChiSquare result;
    double o = 0, e = 0;
    int cells = 0;
    const auto close = [&] {
        if (o == 0 && e == 0) return;
        result.statistic += e > 0 ? (o - e) * (o - e) / e : std::numeric_limits<double>::infinity();
        ++cells;
        o = e = 0;
    };
    double left = std::accumulate(expected.begin(), expected.end(), 0.0);
    for (const std::size_t i : order) {
        o += observed[i];
        e += expected[i];
        left -= expected[i];
        // what remains must itself make a full cell
        if (e >= 5 && left >= 5) close();
    }
    close();
    result.degrees = std::max(cells - 1, 1);
    result.p = std::isfinite(result.statistic) ? gamma_q(0.5 * result.degrees, 0.5 * result.statistic) : 0.0;
    return result;
}

// The p below which one test fails.
inline double significance()
{
    constexpr double all_tests = 1000; // rounded up
    return 1 - std::pow(1 - 0.01, 1 / all_tests);
}

// Two-sided p of a standard normal variable.
inline double normal_p(double z)
{
    return std::erfc(std::abs(z) / std::sqrt(2.0));
}

} // namespace snell::test
