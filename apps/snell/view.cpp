// snell view: a window that shows a scene.
#include "commands.h"
#include "console.h"
#include "devices.h"

#include "snell/core/error.h"

#ifdef SNELL_HAS_VIEW
#include "camera_choice.h"
#include "names.h"
#include "scene_choice.h"
#include "usage.h"

#include "snell/bvh/options.h"
#include "snell/core/parallel.h"
#include "snell/render/gpu_options.h"
#include "snell/view/viewer.h"

#include <fmt/format.h>

#include <algorithm>

namespace snell::app {

static const char* examples = "Examples:\n"
                              "  snell view cornell                   a built-in scene; `snell list` names them\n"
                              "  snell view room.glb --integrator ao\n"
                              "  snell view cornell --script tour.txt\n"
                              "F1 in the window lists keys and mouse; docs/viewer.md has the rest.";

namespace {
struct ViewJob
{
    SceneChoice scene;
    CameraChoice camera;
    view::ViewOptions options;
};
} // namespace

static void add_technique_options(Options& options, ViewJob& job)
{
    RenderSettings& settings = job.options.settings;
    options.group("Technique");
    options.value("--integrator", "NAME", "How light is computed; `snell list` names them [path]",
                  [&](const std::string& text) { settings.integrator = text; });
    options.values(
        "-D", "KEY=VALUE", "A parameter of the integrator or of the structure", [&](const std::string& text) {
            settings.parameters.insert_or_assign(parse_key_value("-D", text).first, parse_key_value("-D", text).second);
        });
    options.value("--sampler", "NAME", "Where random numbers come from [sobol]",
                  [&](const std::string& text) { settings.sampler = text; });
    options.value("--accel", "NAME", "Acceleration structure", [&](const std::string& text) { settings.accel = text; });
    options.value(
        "--spp,--samples", "N", "Samples a pixel at which a picture is done [1024]",
        [&](const std::string& text) { settings.spp = static_cast<uint>(parse_integer("--spp", text, 1, 1 << 30)); });
    options.value("--seed", "N", "Other random numbers", [&](const std::string& text) {
        settings.seed = static_cast<uint>(parse_integer("--seed", text, 0, 0xffffffffll));
    });
    options.value("--exposure", "EV", "Brighter by that many factors of 2 [0]", [&](const std::string& text) {
        job.options.exposure_ev = static_cast<float>(parse_number("--exposure", text, -100, 100));
    });
    options.value("--tone", "CURVE", "View transform; `snell list` names them [none]",
                  [&](const std::string& text) { job.options.curve = find_tone_curve(text); });
    options.value(
        "--target-ms", "MS", "Frame time that the governor aims at while things move [16]",
        [&](const std::string& text) { job.options.target_ms = parse_number("--target-ms", text, 1, 10000); });
    options.value("--device", "NAME", "What renders: cpu, gpu (the best one), gpu:N, or auto [cpu]",
                  [&](const std::string& text) {
                      check_device(text);
                      settings.device = text;
                  });
    options.action("--list-devices", "Print what there is, and open no window", print_devices);
    options.value("-t,--threads,--nthreads", "N", "Number of threads [all]", [&](const std::string& text) {
        settings.threads = static_cast<int>(parse_integer("--threads", text, 1, 1024));
    });
}

static void add_window_options(Options& options, ViewJob& job)
{
    view::ViewOptions& window = job.options;
    options.group("Window");
    options.value("--size,--resolution", "WxH", "Size of the window [1280x720]", [&](const std::string& text) {
        std::tie(window.width, window.height) = parse_size("--size", text);
        if (window.width > 16384 || window.height > 16384)
            throw UsageError("--size: a window has at most 16384 pixels a side");
    });
    options.value("--scale", "X", "Size of letters and controls [by the display]", [&](const std::string& text) {
        window.ui_scale = static_cast<float>(parse_number("--scale", text, 0.5, 4.0));
    });
    options.flag("--light", "Light controls instead of dark ones", [&] { window.is_light = true; });

    options.group("Without hands");
    options.value("--script", "FILE", "Drive the viewer by a text file, see docs/viewer.md",
                  [&](const std::string& text) {
                      window.script = text;
                      window.keeps_recent = false;
                  });
    options.value("--record", "PATTERN", "Fly along --path, write pictures such as walk.%04d.png, and end",
                  [&](const std::string& text) { window.record = text; });
    options.value("--path", "FILE",
                  "Views for --record, one a line as the key C copies them; a spline goes through them",
                  [&](const std::string& text) { window.path = text; });
    options.value("--record-frames", "N", "Number of pictures of --record [100]", [&](const std::string& text) {
        window.record_frames = static_cast<uint>(parse_integer("--record-frames", text, 1, 1'000'000));
    });
    options.value("--timings", "FILE", "Write latencies and frame times there as JSON when the window closes",
                  [&](const std::string& text) { window.timings = text; });
}

static std::vector<CameraDesc> others(const std::vector<CameraDesc>& cameras, const CameraDesc& chosen)
{
    std::vector<CameraDesc> rest;
    for (const CameraDesc& camera : cameras)
        if (camera.name != chosen.name) rest.push_back(camera);
    return rest;
}

static bool says_camera(const CameraChoice& choice)
{
    return !choice.camera.empty() || choice.eye || choice.target || choice.up || choice.fov_degrees;
}

// On the session's own thread.
static Scene load(const ViewJob& job, const std::string& name, const LoadProgressCallback& progress)
{
    const bool is_first = name == job.scene.name; // the options are about the scene of the command line
    SceneChoice choice = is_first ? job.scene : SceneChoice{};
    choice.name = name;
    choice.sandbox = job.scene.sandbox;
    Scene scene = open_chosen(choice, progress);
    if (is_first && says_camera(job.camera)) {
        const std::vector<CameraDesc> cameras = scene.cameras;
        choose_camera(scene, job.camera,
                      static_cast<float>(job.options.width) / static_cast<float>(job.options.height));
        const std::vector<CameraDesc> rest = others(cameras, scene.cameras[0]);
        scene.cameras.insert(scene.cameras.end(), rest.begin(), rest.end());
    }
    hide_environment(scene, choice);
    return scene;
}

static void check_names(const RenderSettings& settings)
{
    check_name("integrator", settings.integrator, integrator_names());
    check_name("sampler", settings.sampler, sampler_names());
    if (!settings.accel.empty()) check_name("acceleration structure", settings.accel, accel_names());
    std::vector<std::string> keys = parameter_names(settings.integrator);
    for (const std::string& line : accel_parameters()) keys.push_back(line.substr(0, line.find('=')));
    for (const std::string& line : gpu_parameters()) keys.push_back(line.substr(0, line.find('=')));
    for (const auto& [key, value] : settings.parameters)
        check_name("parameter of integrator " + settings.integrator + ", of structures or of GPUs", key, keys);
}

int run_view(const Arguments& arguments)
{
    ViewJob job;
    job.options.settings.spp = 1024;
    job.options.record_frames = 100;
    Options options("view", "Opens a window, to walk through a scene, change it and look inside.", examples);
    options.positional(
        "SCENE", std::string(scene_help) + "; without one the window offers some",
        [&](const std::string& text) { job.scene.name = text; }, false);
    add_window_options(options, job);
    add_camera_options(options, job.camera);
    add_scene_options(options, job.scene);
    add_loading_options(options, job.scene);
    add_technique_options(options, job);
    if (const auto code = options.parse(arguments)) return *code;

    check_names(job.options.settings);
    if (job.options.record.empty() != job.options.path.empty())
        throw UsageError("--record and --path belong together; give both");
    if (!job.options.script.empty()) {
        try {
            view::check_script(job.options.script);
        } catch (const Error& error) {
            throw UsageError(error.what());
        }
    }
    job.options.settings.device = settle_device(job.options.settings.device);
    set_thread_count(job.options.settings.threads);
    job.options.settings.threads = 0;
    job.options.scene = job.scene.name;
    job.options.load = [&job](const std::string& name, const LoadProgressCallback& progress) {
        return load(job, name, progress);
    };
    return view::run_viewer(job.options);
}

} // namespace snell::app

#else

namespace snell::app {

int run_view(const Arguments&)
{
    throw Error("this snell was built without the viewer",
                "install libsdl2-dev, libimgui-dev and libgl-dev and build again; `snell render` needs none of them");
}

} // namespace snell::app

#endif
