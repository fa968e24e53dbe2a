// Fresnel's equations against complex arithmetic.
#include "snell/kernel/fresnel.h"
#include "tests/stat/chi_square.h"

#include <gtest/gtest.h>

#include <complex>

namespace snell::test {
namespace {

using Complex = std::complex<double>;

// Amplitudes at an interface, from side 1 (real index n1) to side 2 (any complex index n2).
double reference_reflectance(double cos_i, double n1, Complex n2)
{
    const double sin_i2 = 1 - cos_i * cos_i;
    const Complex cos_t = std::sqrt(Complex(1) - n1 * n1 * sin_i2 / (n2 * n2));
    const Complex rs = (n1 * cos_i - n2 * cos_t) / (n1 * cos_i + n2 * cos_t);
    const Complex rp = (n2 * cos_i - n1 * cos_t) / (n2 * cos_i + n1 * cos_t);
    return 0.5 * (std::norm(rs) + std::norm(rp));
}

// How far rounding may take the reflectance between indices n1 and n2: as far as changing cosine and index by a few
// units in the last place does, which is a lot close to total reflection, and a little more.
double allowance(double cos_i, double n1, double n2)
{
    constexpr double ulps = 5e-7;
    const double r = reference_reflectance(cos_i, n1, n2);
    double most = 0;
    for (const double dc : {1 - ulps, 1 + ulps})
        for (const double dn : {1 - ulps, 1 + ulps})
            most = std::max(most, std::abs(reference_reflectance(std::min(cos_i * dc, 1.0), n1, n2 * dn) - r));
    return 3e-6 + most;
}

TEST(Fresnel, DielectricFollowsTheAmplitudes)
{
    Draw draw(100);
    for (int i = 0; i < 100'000; ++i) {
        const float ior = draw.between(0.4f, 3.0f);
        const float c = draw.between(-1.0f, 1.0f);
        if (c == 0.0f) continue;
        const DielectricSplit s = split_dielectric(c, ior);
        const double n1 = c > 0 ? 1.0 : double{ior}, n2 = c > 0 ? double{ior} : 1.0;
        const double x = std::abs(double{c});
        EXPECT_NEAR(s.reflectance, reference_reflectance(x, n1, n2), allowance(x, n1, n2)) << c << " " << ior;
        EXPECT_NEAR(s.eta, n2 / n1, 1e-6 * n2 / n1);
        const double sin_t = n1 / n2 * std::sqrt(1 - double{c} * double{c});
        // the square root amplifies rounding where the refracted ray grazes
        EXPECT_NEAR(double{s.cos_t} * double{s.cos_t}, std::max(1 - sin_t * sin_t, 0.0), 5e-6);
    }
}

TEST(Fresnel, KnownValues)
{
    EXPECT_NEAR(split_dielectric(1.0f, 1.5f).reflectance, 0.04f, 1e-7f);
    EXPECT_NEAR(split_dielectric(-1.0f, 1.5f).reflectance, 0.04f, 1e-7f);
    EXPECT_EQ(split_dielectric(-0.5f, 1.5f).reflectance, 1.0f) << "total internal reflection";
    EXPECT_NEAR(split_dielectric(0.3f, 1.0f).reflectance, 0.0f, 1e-12f) << "nothing to reflect at";
    EXPECT_EQ(split_dielectric(0.0f, 1.5f).reflectance, 1.0f) << "grazing";
    // the critical angle itself: sin = 1 / 1.5
    const float critical = std::sqrt(1.0f - 1.0f / 2.25f);
    EXPECT_LT(split_dielectric(-critical - 1e-3f, 1.5f).reflectance, 1.0f);
    EXPECT_EQ(split_dielectric(-critical + 1e-3f, 1.5f).reflectance, 1.0f);
}

// At Brewster's angle no light of one polarisation is reflected: R = r_s^2 / 2 with r_s = (1 - n^2) / (1 + n^2).
TEST(Fresnel, BrewstersAngle)
{
    for (const double n : {1.2, 1.5, 2.4}) {
        const double c = std::cos(std::atan(n)), rs = (1 - n * n) / (1 + n * n);
        EXPECT_NEAR(split_dielectric(static_cast<float>(c), static_cast<float>(n)).reflectance, 0.5 * rs * rs, 1e-6);
    }
}

// Light takes the same way in both directions (Stokes).
TEST(Fresnel, SameReflectanceFromBothSides)
{
    Draw draw(101);
    for (int i = 0; i < 10'000; ++i) {
        const float ior = draw.between(1.1f, 2.5f), c = draw.between(0.02f, 1.0f);
        const DielectricSplit in = split_dielectric(c, ior);
        const DielectricSplit out = split_dielectric(-in.cos_t, ior);
        EXPECT_NEAR(in.reflectance, out.reflectance, 2e-4f) << c << " " << ior;
        EXPECT_NEAR(out.cos_t, c, 1e-4f / c);
    }
}

TEST(Fresnel, ConductorFollowsTheAmplitudes)
{
    Draw draw(102);
    for (int i = 0; i < 100'000; ++i) {
        const vec3 eta(draw.between(0.05f, 4.0f), draw.between(0.05f, 4.0f), draw.between(0.05f, 4.0f));
        const vec3 k(draw.between(0.1f, 8.0f), draw.between(0.1f, 8.0f), draw.between(0.1f, 8.0f));
        const float c = draw.next();
        const vec3 r = fresnel_conductor(c, eta, k);
        for (int a = 0; a < 3; ++a)
            EXPECT_NEAR(r[a], reference_reflectance(double{c}, 1, Complex(double{eta[a]}, double{k[a]})), 1e-5)
                << c << " " << eta[a] << " " << k[a];
    }
}

TEST(Fresnel, ConductorAtTheEdges)
{
    for (const float c : {0.0f, 1e-6f, 0.3f, 1.0f})
        for (const float eta : {0.0f, 1e-6f, 1.0f, 50.0f})
            for (const float k : {0.0f, 1e-6f, 6.0f, 1000.0f}) {
                const vec3 r = fresnel_conductor(c, vec3(eta), vec3(k));
                EXPECT_TRUE(r.x >= 0.0f && r.x <= 1.0f) << c << " " << eta << " " << k << ": " << r.x;
            }
    // without absorption a conductor is a dielectric
    for (const float c : {0.1f, 0.5f, 1.0f})
        EXPECT_NEAR(fresnel_conductor(c, vec3(1.5f), vec3(0.0f)).y, split_dielectric(c, 1.5f).reflectance, 1e-6f);
    // eta 1, k 6 reflects k^2 / (4 + k^2) of what comes straight
    EXPECT_NEAR(fresnel_conductor(1.0f, vec3(1.0f), vec3(6.0f)).x, 0.9f, 1e-6f);
}

// Snell's law, and the refracted ray lies in the plane of incidence, on the other side.
TEST(Fresnel, RefractedDirection)
{
    Draw draw(103);
    int refracted = 0;
    for (int i = 0; i < 100'000; ++i) {
        const vec3 n = draw.direction(), w = draw.direction();
        const float ior = draw.between(0.4f, 3.0f);
        const DielectricSplit s = split_dielectric(dot(w, n), ior);
        if (s.reflectance == 1.0f || abs(dot(w, n)) < 1e-3f || s.cos_t < 1e-3f) continue;
        ++refracted;
        const vec3 t = refract_direction(w, n, s);
        EXPECT_NEAR(length(t), 1.0f, 1e-6f);
        EXPECT_LT(dot(t, n) * dot(w, n), 0.0f);
        EXPECT_NEAR(length(cross(t, n)) * s.eta, length(cross(w, n)), 3e-6f * max(s.eta, 1.0f));
        EXPECT_NEAR(dot(t, cross(w, n)), 0.0f, 1e-6f);
        EXPECT_LT(dot(cross(t, n), cross(w, n)), 1e-6f) << "it goes on, not back";
    }
    EXPECT_GT(refracted, 50'000);
}

} // namespace
} // namespace snell::test
