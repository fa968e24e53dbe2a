// Chi-square of every warp against its density.
#include "snell/kernel/microfacet.h"
#include "snell/kernel/warp.h"
#include "tests/stat/direction_bins.h"

namespace snell::test {
namespace {

const vec3 up(0.0f, 0.0f, 1.0f);

int draws()
{
    return long_tests() ? 4'000'000 : 400'000;
}

// Points in a rectangle against a density per area, on a grid of n x n cells integrated with m x m points each.
void expect_planar_density(vec2 lower, vec2 upper, const std::function<double(double, double)>& density,
                           const std::function<vec2()>& sample)
{
    constexpr int n = 24, m = 40;
    const double dx = static_cast<double>(upper.x - lower.x) / n, dy = static_cast<double>(upper.y - lower.y) / n;
    std::vector<double> expected(n * n), observed(n * n, 0.0);
    double total = 0;
    for (int cell = 0; cell < n * n; ++cell) {
        double sum = 0;
        for (int k = 0; k < m * m; ++k)
            sum += density(static_cast<double>(lower.x) + (cell % n + (k % m + 0.5) / m) * dx,
                           static_cast<double>(lower.y) + (cell / n + (k / m + 0.5) / m) * dy);
        total += expected[static_cast<std::size_t>(cell)] = sum * dx * dy / (m * m);
    }
    EXPECT_NEAR(total, 1, 1e-3);
    for (double& e : expected) e *= draws() / total;
    for (int i = 0; i < draws(); ++i) {
        const vec2 p = sample();
        ASSERT_TRUE(p.x >= lower.x && p.x <= upper.x && p.y >= lower.y && p.y <= upper.y) << p.x << " " << p.y;
        const int cx = std::min(static_cast<int>(static_cast<double>(p.x - lower.x) / dx), n - 1);
        const int cy = std::min(static_cast<int>(static_cast<double>(p.y - lower.y) / dy), n - 1);
        observed[static_cast<std::size_t>(cy * n + cx)] += 1;
    }
    const ChiSquare test = chi_square(observed, expected);
    EXPECT_GE(test.p, significance()) << test.statistic << " / " << test.degrees << ", seed " << test_seed();
}

TEST(Warp, DiskIsUniform)
{
    Draw draw(1);
    expect_planar_density(
        vec2(-1.0f), vec2(1.0f), [](double x, double y) { return x * x + y * y < 1 ? double{pdf_disk()} : 0.0; },
        [&] { return sample_disk(draw.next2()); });
}

TEST(Warp, DiskIsContinuousAndStaysInside)
{
    for (int i = 0; i <= 64; ++i)
        for (int j = 0; j <= 64; ++j) {
            const vec2 u(static_cast<float>(i) / 64.0f, static_cast<float>(j) / 64.0f);
            const vec2 d = sample_disk(u);
            EXPECT_LE(dot(d, d), 1.000001f);
            const float ring = max(abs(2.0f * u.x - 1.0f), abs(2.0f * u.y - 1.0f));
            EXPECT_NEAR(length(d), ring, 1e-6f) << "squares become circles";
        }
}

TEST(Warp, TriangleIsUniform)
{
    Draw draw(2);
    // barycentric weights: density 2 where both and their rest are positive
    expect_planar_density(
        vec2(0.0f), vec2(1.0f), [](double x, double y) { return x + y < 1 ? 2.0 : 0.0; },
        [&] {
            const vec2 b = sample_triangle(draw.next2());
            EXPECT_TRUE(b.x >= 0.0f && b.y >= 0.0f && b.x + b.y <= 1.0f) << b.x << " " << b.y;
            return b;
        });
}

TEST(Warp, CosineHemisphere)
{
    Draw draw(3);
    expect_density(
        DirectionBins(up, 20, 40), [](vec3 w) { return double{pdf_cosine_hemisphere(w)}; },
        [&] { return sample_cosine_hemisphere(draw.next2()); }, draws());
}

TEST(Warp, UniformHemisphere)
{
    Draw draw(4);
    expect_density(
        DirectionBins(up, 20, 40), [](vec3 w) { return double{pdf_uniform_hemisphere(w)}; },
        [&] { return sample_uniform_hemisphere(draw.next2()); }, draws());
}

TEST(Warp, UniformSphere)
{
    Draw draw(5);
    expect_density(
        DirectionBins(normalize(vec3(1.0f, 2.0f, 3.0f)), 20, 40), [](vec3) { return double{pdf_uniform_sphere()}; },
        [&] { return sample_uniform_sphere(draw.next2()); }, draws());
}

// From half a degree to all of the sphere.
TEST(Warp, UniformCone)
{
    std::uint64_t stream = 6;
    for (const float cone : {4e-5f, 0.01f, 0.5f, 1.0f, 1.7f, 2.0f}) {
        SCOPED_TRACE(testing::Message() << "1 - cos " << cone);
        Draw draw(stream++);
        // rings end on the edge of the cone, so that no cell is cut by it
        const double h_max = std::min(2.0 * static_cast<double>(cone), 2.0);
        const DirectionBins bins(up, 20, 20, 1, h_max);
        expect_density(
            bins, [&](vec3 w) { return w.z >= 1.0f - cone ? double{pdf_uniform_cone(cone)} : 0.0; },
            [&] { return sample_uniform_cone(draw.next2(), cone); }, draws());
    }
}

// The density of visible normals, for roughness and elevation; it integrates to 1 over the hemisphere.
TEST(Warp, VisibleNormals)
{
    std::uint64_t stream = 20;
    for (const float alpha : {0.02f, 0.1f, 0.3f, 0.7f, 1.0f})
        for (const float z : {1.0f, 0.7f, 0.2f, 0.03f}) {
            SCOPED_TRACE(testing::Message() << "alpha " << alpha << ", cos " << z);
            Draw draw(stream++);
            const float r = std::sqrt(1.0f - z * z);
            const vec3 w(0.8f * r, -0.6f * r, z);
            // fine rings around the mean normal, where a smooth surface's normals are
            const DirectionBins bins(up, 24, 24, alpha < 0.2f ? 4 : 2, 1.0);
            expect_density(
                bins, [&](vec3 m) { return m.z > 0.0f ? double{pdf_ggx_visible(w, m, alpha)} : 0.0; },
                [&] { return sample_ggx_visible(w, alpha, draw.next2()); }, draws() / 4);
        }
}

// The defining property of a normal distribution: microfacets cover the surface, int D(m) (m.n) = 1.
TEST(Warp, GgxCoversTheSurface)
{
    for (const float alpha : {0.02f, 0.1f, 0.5f, 1.0f}) {
        double sum = 0;
        constexpr int n = 200'000;
        for (int i = 0; i < n; ++i) { // in s = tan^2 theta / (alpha^2 + tan^2 theta), in which it is smooth
            const double s = (i + 0.5) / n, a2 = double{alpha} * double{alpha};
            const double tan2 = a2 * s / (1 - s), cos2 = 1 / (1 + tan2);
            const vec3 m(static_cast<float>(std::sqrt(1 - cos2)), 0.0f, static_cast<float>(std::sqrt(cos2)));
            // d(omega) cos = pi d(sin^2); sin^2 = tan2 / (1 + tan2)
            const double jacobian = a2 / ((1 - s) * (1 - s)) * cos2 * cos2;
            sum += double{ggx_d(m, alpha)} * std::numbers::pi * jacobian / n;
        }
        EXPECT_NEAR(sum, 1, 1e-4) << "alpha " << alpha;
    }
}

// Smith's constraint: the visible microfacets project to the same area as the surface, from any direction.
TEST(Warp, VisibleMicrofacetsProjectToTheSurface)
{
    for (const float alpha : {0.1f, 0.5f, 1.0f})
        for (const float z : {0.9f, 0.4f, 0.1f}) {
            const vec3 w(std::sqrt(1.0f - z * z), 0.0f, z);
            const DirectionBins bins(up, 16, 16, 2, 1.0);
            const std::vector<double> cells = bins.integrate(
                [&](vec3 m) {
                    return double{ggx_g1(z, alpha)} * std::max(double{dot(w, m)}, 0.0) * double{ggx_d(m, alpha)};
                },
                1e-6);
            EXPECT_NEAR(std::accumulate(cells.begin(), cells.end(), 0.0), double{z}, 1e-3) << alpha << " " << z;
        }
}

} // namespace
} // namespace snell::test
