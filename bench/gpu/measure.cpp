#include "bench/gpu/measure.h"

#include "snell/core/timer.h"
#include "snell/lab/ray_sets.h"
#include "snell/render/params.h"
#include "snell/vulkan/trace_rays.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <numeric>

namespace snell::bench {
namespace {

double median(std::vector<double> values)
{
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

// Seconds of each run of a device's commands but the first, by the device's clock where it has one.
template <class Record>
std::vector<double> time_commands(Gpu& gpu, int runs, const Record& record)
{
    std::vector<double> seconds;
    for (int i = 0; i < runs + 1; ++i) {
        Gpu::Commands commands(gpu, 2);
        commands.begin();
        commands.stamp(0);
        record(commands);
        commands.barrier();
        commands.stamp(1);
        const Timer timer;
        commands.run();
        const double wall = timer.seconds(), own = commands.seconds(0, 1);
        if (i > 0) seconds.push_back(own > 0 ? own : wall);
    }
    return seconds;
}

RenderSettings on_device(const Measuring& job, const char* accel)
{
    RenderSettings settings;
    settings.device = job.device;
    settings.accel = accel;
    return settings;
}

VulkanScene& device_of(const Prepared& prepared)
{
    return dynamic_cast<VulkanScene&>(*prepared.device);
}

double mib(std::size_t bytes)
{
    return static_cast<double>(bytes) / 0x1p20;
}

} // namespace

Ceilings measure_ceilings(Gpu& gpu, int runs)
{
    const std::size_t bytes = gpu.is_processor() ? std::size_t{64} << 20 : std::size_t{1} << 30;
    const GpuBuffer from(gpu, bytes, GpuBuffer::Placement::device, "measuring"),
        to(gpu, bytes, GpuBuffer::Placement::device, "measuring");
    Ceilings ceilings;
    ceilings.bytes_per_second =
        2.0 * static_cast<double>(bytes) / median(time_commands(gpu, runs, [&](Gpu::Commands& commands) {
            const VkBufferCopy copy{0, 0, bytes};
            vkCmdCopyBuffer(commands.handle, from.handle, to.handle, 1, &copy);
        }));
    const struct
    {
        VkDeviceAddress result;
        std::uint32_t rounds;
    } push = {to.address, 128};
    const std::size_t items = std::size_t{1} << (gpu.is_processor() ? 14 : 21);
    const GpuKernel kernel = gpu.kernel("arithmetic");
    ceilings.flops_per_second = 2.0 * 128.0 * push.rounds * static_cast<double>(items) /
                                median(time_commands(gpu, runs, [&](Gpu::Commands& commands) {
                                    commands.bind(kernel);
                                    commands.push(&push, sizeof(push.result) + sizeof(push.rounds));
                                    commands.dispatch(items);
                                }));
    return ceilings;
}

nlohmann::json measure_rays(const Measuring& job, const Scene& scene, const Ceilings& ceilings)
{
    const auto wide = prepare(scene, on_device(job, "bvh8q"));
    const auto binary = prepare(scene, on_device(job, "bvh2"));
    RenderSettings settings;
    settings.accel = "bvh8";
    const auto on_cpu = prepare(scene, settings);

    RaySetOptions options;
    options.rays = job.rays;
    settings.width = settings.height = ray_set_side(options.rays);
    const IntegratorInfo& path = *find_integrator("path");
    const Camera camera = make_render_params(settings, path, on_cpu->camera, on_cpu->packed.radius).camera;
    nlohmann::json result;
    fmt::print("  {:<10} {:>9} {:>10} {:>10} {:>10} {:>10} {:>10} {:>7} {:>9} {:>9}\n", "Mrays/s", "rays", "8-wide",
               "binary", "processor", "8w/binary", "8w/proc.", "steps", "memory", "arithm.");
    for (const RaySet& set : make_ray_sets(on_cpu->packed, camera, *on_cpu->accel, options)) {
        if (set.rays.empty()) continue;
        RayBatch eight(device_of(*wide), set.rays), two(device_of(*binary), set.rays);
        std::vector<Hit> hits(set.rays.size());
        std::vector<std::uint8_t> blocked(set.rays.size());
        std::vector<double> times[3];
        const auto note = [&](int which, bool counts, const auto& trace) {
            const Timer timer;
            const double seconds = trace(), wall = timer.seconds();
            if (counts) times[which].push_back(seconds > 0 ? seconds : wall);
        };
        for (int run = 0; run < job.runs + 1; ++run) { // they take turns
            for (const int which : {0, 1})
                note(which, run > 0, [&] {
                    RayBatch& batch = which == 0 ? eight : two;
                    return set.any_hit ? batch.occlude() : batch.intersect();
                });
            note(2, run > 0, [&] {
                if (set.any_hit)
                    on_cpu->accel->occluded(set.rays, blocked);
                else
                    on_cpu->accel->intersect(set.rays, hits);
                return 0.0;
            });
        }
        const auto count = static_cast<double>(set.rays.size());
        double rates[3];
        for (int which = 0; which < 3; ++which) rates[which] = count / median(times[which]);
        fmt::print("  {:<10} {:>9} {:>10.2f} {:>10.2f} {:>10.2f} {:>10.2f} {:>10.3f}", set.name, set.rays.size(),
                   1e-6 * rates[0], 1e-6 * rates[1], 1e-6 * rates[2], rates[0] / rates[1], rates[0] / rates[2]);
        nlohmann::json& row = result[set.name];
        row = {{"rays", set.rays.size()}, {"wide", rates[0]}, {"binary", rates[1]}, {"processor", rates[2]}};
        if (!set.any_hit) { // steps are counted for nearest hits
            std::vector<uint> steps(set.rays.size());
            wide->accel->intersect_counted(set.rays, hits, steps);
            const double each = std::accumulate(steps.begin(), steps.end(), 0.0) / count;
            row["steps"] = each;
            fmt::print(" {:>7.1f} {:>8.1f}% {:>8.1f}%", each,
                       100 * rates[0] * each * bytes_per_step / ceilings.bytes_per_second,
                       100 * rates[0] * each * flops_per_step / ceilings.flops_per_second);
        }
        fmt::print("\n");
        std::fflush(stdout);
    }
    return result;
}

nlohmann::json measure_trees(const Measuring& job, const Scene& scene)
{
    nlohmann::json result;
    const auto print = [&](const char* name, const AccelStats& stats, const std::vector<double>& build,
                           const std::vector<double>& refit) {
        fmt::print("  {:<22} built in {:8.1f} ms, cost {:6.1f}, {:7.1f} MiB; refitted in {:7.1f} ms\n", name,
                   1e3 * median(build), stats.sah_cost, mib(stats.bytes), 1e3 * median(refit));
        std::fflush(stdout);
        result[name] = {{"build_seconds", median(build)},
                        {"sah_cost", stats.sah_cost},
                        {"bytes", stats.bytes},
                        {"refit_seconds", median(refit)}};
    };
    RenderSettings settings = on_device(job, "bvh8q");
    settings.parameters["build_on"] = "gpu";
    const auto prepared = prepare(scene, settings);
    const PackedScene& packed = prepared->packed;
    PackedChanges everything;
    everything.world = everything.instances = true;
    for (uint i = 0; i < packed.groups.size(); ++i) everything.groups.push_back(i);
    AccelOptions options;
    const AccelInfo& layout = *find_accel("bvh8q");
    const std::shared_ptr<Gpu> gpu = device_of(*prepared).gpu();
    const int runs = std::min(job.runs, 3);

    for (const char* builder : {"auto", "ploc"}) {
        options.update = UpdatePolicy::refit;
        options.build.builder = builder;
        std::vector<double> build, refit;
        std::unique_ptr<Accel> accel;
        for (int run = 0; run < runs; ++run) {
            accel.reset();
            accel = layout.make(packed, options);
            build.push_back(accel->stats.build_seconds);
        }
        const AccelStats stats = accel->stats;
        for (int run = 0; run < runs; ++run) {
            accel->update(everything);
            refit.push_back(accel->stats.build_seconds);
        }
        print(fmt::format("processor, {}", builder).c_str(), stats, build, refit);
    }
    std::vector<double> build, refit;
    AccelStats stats;
    for (int run = 0; run < runs + 1; ++run) { // kernels are made ready in the first
        options.update = UpdatePolicy::rebuild;
        VulkanScene built(gpu, packed, layout, options, nullptr);
        stats = built.tree_stats;
        built.update(everything);
        options.update = UpdatePolicy::refit;
        VulkanScene refitted(gpu, packed, layout, options, nullptr);
        refitted.update(everything);
        if (run == 0) continue;
        build.push_back(built.tree_stats.build_seconds);
        refit.push_back(refitted.tree_stats.build_seconds);
    }
    print("device", stats, build, refit);
    return result;
}

namespace {

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

nlohmann::json print_frame(const char* name, const std::vector<Frame>& frames)
{
    std::vector<double> seconds;
    for (const Frame& frame : frames) seconds.push_back(frame.seconds);
    const double middle = median(seconds);
    const RenderStats& s = frames.back().stats;
    const double parts[] = {s.generate_seconds, s.extend_seconds, s.shade_seconds, s.connect_seconds,
                            s.finalize_seconds};
    const double all = std::accumulate(std::begin(parts), std::end(parts), 0.0);
    const auto part = [&](int i) { return all > 0 ? 100 * parts[i] / all : 0; };
    fmt::print("  {:<22} {:8.1f} ms a frame, {:8.3f} Msamples/s, {:8.2f} Mrays/s; generate {:.0f}%, extend {:.0f}%, "
               "shade {:.0f}%, connect {:.0f}%, finalize {:.0f}%\n",
               name, 1e3 * middle, 1e-6 * static_cast<double>(s.samples) / middle,
               1e-6 * static_cast<double>(s.rays()) / middle, part(0), part(1), part(2), part(3), part(4));
    std::fflush(stdout);
    return {{"seconds", middle}, {"samples", s.samples}, {"rays", s.rays()}, {"stage_seconds", parts}};
}

} // namespace

nlohmann::json measure_frames(const Measuring& job, const Scene& scene)
{
    RenderSettings settings;
    settings.width = job.width;
    settings.height = job.height;
    settings.spp = 1;
    settings.parameters["max_depth"] = "8";
    const auto on_cpu = prepare(scene, settings);
    RenderSettings gpu_settings = settings;
    gpu_settings.device = job.device;
    const auto on_gpu = prepare(scene, gpu_settings);
    std::vector<Frame> frames[2];
    for (int run = 0; run < job.runs + 1; ++run) { // they take turns
        const Frame gpu = render_frame(*on_gpu, gpu_settings), cpu = render_frame(*on_cpu, settings);
        if (run > 0) frames[0].push_back(gpu), frames[1].push_back(cpu);
    }
    nlohmann::json result;
    result["device"] = print_frame("device", frames[0]);
    result["processor"] = print_frame("processor", frames[1]);
    return result;
}

} // namespace snell::bench
