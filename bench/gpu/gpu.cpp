// Measures what a GPU makes of rays and pictures, beside this machine's processor, in one run.
//
//     bench_gpu [--device NAME] [--rays N] [--size WxH] [--runs N] [--eye X,Y,Z --target X,Y,Z --fov DEGREES]
//     [SCENE...]
//
// For each scene: Mrays/s of camera rays, shadow rays, ambient occlusion and three diffuse bounces
// (snell/lab/ray_sets.h) by the device's clock, in trees of quantised 8-wide nodes and of plain binary ones, and by all
// threads of the processor; then pictures with one sample a pixel and 8 bounces: time of a frame, samples and rays a
// second, and what the stages take. Medians of the runs; device and processor take turns.
#include "snell/core/error.h"
#include "snell/core/timer.h"
#include "snell/io/load.h"
#include "snell/lab/ray_sets.h"
#include "snell/render/params.h"
#include "snell/render/rendering.h"
#include "snell/scene/builtin.h"
#include "snell/vulkan/trace_rays.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <optional>

using namespace snell;

namespace {

struct Job
{
    std::string device = "gpu";
    std::size_t rays = 0; // 0: as many as suit the device
    int width = 1920, height = 1080;
    int runs = 5;
    std::optional<vec3> eye, target;
    std::optional<float> fov;
    std::vector<std::string> scenes;
};

double median(std::vector<double> values)
{
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

std::vector<float> numbers_of(const std::string& option, const std::string& text, char separator, std::size_t count)
{
    std::vector<float> numbers;
    const char* at = text.c_str();
    for (;;) {
        char* end = nullptr;
        numbers.push_back(std::strtof(at, &end));
        if (end == at || (*end != separator && *end != '\0'))
            throw Error(fmt::format("{} {}: that is no list of numbers", option, text));
        if (*end == '\0') break;
        at = end + 1;
    }
    if (numbers.size() != count) throw Error(fmt::format("{} {}: {} numbers are wanted", option, text, count));
    return numbers;
}

Job parse(int argc, char** argv)
{
    Job job;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        if (!word.starts_with("--")) {
            job.scenes.push_back(word);
            continue;
        }
        if (i + 1 == argc) throw Error(word + " wants a value");
        const std::string value = argv[++i];
        const auto vector = [&] {
            const auto n = numbers_of(word, value, ',', 3);
            return vec3(n[0], n[1], n[2]);
        };
        if (word == "--device") {
            job.device = value;
        } else if (word == "--rays") {
            job.rays = static_cast<std::size_t>(numbers_of(word, value, ',', 1)[0]);
        } else if (word == "--runs") {
            job.runs = std::max(1, static_cast<int>(numbers_of(word, value, ',', 1)[0]));
        } else if (word == "--size") {
            const auto n = numbers_of(word, value, 'x', 2);
            job.width = static_cast<int>(n[0]), job.height = static_cast<int>(n[1]);
        } else if (word == "--eye") {
            job.eye = vector();
        } else if (word == "--target") {
            job.target = vector();
        } else if (word == "--fov") {
            job.fov = numbers_of(word, value, ',', 1)[0];
        } else {
            throw Error("there is no option " + word, "see the head of bench/gpu/gpu.cpp");
        }
    }
    if (!is_device_name(job.device) || job.device == "cpu" || job.device == "auto")
        throw Error("--device: give gpu or gpu:N");
    if (job.scenes.empty()) job.scenes = {"cornell", "sphereflake:5", "field:200000"};
    return job;
}

Scene open_scene(const Job& job, const std::string& name)
{
    std::optional<Scene> builtin = make_builtin_scene(name);
    Scene scene = builtin ? std::move(*builtin) : load_scene(name);
    complete(scene, static_cast<float>(job.width) / static_cast<float>(job.height));
    CameraDesc& camera = scene.cameras.front();
    if (job.eye) camera.eye = *job.eye;
    if (job.target) camera.target = *job.target;
    if (job.fov) camera.fov_degrees = *job.fov;
    return scene;
}

// Bytes that the device copies in its own memory a second, each counted once read and once written: the ceiling of
// everything that waits for memory.
double copied_bytes(Gpu& gpu, int runs)
{
    const std::size_t bytes = gpu.is_processor() ? std::size_t{64} << 20 : std::size_t{1} << 30;
    const GpuBuffer from(gpu, bytes, GpuBuffer::Placement::device, "measuring"),
        to(gpu, bytes, GpuBuffer::Placement::device, "measuring");
    std::vector<double> seconds;
    for (int i = 0; i < runs + 1; ++i) {
        Gpu::Commands commands(gpu);
        commands.begin();
        const VkBufferCopy copy{0, 0, bytes};
        vkCmdCopyBuffer(commands.handle, from.handle, to.handle, 1, &copy);
        const Timer timer;
        commands.run();
        if (i > 0) seconds.push_back(timer.seconds());
    }
    return 2.0 * static_cast<double>(bytes) / median(seconds);
}

void measure_rays(const Job& job, const Scene& scene)
{
    RenderSettings settings;
    settings.device = job.device;
    settings.accel = "bvh8q";
    const auto wide = prepare(scene, settings);
    settings.accel = "bvh2";
    const auto binary = prepare(scene, settings);
    settings.device = "cpu";
    settings.accel = "bvh8";
    const auto on_cpu = prepare(scene, settings);
    auto& device = dynamic_cast<VulkanScene&>(*wide->device);
    auto& plain = dynamic_cast<VulkanScene&>(*binary->device);

    RaySetOptions options;
    options.rays = job.rays > 0 ? job.rays : device.gpu()->is_processor() ? std::size_t{1} << 16 : std::size_t{1} << 21;
    settings.width = settings.height = ray_set_side(options.rays);
    const IntegratorInfo& path = *find_integrator("path");
    const Camera camera = make_render_params(settings, path, on_cpu->camera, on_cpu->packed.radius).camera;
    fmt::print("  {:<10} {:>9} {:>12} {:>12} {:>12} {:>10} {:>10}\n", "Mrays/s", "rays", "8-wide", "binary",
               "processor", "8w/binary", "8w/proc.");
    for (const RaySet& set : make_ray_sets(on_cpu->packed, camera, *on_cpu->accel, options)) {
        if (set.rays.empty()) continue;
        RayBatch eight(device, set.rays), two(plain, set.rays);
        std::vector<Hit> hits(set.rays.size());
        std::vector<std::uint8_t> blocked(set.rays.size());
        const auto on_device = [&](RayBatch& batch) {
            const Timer timer;
            const double seconds = set.any_hit ? batch.occlude() : batch.intersect();
            return seconds > 0 ? seconds : timer.seconds();
        };
        std::vector<double> times[3];
        for (int run = 0; run < job.runs + 1; ++run) {
            const double a = on_device(eight), b = on_device(two);
            const Timer timer;
            if (set.any_hit)
                on_cpu->accel->occluded(set.rays, blocked);
            else
                on_cpu->accel->intersect(set.rays, hits);
            const double c = timer.seconds();
            if (run > 0) times[0].push_back(a), times[1].push_back(b), times[2].push_back(c);
        }
        const auto rate = [&](int which) { return 1e-6 * static_cast<double>(set.rays.size()) / median(times[which]); };
        fmt::print("  {:<10} {:>9} {:>12.2f} {:>12.2f} {:>12.2f} {:>10.2f} {:>10.3f}\n", set.name, set.rays.size(),
                   rate(0), rate(1), rate(2), rate(0) / rate(1), rate(0) / rate(2));
        std::fflush(stdout);
    }
    fmt::print("  on the device: {:.1f} MiB 8-wide, {:.1f} MiB binary; copied in {:.1f} ms\n",
               static_cast<double>(device.bytes()) / 0x1p20, static_cast<double>(plain.bytes()) / 0x1p20,
               1e3 * device.upload_seconds);
}

struct Frame
{
    double seconds = 0;
    RenderStats stats;
};

Frame render_frame(const Prepared& prepared, const RenderSettings& settings)
{
    Rendering rendering(prepared, settings, prepared.camera);
    const Timer timer;
    rendering.add_samples(rendering.region(), 0, 1, [] { return true; });
    return {timer.seconds(), rendering.stats()};
}

void print_frame(const char* name, const std::vector<Frame>& frames)
{
    std::vector<double> seconds;
    for (const Frame& frame : frames) seconds.push_back(frame.seconds);
    const double middle = median(seconds);
    const RenderStats& s = frames.back().stats;
    const double all = s.generate_seconds + s.extend_seconds + s.shade_seconds + s.connect_seconds + s.finalize_seconds;
    const auto part = [&](double x) { return all > 0 ? 100 * x / all : 0; };
    fmt::print(
        "  {:<10} {:9.1f} ms a frame, {:8.3f} Msamples/s, {:8.2f} Mrays/s; generate {:.0f}%, extend {:.0f}%, shade "
        "{:.0f}%, connect {:.0f}%, finalize {:.0f}%\n",
        name, 1e3 * middle, 1e-6 * static_cast<double>(s.samples) / middle,
        1e-6 * static_cast<double>(s.rays()) / middle, part(s.generate_seconds), part(s.extend_seconds),
        part(s.shade_seconds), part(s.connect_seconds), part(s.finalize_seconds));
    std::fflush(stdout);
}

void measure_frames(const Job& job, const Scene& scene)
{
    RenderSettings settings;
    settings.width = job.width;
    settings.height = job.height;
    settings.spp = 1;
    settings.parameters["max_depth"] = "8";
    const auto on_cpu = prepare(scene, settings);
    RenderSettings on_device = settings;
    on_device.device = job.device;
    const auto on_gpu = prepare(scene, on_device);
    std::vector<Frame> frames[2];
    for (int run = 0; run < job.runs + 1; ++run) {
        const Frame gpu = render_frame(*on_gpu, on_device), cpu = render_frame(*on_cpu, settings);
        if (run > 0) frames[0].push_back(gpu), frames[1].push_back(cpu);
    }
    print_frame("device", frames[0]);
    print_frame("processor", frames[1]);
}

} // namespace

int main(int argc, char** argv)
{
    try {
        Job job = parse(argc, argv);
        const DeviceChoice choice = choose_device(job.device);
        job.device = choice.device;
        const std::shared_ptr<Gpu> gpu = Gpu::open(job.device);
        if (gpu->is_processor() && job.width == 1920 && job.height == 1080) job.width = 480, job.height = 270;
        fmt::print("{}, {}; copies {:.1f} GB/s (read and written); pictures of {}x{}; medians of {}\n", choice.reason,
                   gpu->info().info.driver, 1e-9 * copied_bytes(*gpu, job.runs), job.width, job.height, job.runs);
        for (const std::string& name : job.scenes) {
            const Scene scene = open_scene(job, name);
            fmt::print("{}\n", name);
            measure_rays(job, scene);
            measure_frames(job, scene);
        }
    } catch (const Error& error) {
        fmt::print(stderr, "bench_gpu: error: {}\n", error.what());
        return 1;
    }
    return 0;
}
