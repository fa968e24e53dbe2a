#include "console.h"
#include "devices.h"
#include "names.h"
#include "options.h"
#include "render_job.h"
#include "usage.h"

#include "snell/core/error.h"
#include "snell/render/params.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <unistd.h>

namespace snell::app {

namespace {
// Options that only mean something together.
struct Pending
{
    std::optional<int> width, height;
    std::optional<uint> spp;
    std::optional<std::pair<uint, uint>> samples_range;
    std::string crop_window, pixel_bounds, pixel;
    std::optional<bool> layers;
};
} // namespace

static constexpr double any = std::numeric_limits<double>::max();
static constexpr const char* examples =
    "Examples:\n"
    "  snell render cornell                                       built-in scene, to cornell.png\n"
    "  snell render sphereflake:7 --spp 16                        one of five million spheres, to sphereflake-7.png\n"
    "  snell render dragon.ply -o dragon.png --spp 64             a file; framed and lit if it has no camera or light\n"
    "  snell render box.obj -o box.exr -o box.png --size 800x600  two files from one render\n"
    "  snell render cornell --integrator path -D max_depth=3 -D mis=0\n"
    "  snell render scene.obj --eye 0,1,5 --target 0,1,0 --fov 35\n"
    "\nCtrl-C writes what there is; a second one stops at once. `snell list` shows all names.\n";

static void add_picture_options(Options& options, RenderJob& job, Pending& pending)
{
    options.group("Picture");
    options.values("-o,--output,--outfile", "FILE",
                   "Picture to write: .exr .png .hdr .pfm; may be repeated [SCENE.png]",
                   [&](const std::string& text) { job.outputs.emplace_back(text); });
    options.value("--spp,--samples", "N", "Samples a pixel [64]", [&](const std::string& text) {
        pending.spp = static_cast<uint>(parse_integer("--spp", text, 1, 1 << 30));
    });
    options.value("--width", "W", "Pixels [512, or as --height]", [&](const std::string& text) {
        pending.width = static_cast<int>(parse_integer("--width", text, 1, 65536));
    });
    options.value("--height", "H", "Pixels [512, or as --width]", [&](const std::string& text) {
        pending.height = static_cast<int>(parse_integer("--height", text, 1, 65536));
    });
    options.value("--size,--resolution", "WxH", "Both", [&](const std::string& text) {
        std::tie(pending.width, pending.height) = parse_size("--size", text);
    });
    options.value("--cropwindow", "X0,X1,Y0,Y1", "Render only this part, in fractions of the picture",
                  [&](const std::string& text) { pending.crop_window = text; });
    options.value("--pixelbounds", "X0,X1,Y0,Y1", "Render only this part, in pixels",
                  [&](const std::string& text) { pending.pixel_bounds = text; });
    options.value("--pixel", "X,Y", "Render only this pixel", [&](const std::string& text) { pending.pixel = text; });
    options.value("--exposure", "EV", "For PNG: exposure, a factor of 2 each [0]", [&](const std::string& text) {
        job.display.exposure_ev = static_cast<float>(parse_number("--exposure", text, -100.0, 100.0));
    });
    options.value("--tone", "CURVE", "For PNG: none, reinhard or aces [none]",
                  [&](const std::string& text) { job.display.curve = find_tone_curve(text); });
    options.flag("--layers", "Also record albedo, normals, depth, ... [if there is an .exr to write]",
                 [&] { pending.layers = true; });
    options.flag("--no-layers", "Colour only", [&] { pending.layers = false; });
}

static void add_technique_options(Options& options, RenderJob& job, Pending& pending)
{
    RenderSettings& settings = job.settings;
    options.group("Technique");
    options.value("--integrator", "NAME", "How light is computed; `snell list` names all [path]",
                  [&](const std::string& text) { settings.integrator = text; });
    options.values("-D", "KEY=VALUE", "Parameter of the integrator; may be repeated", [&](const std::string& text) {
        settings.parameters.insert_or_assign(parse_key_value("-D", text).first, parse_key_value("-D", text).second);
    });
    options.value("--sampler", "NAME", "Where random numbers come from: sobol or independent [sobol]",
                  [&](const std::string& text) { settings.sampler = text; });
    options.value("--seed", "N", "Another seed, another noise [0]", [&](const std::string& text) {
        settings.seed = static_cast<uint>(parse_integer("--seed", text, 0, std::numeric_limits<uint>::max()));
    });
    options.value("--samples-range", "A:B", "Sample numbers A to B - 1 of each pixel, instead of --spp",
                  [&](const std::string& text) { pending.samples_range = parse_range("--samples-range", text); });
    options.value("--accel", "NAME", "Structure that finds hits; `snell list` names all",
                  [&](const std::string& text) { settings.accel = text; });
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
    options.value("--device", "NAME", "What renders: cpu, so far the only one [cpu]", check_device);
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

static void settle_size(RenderJob& job, const Pending& pending)
{
    RenderSettings& settings = job.settings;
    settings.width = pending.width.value_or(pending.height.value_or(512));
    settings.height = pending.height.value_or(pending.width.value_or(512));

    const int given = !pending.crop_window.empty() + !pending.pixel_bounds.empty() + !pending.pixel.empty();
    if (given > 1) throw UsageError("--cropwindow, --pixelbounds and --pixel exclude each other; give one");
    if (!pending.crop_window.empty()) {
        const auto c = parse_numbers("--cropwindow", pending.crop_window, 4, "0.25,0.75,0,0.5");
        if (!(0 <= c[0] && c[0] < c[1] && c[1] <= 1 && 0 <= c[2] && c[2] < c[3] && c[3] <= 1))
            throw UsageError(fmt::format("--cropwindow: {} does not satisfy 0 <= x0 < x1 <= 1, 0 <= y0 < y1 <= 1",
                                         pending.crop_window));
        const auto pixel = [](double fraction, int size) { return static_cast<int>(std::ceil(fraction * size)); };
        settings.region = Region{pixel(c[0], settings.width), pixel(c[2], settings.height), pixel(c[1], settings.width),
                                 pixel(c[3], settings.height)};
        if (settings.region->x0 == settings.region->x1 || settings.region->y0 == settings.region->y1)
            throw UsageError(fmt::format("--cropwindow: {} holds no pixel of a {}x{} picture", pending.crop_window,
                                         settings.width, settings.height));
    } else if (given) {
        const bool one = !pending.pixel.empty();
        const char* option = one ? "--pixel" : "--pixelbounds";
        auto b = one ? parse_numbers(option, pending.pixel, 2, "100,50")
                     : parse_numbers(option, pending.pixel_bounds, 4, "100,200,50,80");
        if (one) b = {b[0], b[0] + 1, b[1], b[1] + 1};
        for (double v : b)
            if (v != std::floor(v)) throw UsageError(fmt::format("{}: {} is not a whole number", option, v));
        if (!(0 <= b[0] && b[0] < b[1] && b[1] <= settings.width && 0 <= b[2] && b[2] < b[3] &&
              b[3] <= settings.height))
            throw UsageError(one ? fmt::format("--pixel: {} is not inside the {}x{} picture; X is from 0 to {}, Y from "
                                               "0 to {}",
                                               pending.pixel, settings.width, settings.height, settings.width - 1,
                                               settings.height - 1)
                                 : fmt::format("--pixelbounds: {} is not inside the {}x{} picture; the order is "
                                               "X0,X1,Y0,Y1",
                                               pending.pixel_bounds, settings.width, settings.height));
        settings.region =
            Region{static_cast<int>(b[0]), static_cast<int>(b[2]), static_cast<int>(b[1]), static_cast<int>(b[3])};
    }
}

// A film that does not fit would drag the machine down before it fails.
static void check_memory(const RenderSettings& settings)
{
    const double pixels = static_cast<double>(settings.width) * settings.height;
    const double bytes = pixels * (settings.layers ? 160.0 : 44.0);
    const double memory = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
    if (bytes > 0.8 * memory)
        throw Error(fmt::format("a {}x{} picture takes {} and this machine has {}", settings.width, settings.height,
                                short_bytes(bytes), short_bytes(memory)),
                    settings.layers ? "make it smaller, or try --no-layers" : "make it smaller");
}

std::optional<int> parse_render(const Arguments& arguments, RenderJob& job)
{
    Pending pending;
    Options options("render", "Renders a picture of a scene.", examples);
    options.positional("SCENE", "A file (.obj .ply .stl) or a built-in scene",
                       [&](const std::string& text) { job.scene = text; });
    add_picture_options(options, job, pending);
    add_camera_options(options, job.camera);
    add_technique_options(options, job, pending);
    add_running_options(options, job);
    if (const auto code = options.parse(arguments)) return code;

    RenderSettings& settings = job.settings;
    settle_size(job, pending);
    if (pending.spp && pending.samples_range)
        throw UsageError("--spp and --samples-range exclude each other; give one");
    settings.spp = pending.spp.value_or(64);
    if (pending.samples_range) {
        settings.first_sample = pending.samples_range->first;
        settings.spp = pending.samples_range->second - pending.samples_range->first;
    }

    check_name("sampler", settings.sampler, sampler_names());
    check_name("integrator", settings.integrator, integrator_names());
    if (!settings.accel.empty()) check_name("acceleration structure", settings.accel, accel_names());
    for (const auto& [key, value] : settings.parameters)
        check_name("parameter of integrator " + settings.integrator, key, parameter_names(settings.integrator));
    try { // their values, on a stand-in for the camera
        make_render_params(settings, *find_integrator(settings.integrator), CameraDesc{}, 1.0f);
    } catch (const Error& error) {
        throw UsageError(error.what());
    }

    if (job.outputs.empty()) {
        std::string name = std::filesystem::path(job.scene).stem().string();
        std::replace(name.begin(), name.end(), ':', '-'); // sphereflake:4; not every file system takes a colon
        job.outputs.emplace_back(name + ".png");
    }
    bool with_exr = false;
    for (const auto& output : job.outputs) {
        check_writable(output);
        const std::string ending = output.extension().string();
        with_exr = with_exr || ending == ".exr" || ending == ".EXR";
    }
    settings.layers = pending.layers.value_or(with_exr);
    check_memory(settings);

    job.command_line = "snell render";
    for (const std::string& argument : arguments)
        job.command_line +=
            argument.find_first_of(" \t\n'\"\\$") == std::string::npos ? " " + argument : " '" + argument + "'";
    return std::nullopt;
}

} // namespace snell::app
