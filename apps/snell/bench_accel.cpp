// snell bench accel: the same rays through every acceleration structure and Embree.
#include "bench_accel.h"

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
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <fstream>

namespace snell::app {

namespace {

struct AccelBench
{
    std::vector<std::string> scenes;
    SceneChoice choice;
    CameraChoice camera;
    bool room = false;
    std::vector<std::string> accels, builders, traversals; // as asked for; none: the usual selection
    std::map<std::string, std::string> parameters;         // -D
    TraceJob trace;
    std::string json_file, html_file;
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

// ---- the table ----

static std::string number(double value)
{
    return value <= 0 ? "-" : value < 9.995 ? fmt::format("{:.2f}", value) : fmt::format("{:.1f}", value);
}

// How far the runs lie apart, in percent of their median.
static double spread_percent(const Spread& spread)
{
    return spread.median > 0 ? 50.0 * (spread.high - spread.low) / spread.median : 0.0;
}

static void print_rows(const AccelScene& scene, const TraceJob& job)
{
    fmt::print("{}: {} triangles", scene.name, scene.triangles);
    if (scene.spheres > 0) fmt::print(", {} spheres", scene.spheres);
    if (scene.instances > 0) fmt::print(", {} instances", scene.instances);
    if (job.trace)
        fmt::print("; Mrays per second of CPU time: one thread (+-% between {} runs), all {} threads", job.runs,
                   thread_count());
    fmt::print("\n{:28} {:>9} {:>6}", "", "build ms", "B/tri");
    for (const auto& [set, rays] : scene.sets) fmt::print(" {:>16}", set);
    fmt::print("\n");
    for (const AccelRow& row : scene.rows) {
        const double primitives = static_cast<double>(std::max<std::size_t>(scene.triangles + scene.spheres, 1));
        fmt::print("{:28} {:9.1f} {:6.1f}", row.name, 1e3 * row.build.median,
                   static_cast<double>(row.bytes) / primitives);
        for (const auto& [set, rays] : scene.sets) {
            const auto found = row.traces.find(set);
            if (found == row.traces.end()) {
                fmt::print(" {:>16}", "");
                continue;
            }
            const TraceFigure& figure = found->second;
            fmt::print(" {:>6} {:>3} {:>5}", number(figure.one.median),
                       fmt::format("{:.0f}%", spread_percent(figure.one)), number(figure.all.median));
        }
        fmt::print("\n");
    }
}

static std::string ratio(const std::optional<double>& value)
{
    return value ? fmt::format("{:.2f}", *value) : "-";
}

static void print_ratios(const AccelScene& scene, const AccelRow& row, bool all_threads)
{
    const AccelRatios r = ratios_of(scene, row, all_threads);
    const auto of = [&](const char* set) { return ratio(set_ratio(scene, row, set, all_threads)); };
    fmt::print("  {} over the better Embree, {}: camera {}, any hit {} (shadow {}, ao {}), incoherent {} ({}, {}, {})",
               row.name, all_threads ? "all threads" : "one thread", ratio(r.camera), ratio(r.any_hit), of("shadow"),
               of("ao"), ratio(r.incoherent), of("bounce1"), of("bounce2"), of("bounce3"));
    if (!all_threads) fmt::print(", build {}, bytes {}", ratio(r.build), ratio(r.bytes));
    fmt::print("\n");
}

static void print_scene(const AccelScene& scene, const TraceJob& job)
{
    print_rows(scene, job);
    if (!scene.rows.back().is_ours()) {
        print_ratios(scene, scene.rows[0], false);
        if (job.trace && job.all_threads) print_ratios(scene, scene.rows[0], true);
    }
    std::fflush(stdout);
}

// ---- JSON ----

static nlohmann::ordered_json spread_json(const Spread& spread)
{
    return {{"median", spread.median}, {"low", spread.low}, {"high", spread.high}};
}

static nlohmann::ordered_json ratios_json(const AccelRatios& r)
{
    const auto value = [](const std::optional<double>& v) -> nlohmann::ordered_json {
        if (v) return *v;
        return nullptr;
    };
    return {{"incoherent", value(r.incoherent)},
            {"any_hit", value(r.any_hit)},
            {"camera", value(r.camera)},
            {"build", value(r.build)},
            {"refit", value(r.refit)},
            {"bytes", value(r.bytes)},
            {"path", value(r.path)}};
}

static nlohmann::ordered_json row_json(const AccelScene& scene, const AccelRow& row)
{
    static constexpr const char* qualities[] = {"", "low", "medium", "high"};
    nlohmann::ordered_json json = {{"name", row.name}, {"kind", row.is_ours() ? "snell" : "embree"}};
    if (row.is_ours()) {
        json["accel"] = row.accel, json["builder"] = row.builder, json["traversal"] = row.traversal;
        json["nodes"] = row.nodes, json["sah_cost"] = row.sah_cost;
    } else {
        json["quality"] = qualities[static_cast<int>(row.quality)];
        json["rays_a_call"] = row.packet;
    }
    const double primitives = static_cast<double>(std::max<std::size_t>(scene.triangles + scene.spheres, 1));
    json["build_seconds"] = spread_json(row.build);
    json["build_cpu_seconds"] = row.build_cpu_seconds;
    json["bytes"] = row.bytes;
    json["bytes_per_primitive"] = static_cast<double>(row.bytes) / primitives;
    auto& traces = json["mrays_per_second"] = nlohmann::ordered_json::object();
    for (const auto& [set, rays] : scene.sets) {
        const auto found = row.traces.find(set);
        if (found == row.traces.end()) continue;
        traces[set] = {{"one_thread", spread_json(found->second.one)},
                       {"all_threads", spread_json(found->second.all)},
                       {"wall", spread_json(found->second.wall)},
                       {"disagreements", found->second.disagreements}};
    }
    return json;
}

static nlohmann::ordered_json scene_json(const AccelScene& scene)
{
    nlohmann::ordered_json json = {{"scene", scene.name},
                                   {"triangles", scene.triangles},
                                   {"spheres", scene.spheres},
                                   {"instances", scene.instances}};
    auto& sets = json["rays"] = nlohmann::ordered_json::object();
    for (const auto& [set, rays] : scene.sets) sets[set] = rays;
    auto& rows = json["rows"] = nlohmann::ordered_json::array();
    for (const AccelRow& row : scene.rows) rows.push_back(row_json(scene, row));
    json["ratios"] = ratios_json(ratios_of(scene, scene.rows[0]));
    json["ratios_all_threads"] = ratios_json(ratios_of(scene, scene.rows[0], true));
    json["on_front"] = is_on_front(scene, scene.rows[0]);
    return json;
}

static void write_text(const std::string& name, const std::string& text, const char* option)
{
    std::ofstream file(name);
    file << text;
    file.flush();
    if (!file) throw Error({name, 0, 0}, "cannot be written", fmt::format("choose another file for {}", option));
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
    options.flag("--no-embree", "Leave Embree out", [&] { bench.trace.embree = false; });
    options.flag("--no-packets", "Leave Embree's packets out", [&] { bench.trace.packets = false; });
    options.flag("--one-thread", "Leave the runs on all threads out", [&] { bench.trace.all_threads = false; });
    options.flag("--robust", "Embree in its watertight mode", [&] { bench.trace.robust = true; });
    options.group("Results");
    options.value("--json", "FILE", "Write the figures there as well",
                  [&](const std::string& text) { bench.json_file = text; });
    add_camera_options(options, bench.camera);
    add_loading_options(options, bench.choice);
    return options.parse(arguments);
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
    bench.trace.ours = structures_of(bench);

    std::vector<std::string> failures;
    std::vector<AccelScene> scenes;
    std::vector<AccelRatios> ratios, ratios_all;
    for (const std::string& name : bench.scenes) {
        const BenchScene scene = open_bench_scene(name, bench.choice, bench.camera, bench.room, bench.trace.rays);
        scenes.push_back(measure_structures(name, scene.packed, scene.camera, bench.trace, failures));
        print_scene(scenes.back(), bench.trace);
        ratios.push_back(ratios_of(scenes.back(), scenes.back().rows[0]));
        ratios_all.push_back(ratios_of(scenes.back(), scenes.back().rows[0], true));
    }
    if (!bench.json_file.empty()) {
        nlohmann::ordered_json json = {{"threads", thread_count()}, {"runs", bench.trace.runs}};
        json["scenes"] = nlohmann::ordered_json::array();
        for (const AccelScene& scene : scenes) json["scenes"].push_back(scene_json(scene));
        json["summary"] = ratios_json(mean_ratios(ratios));
        json["summary_all_threads"] = ratios_json(mean_ratios(ratios_all));
        json["failures"] = failures;
        write_text(bench.json_file, json.dump(2) + "\n", "--json");
    }
    for (const std::string& failure : failures) console().error(failure);
    return failures.empty() ? 0 : 1;
}

} // namespace snell::app
