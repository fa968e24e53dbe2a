#include "console.h"
#include "devices.h"
#include "names.h"
#include "options.h"
#include "render_job.h"
#include "usage.h"

#include "snell/bvh/cache.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <unistd.h>

namespace snell::app {

static constexpr double any = std::numeric_limits<double>::max();
static constexpr const char* examples =
    "Examples:\n"
    "  snell render cornell                                       built-in scene, to cornell.png\n"
    "  snell render sphereflake:7 --spp 16                        one of five million spheres, to sphereflake-7.png\n"
    "  snell render dragon.ply -o dragon.png --spp 64             a file; framed and lit if it has no camera or light\n"
    "  snell render box.obj -o box.exr -o box.png --size 800x600  two files from one render\n"
    "  snell render cornell --integrator path -D max_depth=3 -D mis=0\n"
    "  snell render scene.obj --eye 0,1,5 --target 0,1,0 --fov 35\n"
    "  snell render helmet.glb --environment sky.exr --environment-rotation 90 -o helmet.png\n"
    "  snell render grid --lens fisheye --focus-distance 2        through the glass of a lens\n"
    "  snell render fox.glb --animation Run --frames 0:24 -o fox.%04d.png\n"
    "\nCtrl-C writes what there is; a second one stops at once. `snell list` shows all names.\n";

static void add_picture_options(Options& options, RenderJob& job)
{
    Asked& asked = job.asked;
    options.group("Picture");
    options.values("-o,--output,--outfile", "FILE",
                   "Picture to write: .exr .png .hdr .pfm; may be repeated [SCENE.png]",
                   [&](const std::string& text) { asked.outputs.push_back(text); });
    options.value("--spp,--samples", "N", "Samples a pixel [the scene's wish, or 64]", [&](const std::string& text) {
        asked.spp = static_cast<uint>(parse_integer("--spp", text, 1, 1 << 30));
    });
    options.value("--width", "W", "Pixels [the scene's wish, or 512, or as --height]", [&](const std::string& text) {
        asked.width = static_cast<int>(parse_integer("--width", text, 1, 65536));
    });
    options.value("--height", "H", "Pixels [the scene's wish, or 512, or as --width]", [&](const std::string& text) {
        asked.height = static_cast<int>(parse_integer("--height", text, 1, 65536));
    });
    options.value("--size,--resolution", "WxH", "Both",
                  [&](const std::string& text) { std::tie(asked.width, asked.height) = parse_size("--size", text); });
    options.value("--cropwindow", "X0,X1,Y0,Y1", "Render only this part, in fractions of the picture",
                  [&](const std::string& text) { asked.crop_window = text; });
    options.value("--pixelbounds", "X0,X1,Y0,Y1", "Render only this part, in pixels",
                  [&](const std::string& text) { asked.pixel_bounds = text; });
    options.value("--pixel", "X,Y", "Render only this pixel", [&](const std::string& text) { asked.pixel = text; });
    options.value("--exposure", "EV", "For PNG: exposure, a factor of 2 each [0]", [&](const std::string& text) {
        job.display.exposure_ev = static_cast<float>(parse_number("--exposure", text, -100.0, 100.0));
    });
    options.value("--tone", "CURVE", "For PNG: how light becomes display values; `snell list` names the curves [none]",
                  [&](const std::string& text) { job.display.curve = find_tone_curve(text); });
    options.flag("--layers", "Also record albedo, normals, depth, ... [if there is an .exr to write]",
                 [&] { asked.layers = true; });
    options.flag("--no-layers", "Colour only", [&] { asked.layers = false; });
}

// Joins the group of --time.
static void add_sequence_options(Options& options, RenderJob& job, std::optional<double>& fps)
{
    options.value("--frames", "A:B", "A picture for each of the frames A to B - 1; numbers go where %04d is in FILE",
                  [&](const std::string& text) {
                      const auto [first, end] = parse_range("--frames", text, "0:24 for the first 24 frames");
                      job.frames = FrameRange{first, end};
                  });
    options.value("--fps", "N", "Frames a second [24]",
                  [&](const std::string& text) { fps = parse_number("--fps", text, 0.001, 1e6); });
}

void add_technique_options(Options& options, RenderJob& job)
{
    Asked& asked = job.asked;
    RenderSettings& settings = job.settings;
    options.group("Technique");
    options.value("--integrator", "NAME", "How light is computed; `snell list` names all [path]",
                  [&](const std::string& text) { asked.integrator = text; });
    options.values("-D", "KEY=VALUE", "Parameter of the integrator; may be repeated", [&](const std::string& text) {
        settings.parameters.insert_or_assign(parse_key_value("-D", text).first, parse_key_value("-D", text).second);
    });
    options.value("--sampler", "NAME", "Where random numbers come from: sobol or independent [sobol]",
                  [&](const std::string& text) { asked.sampler = text; });
    options.value("--seed", "N", "Another seed, another noise [0]", [&](const std::string& text) {
        asked.seed = static_cast<uint>(parse_integer("--seed", text, 0, std::numeric_limits<uint>::max()));
    });
    options.value("--samples-range", "A:B", "Sample numbers A to B - 1 of each pixel, instead of --spp",
                  [&](const std::string& text) {
                      asked.samples_range = parse_range("--samples-range", text, "0:64 for the first 64 samples");
                  });
    options.value("--accel", "NAME", "Structure that finds hits; `snell list` names all",
                  [&](const std::string& text) { settings.accel = text; });
    options.value("--accel-cache", "DIR",
                  "Keep trees there for the next time; up to 4 GiB, the least recently used go first",
                  [&](const std::string& text) {
                      check_cache_folder(text);
                      settings.accel_options.cache = text;
                  });
    options.value("--triangle-test", "NAME", "watertight or moller-trumbore [watertight]",
                  [&](const std::string& text) {
                      static const std::vector<std::string> names = {"watertight", "moller-trumbore"};
                      check_name("triangle test", text, names);
                      settings.accel_options.triangle_test =
                          text == names[0] ? TriangleTest::watertight : TriangleTest::moller_trumbore;
                  });
}

static void add_running_options(Options& options, RenderJob& job)
{
    RenderSettings& settings = job.settings;
    options.group("Running");
    options.value("--device", "NAME", "What renders: cpu, gpu (the best one), gpu:N, or auto [cpu]",
                  [&](const std::string& text) {
                      check_device(text);
                      settings.device = text;
                  });
    options.action("--list-devices", "Print what there is, and render nothing", print_devices);
    options.value("-t,--threads,--nthreads", "N", "Threads; the picture does not depend on it [all]",
                  [&](const std::string& text) {
                      settings.threads = static_cast<int>(parse_integer("--threads", text, 0, 4096));
                  });
    options.value(
        "--target-error", "RELMSE", "Stop when the estimated error is down to that; --spp is the most it may take",
        [&](const std::string& text) { settings.target_error = parse_number("--target-error", text, 1e-9, any); });
    options.value(
        "--timeout", "SECONDS", "Stop rendering after that long and write what there is",
        [&](const std::string& text) { settings.timeout_seconds = parse_number("--timeout", text, 0.0, any); });
    options.flag_or_value("--stats", "[=json]", "More statistics; json: as one line of JSON on stdout, at the end",
                          [&](const std::string& text) {
                              if (!text.empty()) check_name("form of --stats", text, std::vector<std::string>{"json"});
                              job.stats = text.empty() ? StatsReport::text : StatsReport::json;
                          });
    options.flag("-q,--quiet", "Say nothing but errors", [] { console().level = Console::Level::quiet; });
    options.flag("-v,--verbose", "Say more", [] { console().level = Console::Level::verbose; });
    options.value("--log-file", "FILE", "Append all messages to this file as well",
                  [](const std::string& text) { console().open_log(text); });

    options.group("Debugging");
    options.flag("--strict", "Stop at a sample that is not finite, instead of dropping and counting it",
                 [&] { settings.strict = true; });
    options.flag("--disable-pixel-jitter", "All samples through the pixel's centre",
                 [&] { settings.pixel_jitter = false; });
    options.flag("--force-diffuse", "Make every material Lambertian", [&] { settings.force_diffuse = true; });
    options.flag("--disable-image-textures", "Leave textures out", [&] { settings.image_textures = false; });
}

// Whether files of that format may have wishes for the render.
static bool has_hints(const std::string& scene)
{
    return std::filesystem::path(scene).extension() == ".pbrt";
}

std::optional<int> parse_render(const Arguments& arguments, RenderJob& job)
{
    std::optional<double> fps;
    Options options("render", "Renders a picture of a scene.", examples);
    options.positional("SCENE", scene_help, [&](const std::string& text) { job.scene.name = text; });
    add_picture_options(options, job);
    add_camera_options(options, job.camera);
    options.flag("--stereo", "A picture for each eye: side by side, or as the views left and right of an .exr",
                 [&] { job.is_stereo = job.camera.is_stereo = true; });
    add_scene_options(options, job.scene);
    add_sequence_options(options, job, fps);
    add_loading_options(options, job.scene);
    add_technique_options(options, job);
    add_running_options(options, job);
    if (const auto code = options.parse(arguments)) return code;

    if (job.asked.spp && job.asked.samples_range)
        throw UsageError("--spp and --samples-range exclude each other; give one");
    if (job.frames && job.scene.time) throw UsageError("--frames and --time exclude each other; give one");
    if (fps && !job.frames) throw UsageError("--fps: a picture of one moment has none; give --frames A:B as well");
    if (fps) job.frames->fps = *fps;

    job.command_line = "snell render";
    for (const std::string& argument : arguments)
        job.command_line +=
            argument.find_first_of(" \t\n'\"\\$") == std::string::npos ? " " + argument : " '" + argument + "'";

    // What is wrong should be said before a large scene is read.
    if (!has_hints(job.scene.name)) {
        RenderJob trial = job;
        settle_render(trial, {});
    } else {
        for (const std::string& output : job.asked.outputs)
            check_writable(job.frames ? parse_frame_pattern(output).file(job.frames->first)
                                      : std::filesystem::path(output));
    }
    return std::nullopt;
}

} // namespace snell::app
