// snell bench accel: the same rays through every acceleration structure and Embree.
#include "bench_accel.h"

#include "bench_path.h"
#include "bench_refit.h"
#include "bench_results.h"
#include "bench_scene.h"
#include "bench_trace.h"
#include "camera_choice.h"
#include "console.h"
#include "names.h"
#include "options.h"
#include "scene_choice.h"
#include "usage.h"

#include "snell/bvh/options.h"
#include "snell/core/error.h"
#include "snell/core/parallel.h"
#include "snell/core/timer.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

namespace snell::app {

namespace {

struct AccelBench
{
    std::vector<std::string> scenes;
    SceneChoice choice;
    CameraChoice camera;
    bool room = false, growth = false, refit = true, path = true;
    std::vector<std::string> accels, builders, traversals; // as asked for; none: the usual selection
    std::map<std::string, std::string> parameters;         // -D
    TraceJob trace;
    std::string json_file, html_file, refit_scene = "field:1000000";
    int threads = 0;
    bool quick = false;
    bool chose_rays = false, chose_runs = false;
};

} // namespace

static StructureChoice make_choice(const AccelBench& bench, std::string accel, std::string builder,
                                   std::string traversal)
{
    StructureChoice choice;
    choice.info = accel.empty() ? &accels().front() : find_accel(accel);
    SNELL_CHECK_EQ(choice.info != nullptr, true);
    std::map<std::string, std::string> parameters = bench.parameters;
    if (!builder.empty()) parameters["builder"] = builder;
    if (!traversal.empty()) parameters["traversal"] = traversal;
    choice.options = read_accel_options(parameters);
    choice.name = std::string(choice.info->name);
    if (!builder.empty()) choice.name += " " + builder;
    if (!traversal.empty()) choice.name += " " + traversal;
    choice.builder = choice.options.build.builder.empty() ? std::string(snell::builders().front().name)
                                                          : choice.options.build.builder;
    choice.traversal = parameters.contains("traversal") ? parameters["traversal"] : "auto";
    return choice;
}

// What to measure. Without a choice of the user's: the default, every other builder, every other structure of ours, and
// every way of traversal.
static std::vector<StructureChoice> structures_of(const AccelBench& bench)
{
    std::vector<StructureChoice> list;
    const bool chosen = !bench.accels.empty() || !bench.builders.empty() || !bench.traversals.empty();
    if (chosen || bench.quick) {
        const auto or_default = [](std::vector<std::string> names) {
            if (names.empty()) names.emplace_back();
            return names;
        };
        for (const std::string& accel : or_default(bench.accels))
            for (const std::string& builder : or_default(bench.builders))
                for (const std::string& traversal : or_default(bench.traversals))
                    list.push_back(make_choice(bench, accel, builder, traversal));
        return list;
    }
    list.push_back(make_choice(bench, "", "", ""));
    for (const BuilderInfo& builder : builders())
        if (builder.name != list[0].builder) list.push_back(make_choice(bench, "", std::string(builder.name), ""));
    for (const AccelInfo& accel : accels().subspan(1))
        if (accel.name != "brute" && !accel.name.starts_with("embree"))
            list.push_back(make_choice(bench, std::string(accel.name), "", ""));
    for (const char* traversal : {"single", "packets", "stream"}) list.push_back(make_choice(bench, "", "", traversal));
    return list;
}

static void cannot_write(const std::string& name, const char* option)
{
    throw Error({name, 0, 0}, "cannot be written", fmt::format("choose another file for {}", option));
}

// Leaves what is there as it is, and no file where there was none.
static void check_writable(const std::string& name, const char* option)
{
    std::error_code error;
    const bool existed = std::filesystem::exists(name, error);
    if (!std::ofstream(name, std::ios::app)) cannot_write(name, option);
    if (!existed) std::filesystem::remove(name, error);
}

static void write_text(const std::string& name, const std::string& text, const char* option)
{
    std::ofstream file(name);
    file << text;
    file.flush();
    if (!file) cannot_write(name, option);
}

// A file without its folder.
static std::string short_name(const std::string& scene)
{
    return std::filesystem::path(scene).filename().string();
}

// ---- the command ----

static std::optional<int> read_options(const Arguments& arguments, AccelBench& bench)
{
    Options options("bench accel",
                    "Measures acceleration structures: the same rays (camera, shadow, ambient occlusion, three diffuse "
                    "bounces) through each of them and through Embree, interleaved and cross-checked.",
                    "Examples:\n"
                    "  snell bench accel --quick\n"
                    "  snell bench accel sponza.obj dragon.ply --room --json accel.json --html accel.html\n"
                    "  snell bench accel field:5000000 --builder binned --builder sbvh --no-packets\n");
    const auto whole = [](const char* option, const std::string& text, std::int64_t low, std::int64_t high) {
        return parse_integer(option, text, low, high);
    };
    options.positionals("SCENE", "Built-in scenes or files (default: cornell and field:200000)",
                        [&](const std::string& text) { bench.scenes.push_back(text); });
    options.flag("--quick", "Few rays, few runs, few structures: under a minute without SCENE",
                 [&] { bench.quick = true; });
    options.value("--rays", "N", "Rays of each kind (1048576; quick: 131072)", [&](const std::string& text) {
        bench.trace.rays = static_cast<std::size_t>(whole("--rays", text, 64, 1 << 24));
        bench.chose_rays = true;
    });
    options.value("--runs", "N", "Runs of each (5; quick: 3)", [&](const std::string& text) {
        bench.trace.runs = static_cast<int>(whole("--runs", text, 1, 1000));
        bench.chose_runs = true;
    });
    options.value("-t,--threads", "N", "What 'all threads' are; 0: all of the machine", [&](const std::string& text) {
        bench.threads = static_cast<int>(whole("--threads", text, 0, 4096));
    });
    options.flag("--room", "Put a closed room with a lamp around each scene", [&] { bench.room = true; });
    options.group("What to compare");
    options.values("--accel", "NAME", "Only this structure of ours; several may be given",
                   [&](const std::string& text) {
                       check_name("structure", text, accel_names());
                       bench.accels.push_back(text);
                   });
    options.values("--builder", "NAME", "Only this builder; several may be given", [&](const std::string& text) {
        std::vector<std::string> names;
        for (const BuilderInfo& info : builders()) names.emplace_back(info.name);
        check_name("builder", text, names);
        bench.builders.push_back(text);
    });
    options.values("--traversal", "NAME", "Only this one of auto, single, packets, stream; several may be given",
                   [&](const std::string& text) {
                       check_name("traversal", text, std::vector<std::string>{"auto", "single", "packets", "stream"});
                       bench.traversals.push_back(text);
                   });
    options.values("-D", "KEY=VALUE", "An option of the structures; see `snell list`", [&](const std::string& text) {
        auto [key, value] = parse_key_value("-D", text);
        if (!is_accel_parameter(key)) throw UsageError(fmt::format("-D {}: structures have no such option", key));
        bench.parameters[key] = value;
    });
    options.flag("--growth",
                 "Also fields of 10^4 to 10^7 triangles (quick: 10^6): the cost of a ray against their number",
                 [&] { bench.growth = true; });
    options.value("--refit-scene", "SCENE", "What is refitted, a scene without instances (field:1000000)",
                  [&](const std::string& text) { bench.refit_scene = text; });
    options.flag("--no-refit", "Leave out the refitting", [&] { bench.refit = false; });
    options.flag("--no-path", "Leave out the path tracer", [&] { bench.path = false; });
    options.flag("--no-embree", "Leave Embree out", [&] { bench.trace.embree = false; });
    options.flag("--no-packets", "Leave Embree's packets out", [&] { bench.trace.packets = false; });
    options.flag("--one-thread", "Leave the runs on all threads out", [&] { bench.trace.all_threads = false; });
    options.flag("--robust", "Embree in its watertight mode", [&] { bench.trace.robust = true; });
    options.flag("--falsify", "Spoil a few answers of all structures but the first: then the run must fail",
                 [&] { bench.trace.falsify = true; });
    options.group("Results");
    options.value("--json", "FILE", "Write the figures there as well",
                  [&](const std::string& text) { bench.json_file = text; });
    options.value("--html", "FILE", "Write a report with charts there",
                  [&](const std::string& text) { bench.html_file = text; });
    add_camera_options(options, bench.camera);
    add_loading_options(options, bench.choice);
    return options.parse(arguments);
}

// The scene's rays through all structures, and its picture.
static void measure_scene(const std::string& name, const AccelBench& bench, AccelResults& results)
{
    BenchScene scene = open_bench_scene(name, bench.choice, bench.camera, bench.room, bench.trace.rays);
    const std::string shown = short_name(name);
    results.scenes.push_back(measure_structures(shown, scene.packed, scene.camera, bench.trace, results.failures));
    print_scene(results.scenes.back(), bench.trace);
    if (!bench.path || !bench.trace.embree) return;

    console().info(fmt::format("{}: path tracing", shown));
    RenderSettings settings;
    settings.width = settings.height = bench.quick ? 160 : 384;
    settings.spp = bench.quick ? 4 : 8;
    settings.parameters["max_depth"] = "8";
    settings.threads = bench.threads;
    const StructureChoice& ours = bench.trace.ours[0];
    settings.accel = ours.info->name;
    Prepared prepared;
    prepared.packed = std::move(scene.packed);
    prepared.camera = scene.camera_desc;
    const Timer timer;
    prepared.accel = ours.info->make(prepared.packed, ours.options);
    prepared.build_seconds = timer.seconds();
    const PathFigures figures = measure_paths(prepared, settings, bench.trace.runs);
    PathResult& result = results.paths.emplace_back();
    result.scene = shown;
    result.ratio = figures.ratio;
    for (const PathContender& one : figures.contenders) {
        Spread rate = spread_of(one.rates);
        rate.median *= 1e-6, rate.low *= 1e-6, rate.high *= 1e-6;
        result.rates.emplace_back(one.name, rate);
    }
    print_path(result);
}

// One generated scene with ever more triangles, in our first structure and Embree's default.
static void measure_growth(const AccelBench& bench, AccelResults& results)
{
    TraceJob job = bench.trace;
    job.ours.resize(1);
    job.low_quality = job.high_quality = job.packets = job.all_threads = false;
    job.build_budget = 0;
    job.rays = std::min(job.rays, std::size_t{1} << 18);
    for (const char* name : {"field:10000", "field:100000", "field:1000000", "field:10000000"}) {
        if (bench.quick && std::string_view(name) == "field:10000000") continue;
        const BenchScene scene = open_bench_scene(name, bench.choice, CameraChoice(), false, job.rays);
        results.growth.push_back(measure_structures(name, scene.packed, scene.camera, job, results.failures));
    }
    print_growth(results.growth);
}

int run_bench_accel(const Arguments& arguments)
{
    AccelBench bench;
    if (const std::optional<int> code = read_options(arguments, bench)) return *code;
    if (bench.scenes.empty()) bench.scenes = {"cornell", "field:200000"};
    if (bench.quick) {
        if (!bench.chose_rays) bench.trace.rays = std::size_t{1} << 17;
        if (!bench.chose_runs) bench.trace.runs = 3;
        bench.trace.build_budget = 1.5;
    }
    set_thread_count(bench.threads);
    // Before minutes of measuring, not after.
    if (!bench.json_file.empty()) check_writable(bench.json_file, "--json");
    if (!bench.html_file.empty()) check_writable(bench.html_file, "--html");
    bench.trace.ours = structures_of(bench);

    AccelResults results;
    results.threads = thread_count();
    results.runs = bench.trace.runs;
    results.quick = bench.quick;
    for (const std::string& name : bench.scenes) measure_scene(name, bench, results);
    if (bench.growth) measure_growth(bench, results);
    if (bench.refit) {
        BenchScene scene = open_bench_scene(bench.refit_scene, bench.choice, CameraChoice(), false, bench.trace.rays);
        const StructureChoice& ours = bench.trace.ours[0];
        results.refit = measure_refit(short_name(bench.refit_scene), scene, *ours.info, ours.options,
                                      bench.trace.embree, std::max(5, bench.trace.runs), results.failures);
        print_refit(*results.refit);
    }
    print_summary(results);
    if (!bench.json_file.empty()) write_text(bench.json_file, results_json(results), "--json");
    if (!bench.html_file.empty()) write_text(bench.html_file, results_html(results), "--html");
    for (const std::string& failure : results.failures) console().error(failure);
    return results.failures.empty() ? 0 : 1;
}

} // namespace snell::app
