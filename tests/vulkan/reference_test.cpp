// The scenes of tests/image/reference, and all that are built in, on the GPU: the CPU's paths where the random numbers
// are the same, its means where they are others, and the means of pbrt's converged pictures.
#include "snell/io/image/read.h"
#include "snell/io/load.h"
#include "tests/image/reference_files.h"
#include "tests/vulkan/pictures.h"

namespace snell::test {
namespace {

constexpr int small = 64; // pixels a side, where the references have 256

struct GpuReference
{
    const char* name;
    uint spp;
};

RenderSettings small_square(uint spp, uint seed)
{
    RenderSettings settings;
    settings.width = settings.height = small;
    settings.spp = spp;
    settings.seed = seed;
    settings.sampler = "independent"; // its variance can be estimated from one picture
    return settings;
}

// Of many blocks about one in 400 is beyond three standard errors by chance, and a few more where light comes seldom.
void expect_same_means(const Blocks& blocks)
{
    EXPECT_LE(blocks.beyond_three, blocks.count / 50) << blocks.worst;
    EXPECT_EQ(blocks.beyond_five, 0) << blocks.worst;
    EXPECT_LT(blocks.rms(), blocks.rms_limit()) << blocks.worst;
}

class GpuReferences : public testing::TestWithParam<GpuReference>
{
};

INSTANTIATE_TEST_SUITE_P(, GpuReferences,
                         testing::Values(GpuReference{"cornell_diffuse", 48}, GpuReference{"cornell", 512},
                                         GpuReference{"veach_mis", 64}, GpuReference{"glass_checker", 48},
                                         GpuReference{"env_bunny", 32}),
                         [](const auto& reference) { return std::string(reference.param.name); });

TEST_P(GpuReferences, PathsAndMeansAreTheCpusAndTheReferences)
{
    SNELL_NEEDS_GPU();
    const auto [scene_file, picture_file] = find_reference(GetParam().name);
    if (scene_file.empty()) GTEST_SKIP() << GetParam().name << " is left out: its bunny is not part of the project";
    const Scene scene = load_scene(scene_file);
    expect_same_picture(scene, small_square(1, 1));

    const Film cpu = render(scene, small_square(GetParam().spp, 2)).film;
    const Film gpu = render(scene, gpu_settings(small_square(GetParam().spp, 3))).film;
    {
        SCOPED_TRACE("beside the CPU's");
        expect_same_means(compare_blocks(cpu, gpu));
    }

    // A pixel is the mean over its square: 4x4 pixels of the reference.
    const Picture reference = read_picture(picture_file);
    ASSERT_EQ(reference.width, 4 * small);
    ASSERT_EQ(reference.height, 4 * small);
    Blocks blocks;
    double total = 0, total_reference = 0, total_variance = 0;
    for (int y0 = 0; y0 < small; y0 += 8)
        for (int x0 = 0; x0 < small; x0 += 8) {
            double difference = 0, variance = 0, one_sample = 0;
            for (int y = y0; y < y0 + 8; ++y)
                for (int x = x0; x < x0 + 8; ++x) {
                    const auto i = static_cast<std::size_t>(y * small + x);
                    double mean = 0;
                    for (int j = 0; j < 16; ++j)
                        mean +=
                            double{
                                reference
                                    .pixels[static_cast<std::size_t>((4 * y + j / 4) * reference.width + 4 * x + j % 4)]
                                    .y} /
                            16;
                    const double ours = double{gpu.sum[i].y} / gpu.sample_count[i];
                    difference += ours - mean;
                    one_sample += mean / 64 / gpu.sample_count[i];
                    variance += gpu.mean_variance(i);
                    total += ours;
                    total_reference += mean;
                    total_variance += gpu.mean_variance(i);
                }
            blocks.add(x0, y0, difference, variance, one_sample);
        }
    SCOPED_TRACE("beside the reference");
    expect_same_means(blocks);
    EXPECT_NEAR(total, total_reference, 4 * std::sqrt(total_variance)) << "total energy";
    EXPECT_LT(std::sqrt(total_variance), 0.03 * total_reference) << "too noisy to tell anything";
}

TEST(GpuMeans, OfEveryBuiltInSceneAreTheCpus)
{
    SNELL_NEEDS_GPU();
    Blocks all;
    for (const BuiltinScene& builtin : builtin_scenes()) {
        SCOPED_TRACE(builtin.name);
        const Scene scene = small_builtin(builtin);
        RenderSettings settings = small_square(32, 4);
        settings.width = settings.height = 32;
        const Film cpu = render(scene, settings).film;
        settings.seed = 5;
        const Blocks blocks = compare_blocks(cpu, render(scene, gpu_settings(settings)).film);
        EXPECT_LE(blocks.beyond_three, 1) << blocks.worst; // of 16
        EXPECT_EQ(blocks.beyond_five, 0) << blocks.worst;
        all.count += blocks.count;
        all.square_sum += blocks.square_sum;
    }
    EXPECT_LT(all.rms(), 1.15); // and the rest are as far off as noise makes them
    EXPECT_GT(all.rms(), 0.7);
}

TEST(GpuDirect, IsThePathTracerWithOneBounce)
{
    SNELL_NEEDS_GPU();
    RenderSettings settings = gpu_settings(one_sample("direct"));
    const Film direct = render(mixed_scene(), settings).film;
    settings.integrator = "path";
    const Film path = render(mixed_scene(), settings).film;
    EXPECT_FALSE(same_bits(direct.sum, path.sum));
    settings.parameters["max_depth"] = "1";
    EXPECT_TRUE(same_bits(direct.sum, render(mixed_scene(), settings).film.sum));
}

} // namespace
} // namespace snell::test
