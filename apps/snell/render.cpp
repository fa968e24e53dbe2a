// snell render: from a scene to picture files.
#include "commands.h"
#include "console.h"
#include "interrupt.h"
#include "picture_layers.h"
#include "render_job.h"
#include "report.h"

#include "snell/core/error.h"
#include "snell/core/parallel.h"
#include "snell/io/load.h"
#include "snell/render/integrator.h"
#include "snell/render/render.h"

#include <fmt/format.h>

#include <chrono>

namespace snell::app {

static double seconds_since(std::chrono::steady_clock::time_point start)
{
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

static Region region_of(const RenderSettings& settings)
{
    return settings.region.value_or(Region{0, 0, settings.width, settings.height});
}

static double mean_spp(const Film& film, const Region& region)
{
    double sum = 0;
    for (int y = region.y0; y < region.y1; ++y)
        for (int x = region.x0; x < region.x1; ++x)
            sum += film.sample_count[static_cast<std::size_t>(y) * static_cast<std::size_t>(film.width) +
                                     static_cast<std::size_t>(x)];
    return sum / (static_cast<double>(region.x1 - region.x0) * (region.y1 - region.y0));
}

static void report_dropped(const Film& film)
{
    if (film.dropped_samples == 0) return;
    std::string where;
    if (!film.dropped.empty()) {
        const auto width = static_cast<std::uint64_t>(film.width);
        where = fmt::format(", the first at pixel {},{}", film.dropped[0] % width, film.dropped[0] / width);
    }
    console().warning(fmt::format("{} samples were not finite and were left out{}; --strict stops at one",
                                  film.dropped_samples, where));
}

// The numbers of a view stand for themselves in a file, whatever the light in the scene asks for.
static DisplayTransform display_of(const RenderJob& job)
{
    const IntegratorInfo* integrator = find_integrator(job.settings.integrator);
    if (!integrator->is_view) return job.display;
    if (job.display.exposure_ev != 0.0f || job.display.curve != tone_none)
        console().info(fmt::format("--exposure and --tone leave the view '{}' as it is", integrator->name));
    return {};
}

int run_render(const Arguments& arguments)
{
    RenderJob job;
    if (const auto code = parse_render(arguments, job)) return *code;
    RenderSettings& settings = job.settings;
    set_thread_count(settings.threads);

    const auto start = std::chrono::steady_clock::now();
    Scene scene = open_scene(job.scene);
    choose_camera(scene, job.camera, static_cast<float>(settings.width) / static_cast<float>(settings.height));
    console().notes(scene);
    const double load_seconds = seconds_since(start);
    console().detail(fmt::format("loaded {} in {}", job.scene, short_time(load_seconds)));

    const CameraDesc camera = scene.cameras[0];
    const std::unique_ptr<Prepared> prepared = prepare(scene, settings);
    scene = Scene{}; // all that rendering needs is packed now
    console().detail(fmt::format("packed in {}, built the acceleration structure in {}",
                                 short_time(prepared->pack_seconds), short_time(prepared->build_seconds)));

    // Until here Ctrl-C simply ends the program: there is nothing to save.
    const InterruptGuard interrupt;
    console().detail(
        fmt::format("rendering {}x{} at {} samples a pixel", settings.width, settings.height, settings.spp));
    RenderResult result;
    {
        ProgressLine line(settings.spp);
        result = render(
            *prepared, settings, [&](const Progress& progress) { line.update(progress); }, &interrupt.flag());
    }
    result.stats.load_seconds = load_seconds;
    const RenderReport report = {job, result, prepared->packed.triangles.size(),
                                 mean_spp(result.film, region_of(settings))};

    const bool whole = !result.stats.cancelled;
    const int interrupted = whole ? 0 : interrupt.exit_code();
    if (interrupted && report.spp_done == 0.0) {
        console().info("interrupted before the first sample; no picture was written");
        return interrupted;
    }
    const Picture picture = result.film.picture();
    const Layers layers = picture_layers(report, camera);
    const DisplayTransform display = display_of(job);
    std::string written;
    for (const auto& output : job.outputs) {
        write_picture(output, picture, layers, display);
        written += (written.empty() ? "" : ", ") + output.string();
    }

    const std::string spp = whole ? fmt::format("{:.7g}", report.spp_done)
                                  : fmt::format("{}: {:.4g} of {}", interrupted ? "interrupted" : "out of time",
                                                report.spp_done, settings.spp);
    console().info(fmt::format("wrote {} ({}x{}, {} samples a pixel)", written, settings.width, settings.height, spp));
    report_dropped(result.film);
    console().info(closing_line(report));
    if (job.stats == StatsReport::text)
        for (const std::string& text : stats_lines(report)) console().info(text);
    if (job.stats == StatsReport::json) fmt::print("{}\n", stats_json(report));
    return interrupted;
}

} // namespace snell::app
