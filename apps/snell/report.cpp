#include "report.h"

#include "console.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <sys/resource.h>

namespace snell::app {

std::size_t peak_memory_bytes()
{
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<std::size_t>(usage.ru_maxrss) * 1024; // Linux counts in KiB
}

static double per_second(std::uint64_t count, double seconds)
{
    return seconds > 0.0 ? static_cast<double>(count) / seconds : 0.0;
}

static std::string counted(std::uint64_t count)
{
    const std::string text = short_count(static_cast<double>(count));
    return text.ends_with(' ') ? text : text + ' ';
}

std::string closing_line(const RenderReport& report)
{
    const RenderStats& stats = report.result.stats;
    return fmt::format(
        "{}rays ({}camera, {}extension, {}shadow) in {}: {}rays/s, {}samples/s; build {}, peak memory {}",
        counted(stats.rays()), counted(stats.camera_rays), counted(stats.extension_rays), counted(stats.shadow_rays),
        short_time(stats.render_seconds), short_count(per_second(stats.rays(), stats.render_seconds)),
        short_count(per_second(stats.samples, stats.render_seconds)), short_time(stats.build_seconds),
        short_bytes(static_cast<double>(peak_memory_bytes())));
}

std::string update_line(const RenderStats& stats)
{
    return fmt::format("followed what moved in {:.1f} ms; {} tree{} refitted and {} rebuilt in {:.1f} ms",
                       1e3 * stats.pack_seconds, stats.refitted_trees, stats.refitted_trees == 1 ? "" : "s",
                       stats.rebuilt_trees, 1e3 * stats.build_seconds);
}

std::vector<std::string> stats_lines(const RenderReport& report)
{
    const RenderStats& stats = report.result.stats;
    const double all = stats.generate_seconds + stats.extend_seconds + stats.shade_seconds + stats.connect_seconds +
                       stats.finalize_seconds;
    const auto share = [&](double seconds) { return all > 0.0 ? 100.0 * seconds / all : 0.0; };
    const auto bytes = static_cast<double>(stats.scene_bytes + stats.accel_bytes);

    std::vector<std::string> lines;
    lines.push_back(
        fmt::format("stages: generate {:.1f}%, extend {:.1f}%, shade {:.1f}%, connect {:.1f}%, finalize {:.1f}%",
                    share(stats.generate_seconds), share(stats.extend_seconds), share(stats.shade_seconds),
                    share(stats.connect_seconds), share(stats.finalize_seconds)));
    lines.push_back(fmt::format("time: load {}, pack {}, build {}, render {}", short_time(stats.load_seconds),
                                short_time(stats.pack_seconds), short_time(stats.build_seconds),
                                short_time(stats.render_seconds)));
    if (stats.updated) lines.push_back("update: " + update_line(stats));
    lines.push_back(fmt::format(
        "memory: scene {}, acceleration structure {}{}", short_bytes(static_cast<double>(stats.scene_bytes)),
        short_bytes(static_cast<double>(stats.accel_bytes)),
        report.triangles ? fmt::format("; {:.0f} bytes a triangle for {}triangles",
                                       bytes / static_cast<double>(report.triangles), counted(report.triangles))
                         : std::string()));
    return lines;
}

std::string stats_json(const RenderReport& report)
{
    const RenderStats& stats = report.result.stats;
    const RenderSettings& settings = report.job.settings;
    nlohmann::ordered_json json;
    json["scene"] = report.job.scene.name;
    if (report.job.frame) {
        json["frame"] = *report.job.frame;
        json["time"] = report.job.frames->seconds(*report.job.frame);
    } else if (report.job.scene.time) {
        json["time"] = *report.job.scene.time;
    }
    json["integrator"] = settings.integrator;
    json["width"] = settings.width;
    json["height"] = settings.height;
    json["spp"] = report.spp_done;
    json["complete"] = !stats.cancelled;
    for (const auto& output : report.job.outputs) json["outputs"].push_back(output.string());
    json["rays"] = {{"camera", stats.camera_rays}, {"extension", stats.extension_rays}, {"shadow", stats.shadow_rays}};
    json["samples"] = stats.samples;
    json["rays_per_second"] = per_second(stats.rays(), stats.render_seconds);
    json["samples_per_second"] = per_second(stats.samples, stats.render_seconds);
    json["seconds"] = {
        {"load", stats.load_seconds},     {"pack", stats.pack_seconds},         {"build", stats.build_seconds},
        {"render", stats.render_seconds}, {"generate", stats.generate_seconds}, {"extend", stats.extend_seconds},
        {"shade", stats.shade_seconds},   {"connect", stats.connect_seconds},   {"finalize", stats.finalize_seconds}};
    if (stats.updated) json["trees"] = {{"refitted", stats.refitted_trees}, {"rebuilt", stats.rebuilt_trees}};
    json["triangles"] = report.triangles;
    json["scene_bytes"] = stats.scene_bytes;
    json["accel_bytes"] = stats.accel_bytes;
    json["peak_memory_bytes"] = peak_memory_bytes();
    json["dropped_samples"] = report.result.film.dropped_samples;
    // File names need not be UTF-8.
    return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

} // namespace snell::app
