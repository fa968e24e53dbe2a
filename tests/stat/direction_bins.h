// Cells on the sphere of directions, and the integral of a density over each.
#pragma once

#include "tests/stat/chi_square.h"

#include <gtest/gtest.h>

#include <functional>

namespace snell::test {

using Density = std::function<double(vec3)>; // per steradian

// Rings around an axis, cut into sectors. In h = 1 - cos(angle to the axis) and the azimuth, areas are solid angles.
class DirectionBins
{
  public:
    // exponent > 1 makes the rings near the axis finer; h_max < 2 covers a cone only. With exponent 1, h_max 2 and an
    // even number of rings the equator is a boundary.
    DirectionBins(vec3 axis, int rings, int sectors, double exponent = 1, double h_max = 2)
        : rings_(rings), sectors_(sectors), exponent_(exponent), h_max_(h_max), n_(glm::normalize(glm::dvec3(axis)))
    {
        const glm::dvec3 other = std::abs(n_.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
        s_ = glm::normalize(glm::cross(other, n_));
        t_ = glm::cross(n_, s_);
    }

    // One more for directions beyond the cone.
    std::size_t size() const { return static_cast<std::size_t>(rings_ * sectors_) + 1; }

    std::size_t index(vec3 direction) const
    {
        const glm::dvec3 w = glm::normalize(glm::dvec3(direction));
        const glm::dvec3 d = w - n_;
        const double h = 0.5 * glm::dot(d, d); // 1 - cos without cancellation
        if (h >= h_max_ && h_max_ < 2) return size() - 1;
        const int ring = std::min(static_cast<int>(std::pow(h / h_max_, 1 / exponent_) * rings_), rings_ - 1);
        const double turn = std::atan2(glm::dot(w, t_), glm::dot(w, s_)) / (2 * std::numbers::pi);
        const int sector = std::clamp(static_cast<int>((turn - std::floor(turn)) * sectors_), 0, sectors_ - 1);
        return static_cast<std::size_t>(ring * sectors_ + sector);
    }

    // Integral of the density over each cell; the last one is 0. A cell is cut in four, and its parts again, until that
    // changes a part by less than `tolerance`, at least min_cuts times: densities with edges inside cells need some.
    std::vector<double> integrate(const Density& density, double tolerance = 1e-7, int min_cuts = 0) const
    {
        std::vector<double> result;
        for (int ring = 0; ring < rings_; ++ring)
            for (int sector = 0; sector < sectors_; ++sector) {
                const Cell cell{edge(ring), edge(ring + 1), turn(sector), turn(sector + 1)};
                result.push_back(refine(density, cell, gauss(density, cell), tolerance, min_cuts, 16));
            }
        result.push_back(0);
        return result;
    }

  private:
    struct Cell
    {
        double h0, h1, p0, p1;
    };

    double edge(int ring) const { return h_max_ * std::pow(static_cast<double>(ring) / rings_, exponent_); }
    double turn(int sector) const { return 2 * std::numbers::pi * sector / sectors_; }

    vec3 direction(double h, double p) const
    {
        const double r = std::sqrt(std::max(h * (2 - h), 0.0));
        return vec3((1 - h) * n_ + r * std::cos(p) * s_ + r * std::sin(p) * t_);
    }

    double gauss(const Density& density, const Cell& c) const
    {
        static constexpr double x[3] = {0.1127016653792583, 0.5, 0.8872983346207417};
        static constexpr double w[3] = {5.0 / 18, 8.0 / 18, 5.0 / 18};
        double sum = 0;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                sum += w[i] * w[j] * density(direction(c.h0 + (c.h1 - c.h0) * x[i], c.p0 + (c.p1 - c.p0) * x[j]));
        return sum * (c.h1 - c.h0) * (c.p1 - c.p0);
    }

    double refine(const Density& density, const Cell& c, double whole, double tolerance, int min_cuts,
                  int max_cuts) const
    {
        const double h = 0.5 * (c.h0 + c.h1), p = 0.5 * (c.p0 + c.p1);
        const Cell quarters[4] = {{c.h0, h, c.p0, p}, {h, c.h1, c.p0, p}, {c.h0, h, p, c.p1}, {h, c.h1, p, c.p1}};
        double parts[4], sum = 0;
        for (int i = 0; i < 4; ++i) sum += parts[i] = gauss(density, quarters[i]);
        if (max_cuts == 0 || (min_cuts <= 0 && std::abs(sum - whole) < tolerance)) return sum;
        sum = 0;
        for (int i = 0; i < 4; ++i)
            sum += refine(density, quarters[i], parts[i], tolerance, min_cuts - 1, max_cuts - 1);
        return sum;
    }

    int rings_, sectors_;
    double exponent_, h_max_;
    glm::dvec3 n_, s_, t_;
};

// Draws `count` directions and compares where they fall with the density. A direction of (0, 0, 0) is "no sample": the
// density may integrate to less than 1 by just as many.
inline void expect_density(const DirectionBins& bins, const Density& density, const std::function<vec3()>& sample,
                           int count, int min_cuts = 1)
{
    std::vector<double> expected =
        bins.integrate(density, long_tests() ? 1e-8 : 1e-7, long_tests() ? min_cuts + 2 : min_cuts);
    double total = 0;
    for (double& e : expected) total += e, e *= count;
    EXPECT_LE(total, 1 + 2e-4) << "the density integrates to more than 1";
    expected.push_back(std::max(1 - total, 0.0) * count);
    std::vector<double> observed(expected.size(), 0.0);
    for (int i = 0; i < count; ++i) {
        const vec3 w = sample();
        observed[w == vec3(0.0f) ? observed.size() - 1 : bins.index(w)] += 1;
    }
    const ChiSquare test = chi_square(observed, expected);
    EXPECT_GE(test.p, significance()) << "chi-square " << test.statistic << " with " << test.degrees
                                      << " degrees of freedom, p " << test.p << "; density integrates to " << total
                                      << ", no sample " << observed.back() / count << ", seed " << test_seed();
    EXPECT_GE(test.degrees, 3) << "too few cells to tell anything";
}

} // namespace snell::test
