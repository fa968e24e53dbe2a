// snell bench: samples a second of the whole renderer, beside a plain path tracer over Embree in the same run.
#include "bench_accel.h"
#include "bench_path.h"
#include "camera_choice.h"
#include "commands.h"
#include "console.h"
#include "options.h"
#include "scene_choice.h"
#include "usage.h"

#include "snell/bvh/cache.h"
#include "snell/core/error.h"
#include "snell/core/parallel.h"
#include "snell/lab/accel_figures.h"
#include "snell/lab/metrics.h"
#include "snell/render/render.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <fstream>

namespace snell::app {

namespace {
struct BenchJob
{
    std::vector<std::string> scenes;
    std::string json_file;
    RenderSettings settings;
    CameraChoice camera;
    SceneChoice choice; // for each scene
    int runs = 5;
};
} // namespace

static nlohmann::json bench_scene(const std::string& name, const BenchJob& job)
{
    SceneChoice choice = job.choice;
    choice.name = name;
    Scene scene = open_chosen(choice);
    choose_camera(scene, job.camera, 1.0f);
    hide_environment(scene, choice);
    const std::unique_ptr<Prepared> prepared = prepare(scene, job.settings);
    const PathFigures figures = measure_paths(*prepared, job.settings, job.runs);
    const double samples = figures.samples;

    fmt::print("{}: {} triangles, {}x{}, {} spp, path, max_depth {}, {} threads, median of {} interleaved runs\n", name,
               prepared->packed.triangles.size(), job.settings.width, job.settings.height, job.settings.spp,
               figures.max_depth, thread_count(), job.runs);
    fmt::print("  {:18} {:>14} {:>15} {:>14} {:>9} {:>9}  {}\n", "", "Msamples/s", "per core-second", "(spread)",
               "Mrays/s", "build ms", "picture against the first (relMSE)");
    nlohmann::json rows = nlohmann::json::array();
    for (const PathContender& one : figures.contenders) {
        const Spread rate = spread_of(one.rates);
        const double wall = spread_of(one.wall_rates).median;
        const double difference = compare_pictures(one.picture, figures.contenders[0].picture).relmse;
        fmt::print("  {:18} {:14.3f} {:15.3f} {:>14} {:9.2f} {:9.1f}  {:.2g}\n", one.name, wall * 1e-6,
                   rate.median * 1e-6, fmt::format("{:.2f}-{:.2f}", rate.low * 1e-6, rate.high * 1e-6),
                   wall * static_cast<double>(one.rays) / samples * 1e-6, one.build_seconds * 1e3, difference);
        rows.push_back({{"name", one.name},
                        {"samples_per_second", wall},
                        {"samples_per_core_second", rate.median},
                        {"rays_per_second", wall * static_cast<double>(one.rays) / samples},
                        {"build_seconds", one.build_seconds},
                        {"relmse_to_first", difference}});
    }
    nlohmann::json result = {{"scene", name}, {"rows", rows}};
    if (figures.ratio) {
        fmt::print("  ratio to the better Embree: {:.2f}\n", *figures.ratio);
        result["ratio"] = *figures.ratio;
    } else {
        fmt::print("  (built without Embree: nothing to compare with; install libembree-dev and build again)\n");
    }
    return result;
}

static int run_bench_path(const Arguments& arguments)
{
    BenchJob job;
    job.settings.width = job.settings.height = 512;
    job.settings.spp = 16;
    job.settings.parameters["max_depth"] = "8";
    const auto whole_number = [](const char* option, const std::string& text, int low, int high) {
        return static_cast<int>(parse_integer(option, text, low, high));
    };
    Options options("bench",
                    "Measures the path tracer's samples a second beside a plain one over Embree with the same kernels, "
                    "interleaved in one run",
                    "`snell bench accel SCENE...` measures the acceleration structures instead: see its --help.\n\n"
                    "Examples:\n"
                    "  snell bench cornell --size 256 --max-depth 0\n"
                    "  snell bench sponza.obj dragon.ply --json bench.json\n");
    options.positionals("SCENE", "Built-in scene or file; several are measured one after the other (default: cornell)",
                        [&](const std::string& text) { job.scenes.push_back(text); });
    options.value("--size", "N", "Pixels a side (512)", [&](const std::string& text) {
        job.settings.width = job.settings.height = whole_number("--size", text, 1, 16384);
    });
    options.value("--spp", "N", "Samples a pixel (16)", [&](const std::string& text) {
        job.settings.spp = static_cast<uint>(whole_number("--spp", text, 1, 1 << 20));
    });
    options.value("--max-depth", "N", "Bounces; 0: no limit (8)", [&](const std::string& text) {
        job.settings.parameters["max_depth"] = std::to_string(whole_number("--max-depth", text, 0, 1000));
    });
    options.value("--runs", "N", "Runs of each (5)",
                  [&](const std::string& text) { job.runs = whole_number("--runs", text, 1, 1000); });
    options.value("--accel", "NAME", "Acceleration structure of ours",
                  [&](const std::string& text) { job.settings.accel = text; });
    options.value("--accel-cache", "DIR", "Keep our trees there; then their build time is that of loading them",
                  [&](const std::string& text) {
                      check_cache_folder(text);
                      job.settings.accel_options.cache = text;
                  });
    options.value("-t,--threads", "N", "Threads; 0: all",
                  [&](const std::string& text) { job.settings.threads = whole_number("--threads", text, 0, 4096); });
    options.value("--json", "FILE", "Write the figures there as well",
                  [&](const std::string& text) { job.json_file = text; });
    add_camera_options(options, job.camera);
    add_scene_options(options, job.choice);
    add_loading_options(options, job.choice);
    if (const std::optional<int> code = options.parse(arguments)) return *code;
    if (job.scenes.empty()) job.scenes.push_back("cornell");

    nlohmann::json results = nlohmann::json::array();
    for (const std::string& scene : job.scenes) results.push_back(bench_scene(scene, job));
    if (!job.json_file.empty()) {
        std::ofstream file(job.json_file);
        file << results.dump(2) << '\n';
        if (!file) throw Error({job.json_file, 0, 0}, "cannot be written", "choose another file for --json");
    }
    return 0;
}

int run_bench(const Arguments& arguments)
{
    const bool named = !arguments.empty() && (arguments[0] == "accel" || arguments[0] == "path");
    const Arguments rest(arguments.begin() + (named ? 1 : 0), arguments.end());
    return named && arguments[0] == "accel" ? run_bench_accel(rest) : run_bench_path(rest);
}

} // namespace snell::app
