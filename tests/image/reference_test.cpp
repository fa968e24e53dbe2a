// Pictures against another renderer's converged ones (see reference/README.md): equal but for noise, whose size is
// known.
#include "snell/core/error.h"
#include "snell/io/image/read.h"
#include "snell/io/load.h"
#include "snell/render/render.h"
#include "tests/image/reference_files.h"
#include "tests/stat/chi_square.h"

#include <gtest/gtest.h>

namespace snell::test {
namespace {

struct Reference
{
    const char* name;
    double relative_mse; // of the reference itself
    uint spp;
};

constexpr int size = 256, tile = 16;

// The mean over some pixels of ours and the reference's, and the variance of our mean.
struct Mean
{
    double ours = 0, reference = 0, variance = 0;
};

class Comparison
{
  public:
    Comparison(const Film& film, const Picture& reference) : film_(film), reference_(reference)
    {
        for (std::size_t i = 0; i < film.sum.size(); ++i) {
            const double r = double{reference.pixels[i].y}, d = value(i) - r;
            expected_ += variance(i) / (r * r + 0.01) / static_cast<double>(film.sum.size());
            found_ += d * d / (r * r + 0.01) / static_cast<double>(film.sum.size());
        }
    }

    // relMSE of our picture, as its variance predicts it, and as found (the reference's own error included).
    double expected_relative_mse() const { return expected_; }
    double found_relative_mse() const { return found_; }

    Mean mean(int x0, int y0, int side) const
    {
        Mean m;
        const double n = static_cast<double>(side) * side;
        for (int y = y0; y < y0 + side; ++y)
            for (int x = x0; x < x0 + side; ++x) {
                const auto i = static_cast<std::size_t>(y * film_.width + x);
                m.ours += value(i) / n;
                m.reference += double{reference_.pixels[i].y} / n;
                m.variance += variance(i) / (n * n);
            }
        return m;
    }

  private:
    double value(std::size_t i) const { return double{film_.sum[i].y} / film_.sample_count[i]; }
    double variance(std::size_t i) const // of the pixel's mean
    {
        const double n = film_.sample_count[i], mean = value(i);
        return std::max(double{film_.square_sum[i]} / n - mean * mean, 0.0) / (n - 1);
    }

    const Film& film_;
    const Picture& reference_;
    double expected_ = 0, found_ = 0;
};

class HeavyReference : public testing::TestWithParam<Reference>
{
};

INSTANTIATE_TEST_SUITE_P(, HeavyReference,
                         testing::Values(Reference{"cornell_diffuse", 1.4e-4, 48}, Reference{"cornell", 7.7e-4, 256},
                                         Reference{"veach_mis", 6.8e-5, 128}, Reference{"glass_checker", 4.6e-5, 64},
                                         Reference{"env_bunny", 1.2e-4, 64}),
                         [](const auto& reference) { return std::string(reference.param.name); });

TEST_P(HeavyReference, EqualButForNoise)
{
    const Reference& r = GetParam();
    const ReferenceFiles files = find_reference(r.name);
    if (files.scene.empty()) GTEST_SKIP() << r.name << " is left out: its bunny is not part of the project";
    const Picture reference = read_picture(files.picture);
    ASSERT_EQ(reference.width, size);
    ASSERT_EQ(reference.height, size);

    RenderSettings settings;
    settings.width = settings.height = size;
    settings.spp = long_tests() ? 16 * r.spp : r.spp;
    settings.seed = static_cast<uint>(test_seed());
    settings.sampler = "independent"; // its variance can be estimated from one picture
    settings.strict = true;
    const Film film = render(load_scene(files.scene), settings).film;
    const Comparison comparison(film, reference);

    // The reference's noise is where ours is, only less: so much less that its relMSE comes out.
    const double share = r.relative_mse / comparison.expected_relative_mse();
    int outliers = 0, tiles = 0;
    double z_squares = 0;
    std::string worst;
    for (int y = 0; y < size; y += tile)
        for (int x = 0; x < size; x += tile) {
            const Mean m = comparison.mean(x, y, tile);
            const double error = std::sqrt(m.variance * (1 + share)) + 5e-6 * m.reference;
            const double z = (m.ours - m.reference) / error;
            z_squares += z * z;
            ++tiles;
            if (std::abs(z) <= 4) continue;
            ++outliers;
            worst += fmt::format("tile at {},{}: {:.6g} against {:.6g}, {:.1f} standard errors\n", x, y, m.ours,
                                 m.reference, z);
        }
    EXPECT_LE(outliers, tiles / 200) << worst;
    // and the rest are as far off as noise makes them
    EXPECT_LT(std::sqrt(z_squares / tiles), 1.25) << worst;

    const Mean all = comparison.mean(0, 0, size);
    const double error = std::sqrt(all.variance * (1 + share));
    EXPECT_NEAR(all.ours, all.reference, 4 * error) << "total energy";
    EXPECT_LT(error, 0.004 * all.reference) << "too noisy to tell anything";
    if (long_tests()) {
        EXPECT_NEAR(all.ours / all.reference, 1.0, 0.002) << "total energy";
    }

    // pixel by pixel: nothing is sharper, blurred or shifted
    EXPECT_LT(comparison.found_relative_mse(), 1.25 * (comparison.expected_relative_mse() + r.relative_mse));
    RecordProperty("tiles_outside", outliers);
    RecordProperty("energy", fmt::format("{:.5f} of the reference's", all.ours / all.reference));
    if (long_tests())
        std::printf("%s: energy %.5f of the reference's, standard error %.5f; rms z of tiles %.3f\n", r.name,
                    all.ours / all.reference, error / all.reference, std::sqrt(z_squares / tiles));
}

// An albedo of 1 under light of 1 from everywhere: every path ends in light 1, whatever way it took.
TEST(HeavyFurnace, BunnyVanishes)
{
    const ReferenceFiles files = find_reference("furnace_bunny");
    if (files.scene.empty()) GTEST_SKIP() << "furnace_bunny is left out: its bunny is not part of the project";
    RenderSettings settings;
    settings.width = settings.height = size;
    settings.spp = 8;
    const Film film = render(load_scene(files.scene), settings).film;
    for (std::size_t i = 0; i < film.sum.size(); ++i)
        ASSERT_EQ(film.sum[i] / static_cast<float>(film.sample_count[i]), vec3(1.0f)) << "pixel " << i;
}

} // namespace
} // namespace snell::test
