#include "snell/lab/convergence.h"

#include "snell/lab/metrics.h"
#include "snell/render/render.h"
#include "tests/render/scenes.h"

#include <cmath>
#include <random>

namespace snell::test {
namespace {

TEST(PowerLaws, AreFound)
{
    std::vector<double> x, y;
    for (int i = 1; i <= 20; ++i) x.push_back(0.3 * i), y.push_back(4.0 * std::pow(x.back(), -0.75));
    const auto law = fit_power_law(x, y);
    ASSERT_TRUE(law);
    EXPECT_NEAR(law->exponent, -0.75, 1e-9);
    EXPECT_NEAR(law->factor, 4.0, 1e-9);
    EXPECT_NEAR((*law)(2.0), 4.0 * std::pow(2.0, -0.75), 1e-9);
    // what has no logarithm does not count
    x.insert(x.end(), {0.0, -1.0, 1.0, 1.0, HUGE_VAL, 1.0});
    y.insert(y.end(), {1.0, 1.0, 0.0, -3.0, 1.0, std::nan("")});
    EXPECT_NEAR(fit_power_law(x, y)->exponent, -0.75, 1e-9);
}

TEST(PowerLaws, NeedPoints)
{
    const std::vector<double> two = {1, 2}, same = {3, 3, 3}, three = {1, 2, 3};
    EXPECT_FALSE(fit_power_law({}, {}));
    EXPECT_FALSE(fit_power_law(two, two));
    EXPECT_FALSE(fit_power_law(same, three));
    EXPECT_TRUE(fit_power_law(three, same));
    EXPECT_FALSE(fit_time({}));
}

TEST(PowerLaws, TheBeginningDoesNotCount)
{
    ConvergenceCurve curve;
    for (int i = 0; i < 40; ++i) {
        const double t = std::pow(10.0, -2.0 + 0.1 * i); // four decades; the first is flat
        curve.points.push_back({t, t * 100, t < 0.1 ? 1.0 : std::pow(10.0 * t, -0.5)});
    }
    EXPECT_NEAR(fit_time(curve, 0.7)->exponent, -0.5, 1e-6);
    EXPECT_GT(fit_time(curve, 1.0)->exponent, -0.49);
}

Film noise(uint samples, uint seed, float sigma)
{
    Film film(64, 48, false);
    std::mt19937 random(seed);
    std::normal_distribution<float> normal(2.0f, sigma);
    for (std::size_t i = 0; i < film.sum.size(); ++i)
        for (uint s = 0; s < samples; ++s) film.add_sample(i, vec3(normal(random)));
    return film;
}

TEST(Convergence, TheExpectedErrorIsTheError)
{
    const Picture truth{64, 48, std::vector<vec3>(64 * 48, vec3(2.0f))};
    for (const uint samples : {2u, 5u, 50u}) {
        const Film film = noise(samples, samples, 0.5f);
        const double theory = 0.5 / std::sqrt(samples);
        EXPECT_NEAR(*expected_rmse(film), theory, 0.05 * theory);
        EXPECT_NEAR(*rmse_against(film, truth), theory, 0.05 * theory);
        EXPECT_NEAR(*rmse_against(film, truth), std::sqrt(compare_pictures(film.picture(), truth).mse), 1e-5);
    }
    EXPECT_FALSE(expected_rmse(noise(1, 1, 0.5f)));
    EXPECT_FALSE(rmse_against(noise(2, 1, 0.5f), Picture{48, 64, truth.pixels}));
}

// The error of independent samples falls with the root of their number, estimated and measured; that of stratified ones
// (Owen-scrambled Sobol points) is smaller.
TEST(Convergence, IndependentSamplesHaveASlopeOfMinusOneHalf)
{
    RenderSettings settings = small_picture("ao");
    settings.layers = false;
    settings.width = 24;
    settings.height = 18;
    const auto prepared = prepare(mixed_scene(), settings);
    settings.spp = 8192;
    settings.seed = 99;
    const Picture truth = render(*prepared, settings).film.picture();
    settings.seed = 0;
    const auto curves = [&](const char* sampler) {
        settings.sampler = sampler;
        std::vector<ConvergenceCurve> result(2);
        for (uint spp = 4; spp <= 256; spp *= 2) {
            settings.spp = spp;
            const Film film = render(*prepared, settings).film;
            result[0].points.push_back({0.01 * spp, double(spp), *expected_rmse(film)});
            result[1].points.push_back({0.01 * spp, double(spp), *rmse_against(film, truth)});
        }
        return result;
    };
    const auto independent = curves("independent"), sobol = curves("sobol");
    EXPECT_NEAR(fit_time(independent[0], 1.0)->exponent, -0.5, 0.03);
    EXPECT_NEAR(fit_time(independent[1], 1.0)->exponent, -0.5, 0.05);
    EXPECT_LT(sobol[1].points.back().rmse, 0.8 * independent[1].points.back().rmse);
}

TEST(Convergence, AsCsv)
{
    const std::vector<ConvergenceCurve> curves = {{"path, \"bvh8\"", {{0.5, 1, 0.25}, {1, 2, std::nan("")}}},
                                                  {"b", {}}};
    EXPECT_EQ(convergence_csv(curves), "name,seconds,spp,rmse\n"
                                       "\"path, \"\"bvh8\"\"\",0.5,1,0.25\n"
                                       "\"path, \"\"bvh8\"\"\",1,2,\n");
}

} // namespace
} // namespace snell::test
