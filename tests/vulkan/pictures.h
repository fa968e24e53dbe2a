// Pictures of the GPU backend beside those of the CPU backend.
#pragma once

#include "snell/scene/builtin.h"
#include "tests/render/scenes.h"
#include "tests/vulkan/gpu_test.h"

#include <cmath>

namespace snell::test {

inline RenderSettings gpu_settings(RenderSettings settings)
{
    settings.device = test_device();
    return settings;
}

// A pixel agrees if its colour does to a part in a thousand: rounding differs along a path of several surfaces. Where a
// comparison of floats goes the other way (an edge, a lobe, the roulette), a path goes its own way from there on.
inline bool agree(vec3 a, vec3 b)
{
    for (int i = 0; i < 3; ++i)
        if (!(std::abs(a[i] - b[i]) <= 1e-3f * std::max(std::abs(a[i]), std::abs(b[i])) + 1e-5f)) return false;
    return true;
}

inline double share_of_others(const std::vector<vec3>& a, const std::vector<vec3>& b)
{
    std::size_t others = 0;
    for (std::size_t i = 0; i < a.size(); ++i) others += !agree(a[i], b[i]);
    return static_cast<double>(others) / static_cast<double>(a.size());
}

// Less than half a percent of pixels with one sample may be other paths.
inline void expect_same_picture(const Scene& scene, RenderSettings settings, double allowed = 0.005)
{
    SCOPED_TRACE(settings.integrator);
    settings.accel = "bvh8q";
    const RenderResult on_cpu = render(scene, settings);
    const RenderResult on_gpu = render(scene, gpu_settings(settings));
    ASSERT_EQ(on_gpu.film.sample_count, on_cpu.film.sample_count);
    EXPECT_LT(share_of_others(on_gpu.film.sum, on_cpu.film.sum), allowed);
    EXPECT_EQ(on_gpu.stats.camera_rays, on_cpu.stats.camera_rays);
    EXPECT_EQ(on_gpu.stats.samples, on_cpu.stats.samples);
    const auto close = [](std::uint64_t a, std::uint64_t b) {
        return std::abs(static_cast<double>(a) - static_cast<double>(b)) <= 0.01 * static_cast<double>(b) + 8;
    };
    EXPECT_TRUE(close(on_gpu.stats.extension_rays, on_cpu.stats.extension_rays))
        << on_gpu.stats.extension_rays << " " << on_cpu.stats.extension_rays;
    EXPECT_TRUE(close(on_gpu.stats.shadow_rays, on_cpu.stats.shadow_rays))
        << on_gpu.stats.shadow_rays << " " << on_cpu.stats.shadow_rays;
    EXPECT_EQ(on_gpu.film.dropped_samples, on_cpu.film.dropped_samples);
    EXPECT_EQ(on_gpu.film.seen_through, on_cpu.film.seen_through);
}

inline RenderSettings one_sample(const std::string& integrator)
{
    RenderSettings settings;
    settings.width = 56;
    settings.height = 40;
    settings.spp = 1;
    settings.integrator = integrator;
    return settings;
}

inline Scene small_builtin(const BuiltinScene& builtin)
{
    Scene scene = builtin.make_with != nullptr ? builtin.make_with(builtin.name == "field"         ? 2000
                                                                   : builtin.name == "many-lights" ? 40
                                                                                                   : 3)
                                               : builtin.make();
    complete(scene, 1.4f);
    return scene;
}

// Two films with independent random numbers, in blocks of 8x8 pixels: how far apart their means are, in standard
// errors.
struct Blocks
{
    int count = 0, beyond_three = 0, beyond_five = 0;
    double square_sum = 0; // of the differences
    std::string worst;     // the blocks beyond three

    double rms() const { return std::sqrt(square_sum / count); }
    // What chance gives seldom: the squares' sum has a spread of sqrt(2 count).
    double rms_limit() const { return 1 + 4 / std::sqrt(2.0 * count); }
    // The difference and its variance are of sums over the pixels, one_sample what one more would add to these: where
    // something is seen so seldom that a picture has missed it, the variance knows nothing of it.
    void add(int x0, int y0, double difference, double variance, double one_sample)
    {
        const double errors = std::abs(difference) / (std::sqrt(variance) + one_sample + 1e-6);
        ++count;
        square_sum += errors * errors;
        beyond_five += errors > 5 ? 1 : 0;
        if (errors <= 3) return;
        ++beyond_three;
        worst += fmt::format("block {},{}: {:.1f} standard errors\n", x0, y0, errors);
    }
};

inline Blocks compare_blocks(const Film& a, const Film& b)
{
    constexpr int side = 8;
    Blocks blocks;
    for (int y0 = 0; y0 < a.height; y0 += side)
        for (int x0 = 0; x0 < a.width; x0 += side) {
            double difference = 0, variance = 0, one_sample = 0;
            for (int y = y0; y < y0 + side; ++y)
                for (int x = x0; x < x0 + side; ++x) {
                    const auto i = static_cast<std::size_t>(y * a.width + x);
                    const double of_a = static_cast<double>(luminance(a.sum[i])) / a.sample_count[i];
                    difference += static_cast<double>(luminance(b.sum[i])) / b.sample_count[i] - of_a;
                    one_sample += of_a / (side * side) / a.sample_count[i];
                    variance += a.mean_variance(i) + b.mean_variance(i);
                }
            blocks.add(x0, y0, difference, variance, one_sample);
        }
    return blocks;
}

} // namespace snell::test
