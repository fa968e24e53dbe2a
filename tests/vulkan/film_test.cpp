// The film on the device: what comes to the host and when, and the settings that pictures do not depend on.
#include "snell/core/timer.h"
#include "snell/render/params.h"
#include "snell/render/rendering.h"
#include "snell/vulkan/backend.h"
#include "tests/render/scenes.h"
#include "tests/vulkan/gpu_test.h"

#include <limits>
#include <numeric>

namespace snell::test {
namespace {

const std::function<bool()> go_on = [] { return true; };

RenderSettings settings_for(const std::string& integrator)
{
    RenderSettings settings = small_picture(integrator);
    settings.device = test_device();
    return settings;
}

// A backend that can be looked into.
struct Bare
{
    Bare(const Prepared& prepared, const RenderSettings& asked)
        : settings(asked), integrator(*find_integrator(asked.integrator)),
          params(make_render_params(settings, integrator, prepared.camera, prepared.packed.radius)),
          film(settings.width, settings.height, settings.layers),
          owned(prepared.device->make_backend({prepared.packed, *prepared.accel, params, settings, integrator})),
          backend(dynamic_cast<VulkanBackend&>(*owned)), region{0, 0, settings.width, settings.height}
    {
    }

    const RenderSettings settings;
    const IntegratorInfo& integrator;
    const ReadyParams params;
    Film film;
    const std::unique_ptr<Backend> owned;
    VulkanBackend& backend;
    const Region region;
};

std::uint64_t samples_of(const Film& film)
{
    return std::accumulate(film.sample_count.begin(), film.sample_count.end(), std::uint64_t{0});
}

TEST(GpuFilm, ComesToTheHostOnceACall)
{
    SNELL_NEEDS_GPU();
    const auto prepared = prepare(mixed_scene(), settings_for("path"));
    Bare bare(*prepared, settings_for("path"));
    const std::size_t bytes = bare.film.sum.size() * (sizeof(PixelSums) + sizeof(GpuPixelLayers));
    { // kernels are compiled, so that nothing takes a second
        Bare first(*prepared, settings_for("path"));
        first.backend.render_samples({0, 0, 8, 8}, 0, 1, first.film, go_on);
    }
    const std::size_t up = bare.backend.film().bytes_up, down = bare.backend.film().bytes_down;
    bare.backend.render_samples(bare.region, 0, 4, bare.film, go_on);
    bare.backend.render_samples(bare.region, 4, 4, bare.film, go_on);
    EXPECT_EQ(bare.backend.film().bytes_down - down, 2 * bytes);
    EXPECT_EQ(bare.backend.film().bytes_up, up); // it was empty, and then the device had it
    bare.backend.render_samples({3, 5, 9, 6}, 8, 1, bare.film, go_on);
    EXPECT_EQ(bare.backend.film().bytes_down - down, 2 * bytes + 6 * (sizeof(PixelSums) + sizeof(GpuPixelLayers)));
}

TEST(GpuFilm, IsTheCallersWhateverTheDeviceHas)
{
    SNELL_NEEDS_GPU();
    for (const char* integrator : {"path", "whitted"}) {
        SCOPED_TRACE(integrator);
        const RenderSettings settings = settings_for(integrator);
        const auto prepared = prepare(mixed_scene(), settings);
        Bare whole(*prepared, settings), first(*prepared, settings), second(*prepared, settings);
        whole.backend.render_samples(whole.region, 0, 9, whole.film, go_on);
        first.backend.render_samples(first.region, 0, 4, first.film, go_on);
        second.backend.render_samples(second.region, 0, 2, second.film, go_on); // something else
        second.film = first.film;
        second.backend.render_samples(second.region, 4, 5, second.film, go_on);
        expect_same_film(whole.film, second.film);
        EXPECT_GT(second.backend.film().bytes_up, 0u);

        first.film.sum[7] += vec3(100.0f); // somebody paints on it
        first.backend.render_samples(first.region, 4, 5, first.film, go_on);
        EXPECT_GT(first.film.sum[7].x, 99.0f);
        EXPECT_TRUE(first.film.sum[8] == whole.film.sum[8]);
        EXPECT_EQ(first.film.sample_count, whole.film.sample_count);
    }
}

TEST(GpuFilm, HasWholePixelsWhenItStops)
{
    SNELL_NEEDS_GPU();
    RenderSettings settings = settings_for("path");
    settings.width = settings.height = 128;
    const auto prepared = prepare(mixed_scene(), settings);
    Bare whole(*prepared, settings), stopped(*prepared, settings);
    whole.backend.render_samples(whole.region, 0, settings.spp, whole.film, go_on);
    int calls = 0;
    std::size_t most = 0;
    stopped.backend.render_samples(stopped.region, 0, settings.spp, stopped.film, [&] {
        most = std::max(most, stopped.backend.handed_over());
        return ++calls < 3;
    });
    EXPECT_EQ(most, 1u); // the device has the next batch already when one is through
    EXPECT_EQ(samples_of(stopped.film), stopped.backend.stats().samples);
    std::size_t done = 0;
    for (std::size_t i = 0; i < stopped.film.sum.size(); ++i) {
        if (stopped.film.sample_count[i] == 0) {
            EXPECT_TRUE(is_black(stopped.film.sum[i]));
            continue;
        }
        ++done;
        ASSERT_EQ(stopped.film.sample_count[i], settings.spp);
        ASSERT_TRUE(stopped.film.sum[i] == whole.film.sum[i]) << "pixel " << i;
        ASSERT_TRUE(stopped.film.layers.position[i] == whole.film.layers.position[i]) << "pixel " << i;
    }
    EXPECT_GT(done, 0u);
    EXPECT_LT(done, stopped.film.sum.size());
    // And it goes on from there, with the pixels that are missing.
    stopped.backend.render_samples({0, 64, 128, 128}, 0, 1, stopped.film, go_on);
    EXPECT_EQ(stopped.film.sample_count.back(), 1u);
}

// Batches of the same pixels follow each other, and paths of a later one may be at their ends first.
TEST(GpuFilm, GetsThePixelsSamplesInTheirOrder)
{
    SNELL_NEEDS_GPU();
    RenderSettings settings = settings_for("path");
    settings.spp = 2048;
    const auto prepared = prepare(mixed_scene(), settings);
    Bare together(*prepared, settings), apart(*prepared, settings);
    const Region few{20, 20, 26, 24};
    together.backend.render_samples(few, 0, settings.spp, together.film, go_on);
    for (uint sample = 0; sample < settings.spp; sample += 64)
        apart.backend.render_samples(few, sample, 64, apart.film, go_on);
    expect_same_film(apart.film, together.film);
    EXPECT_EQ(samples_of(together.film), 24u * settings.spp);
}

TEST(GpuFilm, LeavesOutWhatIsNotFinite)
{
    SNELL_NEEDS_GPU();
    for (const char* integrator : {"path", "whitted"}) {
        SCOPED_TRACE(integrator);
        RenderSettings settings = settings_for(integrator);
        settings.accel = "bvh8q";
        const auto prepared = prepare(mixed_scene(), settings);
        std::unique_ptr<DeviceScene> device; // goes after those who work on it
        for (std::size_t i = 0; i < prepared->packed.materials.size(); i += 2) {
            prepared->packed.materials[i].emission.y = std::numeric_limits<float>::infinity();
            prepared->packed.materials[i].base_color.x = std::numeric_limits<float>::quiet_NaN();
        }
        prepared->device->update({});
        Rendering on_gpu(*prepared, settings, prepared->camera);
        on_gpu.add_samples(on_gpu.region(), 0, 5, go_on);
        on_gpu.add_samples(on_gpu.region(), 5, settings.spp - 5, go_on);
        settings.strict = true;
        Rendering strict(*prepared, settings, prepared->camera);
        try {
            strict.add_samples(strict.region(), 0, settings.spp, go_on);
            ADD_FAILURE() << "nothing was thrown";
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find("is not finite"), std::string::npos) << error.what();
        }
        settings.strict = false;
        std::swap(device, prepared->device);
        Rendering on_cpu(*prepared, settings, prepared->camera);
        on_cpu.add_samples(on_cpu.region(), 0, settings.spp, go_on);
        EXPECT_GT(on_cpu.film.dropped_samples, 0u);
        EXPECT_EQ(on_gpu.film.dropped, on_cpu.film.dropped);
        EXPECT_EQ(samples_of(on_gpu.film) + on_gpu.film.dropped_samples,
                  samples_of(on_cpu.film) + on_cpu.film.dropped_samples);
        EXPECT_NEAR(static_cast<double>(on_gpu.film.dropped_samples), static_cast<double>(on_cpu.film.dropped_samples),
                    0.01 * static_cast<double>(on_cpu.film.dropped_samples));
        for (const vec3& sum : on_gpu.film.sum) ASSERT_TRUE(is_finite3(sum));
    }
}

// A second's work at most is lost, and what is left is told as it is.
TEST(GpuFilm, OfALostDeviceIsWhatHasComeBack)
{
    SNELL_NEEDS_GPU();
    RenderSettings settings = settings_for("path");
    settings.width = settings.height = 96;
    settings.layers = false;
    const auto prepared = prepare(mixed_scene(), settings);
    const std::shared_ptr<Gpu> gpu = Gpu::open(test_device());
    Bare bare(*prepared, settings);
    bare.backend.render_samples(bare.region, 0, 1, bare.film, go_on);
    const Timer timer;
    EXPECT_THROW(bare.backend.render_samples(bare.region, 1, 1'000'000, bare.film,
                                             [&] {
                                                 gpu->acts_lost = timer.seconds() > 2.0;
                                                 return true;
                                             }),
                 DeviceLost);
    gpu->acts_lost = false;
    EXPECT_GT(samples_of(bare.film), bare.film.sum.size());
    EXPECT_EQ(samples_of(bare.film), bare.backend.stats().samples);
    // The device has other samples; the film that it is given counts.
    const std::uint64_t before = samples_of(bare.film);
    bare.backend.render_samples(bare.region, 0, 1, bare.film, go_on);
    EXPECT_EQ(samples_of(bare.film), before + bare.film.sum.size());
}

TEST(GpuFilm, SaysHowMuchMemoryIsMissing)
{
    SNELL_NEEDS_GPU();
    const std::shared_ptr<Gpu> gpu = Gpu::open(test_device());
    const std::size_t pixels = gpu->info().info.memory_bytes / sizeof(PixelSums) + 100'000;
    try {
        DeviceFilm(gpu, pixels, false);
        ADD_FAILURE() << "nothing was thrown";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("the picture"), std::string::npos) << error.what();
    }
}

TEST(GpuOptions, ChangeNoBitOfAPicture)
{
    SNELL_NEEDS_GPU();
    for (const bool is_principled : {false, true})
        for (const char* integrator : {"path", "whitted", "ao"}) {
            if (is_principled && std::string(integrator) != "path") continue; // they take long to compile
            SCOPED_TRACE(std::string(integrator) + (is_principled ? ", principled" : ""));
            RenderSettings settings = settings_for(integrator);
            const Scene scene = is_principled ? principled_scene() : mixed_scene();
            const RenderResult plain = render(scene, settings);
            for (const char* sort : {"none", "material"})
                for (const char* trace : {"stage", "persistent"}) {
                    SCOPED_TRACE(std::string(sort) + ", " + trace);
                    settings.parameters["gpu_sort"] = sort;
                    settings.parameters["gpu_trace"] = trace;
                    const RenderResult other = render(scene, settings);
                    expect_same_film(plain.film, other.film);
                    EXPECT_EQ(plain.stats.rays(), other.stats.rays());
                }
        }
}

TEST(GpuOptions, AreChecked)
{
    RenderSettings settings = small_picture("path"); // on the CPU as well
    settings.parameters["gpu_sort"] = "material";
    settings.parameters["gpu_trace"] = "persistent";
    render(mixed_scene(), settings);
    for (const char* key : {"gpu_sort", "gpu_trace"}) {
        RenderSettings wrong = small_picture("path");
        wrong.parameters[key] = "sometimes";
        EXPECT_THROW(render(mixed_scene(), wrong), Error) << key;
    }
}

} // namespace
} // namespace snell::test
