// snell render: from a scene to picture files, of one moment or of many.
#include "commands.h"
#include "console.h"
#include "devices.h"
#include "interrupt.h"
#include "picture_layers.h"
#include "render_job.h"
#include "report.h"

#include "snell/core/error.h"
#include "snell/core/parallel.h"
#include "snell/io/file.h"
#include "snell/render/integrator.h"
#include "snell/render/render.h"
#include "snell/scene/animation.h"
#include "snell/scene/camera_models.h"

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

namespace {
// One picture that is to be rendered.
struct Shot
{
    const RenderJob& job;
    Prepared& prepared;
    const CameraDesc& camera;
    std::string label; // begins what is said about it: "frame 3 of 24: "
    double load_seconds = 0;
};

struct Outcome
{
    bool written = false, whole = false, lost = false; // lost: the device is
};
} // namespace

static void say_numbers(const Shot& shot, const RenderReport& report)
{
    const std::string closing = shot.label + closing_line(report);
    if (report.result.stats.updated) console().detail(shot.label + update_line(report.result.stats));
    if (shot.job.frame)
        console().detail(closing);
    else
        console().info(closing);
    if (shot.job.stats == StatsReport::text)
        for (const std::string& text : stats_lines(report)) console().info(text);
    if (shot.job.stats == StatsReport::json) {
        fmt::print("{}\n", stats_json(report));
        std::fflush(stdout); // who reads along waits for it
    }
}

static RenderResult render_view(const Shot& shot, const CameraDesc& camera, const std::string& label,
                                const InterruptGuard& interrupt)
{
    RenderSettings settings = shot.job.settings;
    if (shot.job.is_stereo) settings.timeout_seconds *= 0.5;
    console().detail(
        fmt::format("{}rendering {}x{} at {} samples a pixel", label, settings.width, settings.height, settings.spp));
    shot.prepared.camera = camera;
    ProgressLine line(settings.spp, label);
    return render(
        shot.prepared, settings, [&](const Progress& progress) { line.update(progress); }, &interrupt.flag());
}

// The rays and seconds of both eyes.
static void add_stats(RenderStats& sum, const RenderStats& more)
{
    sum.camera_rays += more.camera_rays, sum.extension_rays += more.extension_rays;
    sum.shadow_rays += more.shadow_rays, sum.samples += more.samples;
    sum.render_seconds += more.render_seconds;
    sum.generate_seconds += more.generate_seconds, sum.extend_seconds += more.extend_seconds;
    sum.shade_seconds += more.shade_seconds, sum.connect_seconds += more.connect_seconds;
    sum.finalize_seconds += more.finalize_seconds;
    sum.cancelled = sum.cancelled || more.cancelled;
}

static Outcome render_shot(const Shot& shot, const InterruptGuard& interrupt)
{
    const RenderJob& job = shot.job;
    const RenderSettings& settings = job.settings;
    const Region region = region_of(settings);
    const bool two = job.is_stereo;
    const CameraDesc camera = two ? stereo_eye(shot.camera, 0) : shot.camera;
    RenderResult result = render_view(shot, camera, shot.label + (two ? "left eye: " : ""), interrupt);
    result.stats.load_seconds = shot.load_seconds;
    double spp_done = mean_spp(result.film, region);
    std::optional<RenderResult> other;
    if (two) {
        other = render_view(shot, stereo_eye(shot.camera, 1), shot.label + "right eye: ", interrupt);
        add_stats(result.stats, other->stats);
        spp_done = 0.5 * (spp_done + mean_spp(other->film, region));
    }
    const RenderReport report = {job, result, shot.prepared.packed.triangles.size(), spp_done};

    const bool whole = !result.stats.cancelled;
    const bool interrupted = !whole && interrupt.exit_code() != 0;
    if (interrupted && report.spp_done == 0.0) {
        console().info(shot.label + "interrupted before the first sample; no picture was written");
        return {};
    }
    const Picture picture = result.film.picture();
    const Layers layers = picture_layers(report, camera);
    Picture pair;
    Layers pair_layers, view_layers;
    if (two) {
        const RenderReport of_other = {job, *other, report.triangles, spp_done};
        const Picture right = other->film.picture();
        const Layers right_layers = picture_layers(of_other, stereo_eye(shot.camera, 1));
        pair = side_by_side(picture, right);
        pair_layers.attributes = layers.attributes, pair_layers.numbers = layers.numbers;
        pair_layers.alpha = side_by_side(layers.alpha, right_layers.alpha, picture.width);
        view_layers = stereo_layers(layers, right, right_layers);
    }
    const DisplayTransform display = display_of(job);
    std::string written;
    for (const auto& output : job.outputs) {
        if (!two)
            write_picture(output, picture, layers, display);
        else if (lower_extension(output) == ".exr")
            write_picture(output, picture, view_layers, display);
        else
            write_picture(output, pair, pair_layers, display);
        written += (written.empty() ? "" : ", ") + output.string();
    }

    const bool lost = !result.lost.empty();
    const char* why = interrupted ? "interrupted" : lost ? "device lost" : "out of time";
    const std::string spp = whole ? fmt::format("{:.7g}", report.spp_done)
                                  : fmt::format("{}: {:.4g} of {}", why, report.spp_done, settings.spp);
    console().info(fmt::format("{}wrote {} ({}{}x{}, {} samples a pixel)", shot.label, written, two ? "twice " : "",
                               settings.width, settings.height, spp));
    report_dropped(result.film);
    if (two) report_dropped(other->film);
    say_numbers(shot, report);
    if (lost) console().warning(result.lost);
    return {true, whole, lost};
}

static void say_preparation(const Prepared& prepared)
{
    if (prepared.updated) return;
    console().detail(fmt::format("packed in {}, built the acceleration structure in {}",
                                 short_time(prepared.pack_seconds), short_time(prepared.build_seconds)));
    if (prepared.device)
        console().detail(fmt::format("{}: copied {} to {} in {}", prepared.settings.device,
                                     short_bytes(static_cast<double>(prepared.device->uploaded_bytes)),
                                     prepared.device->title(), short_time(prepared.device->upload_seconds)));
    const AccelStats& stats = prepared.accel->stats;
    if (stats.loaded > 0) console().detail(fmt::format("trees from the cache: {}", stats.loaded));
    if (stats.refused > 0)
        console().warning(fmt::format("damaged files in the cache of trees, now replaced: {}", stats.refused));
}

static int render_still(const RenderJob& job, Scene scene, double load_seconds)
{
    const CameraDesc camera = scene.cameras[0];
    const std::unique_ptr<Prepared> prepared = prepare(scene, job.settings);
    scene = Scene{}; // all that rendering needs is packed now
    say_preparation(*prepared);
    // Until here Ctrl-C simply ends the program: there is nothing to save.
    const InterruptGuard interrupt;
    const Outcome outcome = render_shot({job, *prepared, camera, "", load_seconds}, interrupt);
    return outcome.whole ? 0 : outcome.lost ? 1 : interrupt.exit_code();
}

static int render_sequence(const RenderJob& job, Scene& scene, Index<Animation> animation, double load_seconds)
{
    const FrameRange& frames = *job.frames;
    for (const FramePattern& pattern : job.patterns)
        if (pattern.changed)
            console().info(fmt::format("numbers go before the ending: {}, ...", pattern.file(frames.first).string()));
    if (const double last = frames.seconds(frames.end - 1),
        duration = static_cast<double>(scene.animations[animation.value].duration);
        last > duration)
        console().info(fmt::format("the animation lasts {:g} s, the frames go on to {:g} s: nothing moves at the end",
                                   duration, last));

    const InterruptGuard interrupt;
    const auto start = std::chrono::steady_clock::now();
    uint done = 0;
    bool lost = false;
    std::unique_ptr<Prepared> prepared; // by the first frame; the others follow what moves
    for (uint frame = frames.first; frame != frames.end && interrupt.exit_code() == 0; ++frame) {
        RenderJob one = job;
        one.frame = frame;
        one.outputs.clear();
        for (const FramePattern& pattern : job.patterns) one.outputs.push_back(pattern.file(frame));
        if (job.settings.timeout_seconds > 0) { // for all of them
            one.settings.timeout_seconds = job.settings.timeout_seconds - seconds_since(start);
            if (one.settings.timeout_seconds <= 0) break;
        }
        pose(scene, animation, static_cast<float>(frames.seconds(frame)));
        if (prepared == nullptr)
            prepared = prepare(scene, job.settings);
        else
            prepared->update(scene);
        say_preparation(*prepared);
        const std::string label = fmt::format("frame {} of {}: ", frame - frames.first + 1, frames.count());
        const Outcome outcome = render_shot({one, *prepared, scene.cameras[0], label, load_seconds}, interrupt);
        lost = outcome.lost;
        if (!outcome.whole) break;
        ++done;
    }
    const int code = interrupt.exit_code();
    console().info(fmt::format("{}{} of {} frames in {}",
                               done == frames.count() ? ""
                               : code                 ? "interrupted: "
                               : lost                 ? "device lost: "
                                                      : "out of time: ",
                               done, frames.count(), short_time(seconds_since(start))));
    return done == frames.count() ? 0 : lost ? 1 : code;
}

int run_render(const Arguments& arguments)
{
    RenderJob job;
    if (const auto code = parse_render(arguments, job)) return *code;
    set_thread_count(job.settings.threads);
    job.settings.device = settle_device(job.settings.device); // before a large scene is read

    const auto start = std::chrono::steady_clock::now();
    Scene scene = open_chosen(job.scene);
    settle_render(job, scene.hints);
    // A moment by itself is then, to the bit, the picture that it is in a sequence.
    job.settings.keep_motion = job.frames || job.scene.time;
    Index<Animation> animation;
    if (job.frames) {
        animation = find_animation(scene, job.scene, "--frames");
        pose(scene, animation, static_cast<float>(job.frames->seconds(job.frames->first)));
    }
    const RenderSettings& settings = job.settings;
    choose_camera(scene, job.camera, static_cast<float>(settings.width) / static_cast<float>(settings.height));
    hide_environment(scene, job.scene);
    console().notes(scene);
    const double load_seconds = seconds_since(start);
    console().detail(fmt::format("loaded {} in {}", job.scene.name, short_time(load_seconds)));
    return job.frames ? render_sequence(job, scene, animation, load_seconds)
                      : render_still(job, std::move(scene), load_seconds);
}

} // namespace snell::app
