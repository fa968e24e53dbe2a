// From what the command line says, and what the scene wishes, to what is rendered.
#include "console.h"
#include "names.h"
#include "render_job.h"
#include "usage.h"

#include "snell/bvh/options.h"
#include "snell/core/error.h"
#include "snell/io/file.h"
#include "snell/render/gpu_options.h"
#include "snell/render/integrator.h"
#include "snell/render/params.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include <unistd.h>

namespace snell::app {

// ---- the scene's wishes ----

static int as_wide(int given, int wanted, int of)
{
    return std::clamp(static_cast<int>(std::lround(static_cast<double>(given) * wanted / of)), 1, 65536);
}

// Returns whether the hints had a say.
static bool settle_size(RenderSettings& settings, const Asked& asked, const RenderHints& hints)
{
    constexpr int otherwise = 512, most = 65536;
    const bool hinted = hints.width && hints.height && *hints.width > 0 && *hints.height > 0 && *hints.width <= most &&
                        *hints.height <= most;
    if (hinted && !(asked.width && asked.height)) { // the picture keeps its form if one side is given
        settings.width = asked.width    ? *asked.width
                         : asked.height ? as_wide(*asked.height, *hints.width, *hints.height)
                                        : *hints.width;
        settings.height = asked.height  ? *asked.height
                          : asked.width ? as_wide(*asked.width, *hints.height, *hints.width)
                                        : *hints.height;
        return true;
    }
    settings.width = asked.width.value_or(asked.height.value_or(otherwise));
    settings.height = asked.height.value_or(asked.width.value_or(otherwise));
    return false;
}

// A name from the scene, if we have one like it.
static std::string known_or(const char* what, const std::optional<std::string>& name, std::string otherwise,
                            const std::vector<std::string>& known, std::vector<std::string>& taken)
{
    if (!name || *name == otherwise) return otherwise;
    if (std::find(known.begin(), known.end(), *name) == known.end()) {
        console().info(
            fmt::format("the scene asks for the {} '{}', which is not known: '{}' is used", what, *name, otherwise));
        return otherwise;
    }
    taken.push_back(fmt::format("{} {}", what, *name));
    return *name;
}

static void settle_technique(RenderJob& job, const RenderHints& hints, std::vector<std::string>& taken)
{
    const Asked& asked = job.asked;
    RenderSettings& settings = job.settings;
    if (hints.spp && *hints.spp > 0 && !asked.spp && !asked.samples_range)
        taken.push_back(fmt::format("{} samples a pixel", *hints.spp));
    settings.spp = asked.spp.value_or(hints.spp && *hints.spp > 0 ? std::min(*hints.spp, 1u << 30) : 64);
    if (asked.samples_range) {
        settings.first_sample = asked.samples_range->first;
        settings.spp = asked.samples_range->second - asked.samples_range->first;
    }
    if (hints.seed && *hints.seed != 0 && !asked.seed) taken.push_back(fmt::format("seed {}", *hints.seed));
    settings.seed = asked.seed.value_or(hints.seed.value_or(0));

    const RenderSettings defaults;
    settings.sampler =
        asked.sampler ? *asked.sampler : known_or("sampler", hints.sampler, defaults.sampler, sampler_names(), taken);
    settings.integrator =
        asked.integrator ? *asked.integrator
                         : known_or("integrator", hints.integrator, defaults.integrator, integrator_names(), taken);
    check_name("sampler", settings.sampler, sampler_names());
    check_name("integrator", settings.integrator, integrator_names());
    if (!settings.accel.empty()) check_name("acceleration structure", settings.accel, accel_names());

    std::vector<std::string> keys = parameter_names(settings.integrator);
    const bool has_depth = std::find(keys.begin(), keys.end(), "max_depth") != keys.end();
    if (hints.max_depth && has_depth && !settings.parameters.contains("max_depth")) {
        settings.parameters["max_depth"] = std::to_string(std::min(*hints.max_depth, 1000u));
        taken.push_back(fmt::format("max_depth {}", *hints.max_depth));
    }
    for (const std::string& line : accel_parameters()) keys.push_back(line.substr(0, line.find('=')));
    for (const std::string& line : gpu_parameters()) keys.push_back(line.substr(0, line.find('=')));
    for (const auto& [key, value] : settings.parameters)
        check_name("parameter of integrator " + settings.integrator + ", of structures or of GPUs", key, keys);
    try { // their values, on a stand-in for the camera
        const AccelOptions options = read_accel_options(settings.parameters, settings.accel_options);
        if (!options.build.builder.empty()) check_name("builder", options.build.builder, builder_names());
        make_render_params(settings, *find_integrator(settings.integrator), CameraDesc{}, 1.0f);
    } catch (const Error& error) {
        throw UsageError(error.what());
    }
}

// ---- regions ----

static bool is_window(const std::vector<double>& c)
{
    return 0 <= c[0] && c[0] < c[1] && c[1] <= 1 && 0 <= c[2] && c[2] < c[3] && c[3] <= 1;
}

// The pixels whose corner lies in the window; there may be none.
static Region window_pixels(const std::vector<double>& c, const RenderSettings& settings)
{
    const auto pixel = [](double fraction, int size) { return static_cast<int>(std::ceil(fraction * size)); };
    return {pixel(c[0], settings.width), pixel(c[2], settings.height), pixel(c[1], settings.width),
            pixel(c[3], settings.height)};
}

static Region pixel_region(const char* option, const std::string& text, bool one, const RenderSettings& settings)
{
    auto b = one ? parse_numbers(option, text, 2, "100,50") : parse_numbers(option, text, 4, "100,200,50,80");
    if (one) b = {b[0], b[0] + 1, b[1], b[1] + 1};
    for (double v : b)
        if (v != std::floor(v)) throw UsageError(fmt::format("{}: {} is not a whole number", option, v));
    const int w = settings.width, h = settings.height;
    if (!(0 <= b[0] && b[0] < b[1] && b[1] <= w && 0 <= b[2] && b[2] < b[3] && b[3] <= h))
        throw UsageError(one ? fmt::format("--pixel: {} is not inside the {}x{} picture; X is from 0 to {}, Y from "
                                           "0 to {}",
                                           text, w, h, w - 1, h - 1)
                             : fmt::format("--pixelbounds: {} is not inside the {}x{} picture; the order is "
                                           "X0,X1,Y0,Y1",
                                           text, w, h));
    return {static_cast<int>(b[0]), static_cast<int>(b[2]), static_cast<int>(b[1]), static_cast<int>(b[3])};
}

static void settle_region(RenderSettings& settings, const Asked& asked, const RenderHints& hints,
                          std::vector<std::string>& taken)
{
    const int given = !asked.crop_window.empty() + !asked.pixel_bounds.empty() + !asked.pixel.empty();
    if (given > 1) throw UsageError("--cropwindow, --pixelbounds and --pixel exclude each other; give one");
    const auto holds_none = [](const Region& r) { return r.x0 == r.x1 || r.y0 == r.y1; };
    if (!asked.crop_window.empty()) {
        const auto c = parse_numbers("--cropwindow", asked.crop_window, 4, "0.25,0.75,0,0.5");
        if (!is_window(c))
            throw UsageError(fmt::format("--cropwindow: {} does not satisfy 0 <= x0 < x1 <= 1, 0 <= y0 < y1 <= 1",
                                         asked.crop_window));
        settings.region = window_pixels(c, settings);
        if (holds_none(*settings.region))
            throw UsageError(fmt::format("--cropwindow: {} holds no pixel of a {}x{} picture", asked.crop_window,
                                         settings.width, settings.height));
    } else if (!asked.pixel.empty()) {
        settings.region = pixel_region("--pixel", asked.pixel, true, settings);
    } else if (!asked.pixel_bounds.empty()) {
        settings.region = pixel_region("--pixelbounds", asked.pixel_bounds, false, settings);
    } else if (hints.crop_window) {
        const std::vector<double> c(hints.crop_window->begin(), hints.crop_window->end());
        if (c == std::vector<double>{0, 1, 0, 1}) return;
        if (!is_window(c) || holds_none(window_pixels(c, settings))) {
            console().warning("the scene's crop window holds no pixel; the whole picture is rendered");
            return;
        }
        settings.region = window_pixels(c, settings);
        taken.push_back(fmt::format("crop window {}", fmt::join(c, ",")));
    }
}

// ---- files ----

static bool has_ending(const std::filesystem::path& file, std::initializer_list<const char*> endings)
{
    const std::string ending = lower_extension(file);
    return std::find(endings.begin(), endings.end(), ending) != endings.end();
}

// Into the current folder, whatever the scene says: where to write is not a scene's business.
static std::string default_output(const RenderJob& job, const RenderHints& hints, std::vector<std::string>& taken)
{
    if (hints.output) {
        const std::filesystem::path name = std::filesystem::path(*hints.output).filename();
        if (!name.stem().empty() && has_ending(name, {".exr", ".png", ".hdr", ".pfm"})) {
            taken.push_back("output " + name.string());
            return name.string();
        }
    }
    std::string name = std::filesystem::path(job.scene.name).stem().string();
    std::replace(name.begin(), name.end(), ':', '-'); // sphereflake:4; not every file system takes a colon
    return name + ".png";
}

static void settle_outputs(RenderJob& job, const RenderHints& hints, std::vector<std::string>& taken)
{
    std::vector<std::string> names = job.asked.outputs;
    if (names.empty()) {
        names.push_back(default_output(job, hints, taken));
        if (job.frames) // a name that nobody typed has no pattern in it
            for (std::size_t at = 0; (at = names[0].find('%', at)) != std::string::npos; at += 2)
                names[0].insert(at, 1, '%');
    }
    job.outputs.clear();
    job.patterns.clear();
    bool with_exr = false;
    for (const std::string& name : names) {
        if (job.frames) {
            job.patterns.push_back(parse_frame_pattern(name));
            check_writable(job.patterns.back().file(job.frames->first));
        } else {
            check_writable(name);
            job.outputs.emplace_back(name);
        }
        with_exr = with_exr || has_ending(name, {".exr"});
    }
    job.settings.layers = job.asked.layers.value_or(with_exr);
}

// A film that does not fit would drag the machine down before it fails.
static void check_memory(const RenderSettings& settings)
{
    const double pixels = static_cast<double>(settings.width) * settings.height;
    const double bytes = pixels * (settings.layers ? 164.0 : 48.0);
    const double memory = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
    if (bytes > 0.8 * memory)
        throw Error(fmt::format("a {}x{} picture takes {} and this machine has {}", settings.width, settings.height,
                                short_bytes(bytes), short_bytes(memory)),
                    settings.layers ? "make it smaller, or try --no-layers" : "make it smaller");
}

static std::vector<std::string> settle_picture(RenderJob& job, const RenderHints& hints)
{
    std::vector<std::string> taken;
    if (settle_size(job.settings, job.asked, hints))
        taken.push_back(fmt::format("{}x{} pixels", job.settings.width, job.settings.height));
    settle_region(job.settings, job.asked, hints, taken);
    settle_technique(job, hints, taken);
    return taken;
}

void settle_settings(RenderJob& job, const RenderHints& hints)
{
    const std::vector<std::string> taken = settle_picture(job, hints);
    if (!taken.empty()) console().detail(fmt::format("taken over from the scene: {}", fmt::join(taken, ", ")));
}

void settle_render(RenderJob& job, const RenderHints& hints)
{
    std::vector<std::string> taken = settle_picture(job, hints);
    settle_outputs(job, hints, taken);
    check_memory(job.settings);
    if (!taken.empty()) console().detail(fmt::format("taken over from the scene: {}", fmt::join(taken, ", ")));
}

} // namespace snell::app
