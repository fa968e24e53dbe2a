// snell info: what is in a scene, what was mended, and what looks wrong.
#include "commands.h"
#include "console.h"
#include "info_bvh.h"
#include "options.h"
#include "scene_choice.h"

#include "snell/io/load.h"
#include "snell/scene/doctor.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cstring>
#include <map>

namespace snell::app {

namespace {
struct Summary
{
    Scene scene;
    SceneReport report;
    double load_seconds = 0, examine_seconds = 0;
};
} // namespace

using Json = nlohmann::ordered_json;

static Summary summarise(const SceneChoice& choice)
{
    using Clock = std::chrono::steady_clock;
    const auto seconds = [](Clock::duration d) { return std::chrono::duration<double>(d).count(); };
    Summary summary;
    const auto start = Clock::now();
    summary.scene = load_chosen(choice);
    const auto loaded = Clock::now();
    summary.report = examine(summary.scene);
    summary.load_seconds = seconds(loaded - start);
    summary.examine_seconds = seconds(Clock::now() - loaded);
    return summary;
}

// ---- text ----

// A name from a file on one line of a terminal: control characters would do things there.
static std::string printable(std::string text)
{
    for (char& c : text)
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
    return text;
}

// As a shell takes it for one word.
static std::string shell_word(const std::string& text)
{
    const auto is_plain = [](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) || std::strchr("_-.,:/+", c);
    };
    if (!text.empty() && std::all_of(text.begin(), text.end(), is_plain)) return text;
    std::string word = "'";
    for (const char c : printable(text)) word += c == '\'' ? "'\\''" : std::string(1, c);
    return word + "'";
}

// A table of two columns; a row without a name goes on with the one above.
static void row(const char* name, const std::string& value)
{
    fmt::print("{:12} {}\n", name, printable(value));
}

static std::string in_words(const SceneReport::Tally& tally)
{
    std::string words;
    for (const auto& [kind, count] : tally) words += fmt::format("{}{} {}", words.empty() ? ": " : ", ", count, kind);
    return words;
}

static std::string size_in_words(std::size_t bytes)
{
    return short_bytes(static_cast<double>(bytes));
}

static void print_textures(const SceneReport& report)
{
    row("textures", report.textures.empty()
                        ? "0"
                        : fmt::format("{}, {}", report.textures.size(), size_in_words(report.texture_bytes)));
    const std::size_t shown = console().level == Console::Level::verbose ? report.textures.size() : 8;
    for (std::size_t i = 0; i < report.textures.size() && i < shown; ++i) {
        const SceneReport::Texture& t = report.textures[i];
        row("", fmt::format("{} x {} {} '{}'", t.width, t.height, t.format, t.name));
    }
    if (report.textures.size() > shown)
        row("", fmt::format("and {} more; -v shows all", report.textures.size() - shown));
}

static void print_cameras(const Scene& scene)
{
    if (scene.cameras.empty()) row("cameras", "0");
    for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
        const CameraDesc& c = scene.cameras[i];
        const std::string up = c.up == vec3(0, 1, 0) ? "" : fmt::format(" --up {:g},{:g},{:g}", c.up.x, c.up.y, c.up.z);
        row(i == 0 ? "cameras" : "", fmt::format("{}: '{}' --eye {:g},{:g},{:g} --target {:g},{:g},{:g}{} --fov {:g}{}",
                                                 i, c.name, c.eye.x, c.eye.y, c.eye.z, c.target.x, c.target.y,
                                                 c.target.z, up, c.fov_degrees, c.mirrored ? " (mirrored)" : ""));
    }
    if (scene.cameras.size() > 1) row("", "choose one with --camera NAME or number");
}

static void print_motion(const Scene& scene, const SceneReport& report)
{
    for (std::size_t i = 0; i < scene.animations.size(); ++i) {
        const Animation& a = scene.animations[i];
        row(i == 0 ? "animations" : "", fmt::format("{}: '{}' of {:g} s, {} channels: --animation {}", i, a.name,
                                                    a.duration, a.channels.size(), i));
    }
    if (!scene.skins.empty() || report.morph_targets > 0)
        row("deforming", fmt::format("{} meshes, {} skins, {} morph targets", scene.rigs.size(), scene.skins.size(),
                                     report.morph_targets));
    for (std::size_t i = 0; i < scene.variants.size(); ++i)
        row(i == 0 ? "variants" : "", fmt::format("--variant {}", shell_word(scene.variants[i])));
}

static std::string environment_in_words(const Scene& scene)
{
    const EnvironmentDesc& e = scene.environment;
    std::string words = fmt::format("{:g} {:g} {:g}", e.radiance.x, e.radiance.y, e.radiance.z);
    if (e.image.valid()) words += fmt::format(" times the picture '{}'", scene.images[e.image.value].name);
    if (!e.visible) words += ", hidden from the camera";
    return words;
}

static void print_hints(const RenderHints& hints)
{
    std::string words;
    const auto say = [&](const std::string& text) { words += (words.empty() ? "" : " ") + text; };
    if (hints.width && hints.height) say(fmt::format("--size {}x{}", *hints.width, *hints.height));
    if (hints.spp) say(fmt::format("--spp {}", *hints.spp));
    if (hints.integrator) say(fmt::format("--integrator {}", shell_word(*hints.integrator)));
    if (hints.max_depth) say(fmt::format("-D max_depth={}", *hints.max_depth));
    if (hints.seed) say(fmt::format("--seed {}", *hints.seed));
    if (!words.empty()) row("asks for", words);
}

static void print_table(const Summary& summary)
{
    const Scene& scene = summary.scene;
    const SceneReport& report = summary.report;
    row("scene", scene.name);
    row("meshes", fmt::format("{} with {} triangles", scene.meshes.size(), report.mesh_triangles));
    row("spheres", std::to_string(scene.spheres.size()));
    row("planes", std::to_string(scene.planes.size()));
    row("instances", fmt::format("{} of {} groups: {} triangles and {} spheres in all", scene.instances.size(),
                                 scene.groups.size(), report.placed_triangles, report.placed_spheres));
    row("materials", fmt::format("{}{}", scene.materials.size(), in_words(report.materials)));
    print_textures(report);
    row("lights", fmt::format("{}{}", report.light_count, in_words(report.lights)));
    row("environment", environment_in_words(scene));
    print_cameras(scene);
    print_motion(scene, report);
    print_hints(scene.hints);
    if (const Bounds& b = report.bounds; b.empty())
        row("bounds", "empty");
    else
        row("bounds", fmt::format("{:g} {:g} {:g} to {:g} {:g} {:g}", b.lower.x, b.lower.y, b.lower.z, b.upper.x,
                                  b.upper.y, b.upper.z));
    row("memory", fmt::format("scene {} (textures {}), packed {}, acceleration structure about {}",
                              size_in_words(report.scene_bytes), size_in_words(report.texture_bytes),
                              size_in_words(report.packed_bytes), size_in_words(report.accel_bytes)));
    row("to render", fmt::format("about {} at most, and the picture", size_in_words(report.peak_bytes)));
    row("loaded in",
        fmt::format("{}, examined in {}", short_time(summary.load_seconds), short_time(summary.examine_seconds)));
}

// The gravest last, where they are seen first.
static void print_findings(const SceneReport& report)
{
    const std::size_t most = console().level == Console::Level::verbose ? SceneReport::listed_of_a_kind + 1 : 5;
    std::map<std::string, std::size_t> seen;
    std::vector<std::string> lines;
    for (const Finding& finding : report.findings)
        if (++seen[finding.kind] <= most)
            lines.push_back(printable(fmt::format("{:9} {}", to_string(finding.severity), finding.text)));
    if (!lines.empty()) fmt::print("\n");
    for (auto line = lines.rbegin(); line != lines.rend(); ++line) fmt::print("{}\n", *line);
    for (const auto& [kind, count] : seen)
        if (count > most) fmt::print("          ... {} more of '{}'; -v shows them\n", count - most, kind);
    fmt::print("\n{} repaired, {} doubtful{}\n", report.repaired, report.doubtful,
               report.errors > 0 ? fmt::format(", {} that cannot be rendered", report.errors) : "");
}

// ---- JSON; the keys are documented in docs/info.md ----

static Json triple(const vec3& v)
{
    return Json::array({v.x, v.y, v.z});
}

static Json by_kind(const SceneReport::Tally& tally)
{
    Json json = Json::object();
    for (const auto& [kind, count] : tally) json[kind] = count;
    return json;
}

static Json hints_json(const RenderHints& hints)
{
    Json json = Json::object();
    if (hints.width) json["width"] = *hints.width;
    if (hints.height) json["height"] = *hints.height;
    if (hints.crop_window) json["crop_window"] = *hints.crop_window;
    if (hints.spp) json["spp"] = *hints.spp;
    if (hints.seed) json["seed"] = *hints.seed;
    if (hints.sampler) json["sampler"] = *hints.sampler;
    if (hints.integrator) json["integrator"] = *hints.integrator;
    if (hints.max_depth) json["max_depth"] = *hints.max_depth;
    if (hints.output) json["output"] = *hints.output;
    return json;
}

static Json lists_json(const Summary& summary)
{
    const Scene& scene = summary.scene;
    Json json;
    json["cameras"] = Json::array();
    for (const CameraDesc& camera : scene.cameras)
        json["cameras"].push_back({{"name", camera.name},
                                   {"eye", triple(camera.eye)},
                                   {"target", triple(camera.target)},
                                   {"up", triple(camera.up)},
                                   {"fov_degrees", camera.fov_degrees},
                                   {"mirrored", camera.mirrored}});
    json["texture_list"] = Json::array();
    for (const SceneReport::Texture& t : summary.report.textures)
        json["texture_list"].push_back(
            {{"name", t.name}, {"width", t.width}, {"height", t.height}, {"format", t.format}, {"bytes", t.bytes}});
    json["animations"] = Json::array();
    for (const Animation& a : scene.animations)
        json["animations"].push_back({{"name", a.name}, {"seconds", a.duration}, {"channels", a.channels.size()}});
    json["variants"] = scene.variants;
    json["hints"] = hints_json(scene.hints);
    json["notes"] = Json::array();
    for (const Note& note : scene.notes)
        json["notes"].push_back({{"kind", note.kind == Note::Kind::warning ? "warning" : "info"}, {"text", note.text}});
    json["findings"] = Json::array();
    for (const Finding& f : summary.report.findings)
        json["findings"].push_back(
            {{"kind", f.kind}, {"severity", to_string(f.severity)}, {"text", f.text}, {"count", f.count}});
    return json;
}

static void print_json(const Summary& summary)
{
    const Scene& scene = summary.scene;
    const SceneReport& report = summary.report;
    Json json;
    json["scene"] = scene.name;
    json["meshes"] = scene.meshes.size();
    json["triangles"] = report.mesh_triangles;
    json["spheres"] = scene.spheres.size();
    json["planes"] = scene.planes.size();
    json["groups"] = scene.groups.size();
    json["instances"] = scene.instances.size();
    json["mirrored_instances"] = report.mirrored_instances;
    json["placed_triangles"] = report.placed_triangles;
    json["placed_spheres"] = report.placed_spheres;
    json["materials"] = scene.materials.size();
    json["materials_by_kind"] = by_kind(report.materials);
    json["textures"] = scene.images.size();
    json["lights"] = report.light_count;
    json["lights_by_kind"] = by_kind(report.lights);
    json["environment"] = triple(scene.environment.radiance);
    json["environment_image"] =
        scene.environment.image.valid() ? Json(scene.images[scene.environment.image.value].name) : Json(nullptr);
    json["nodes"] = scene.nodes.size();
    json["skins"] = scene.skins.size();
    json["deforming_meshes"] = scene.rigs.size();
    json["morph_targets"] = report.morph_targets;
    if (report.bounds.empty())
        json["bounds"] = nullptr;
    else
        json["bounds"] = {{"lower", triple(report.bounds.lower)}, {"upper", triple(report.bounds.upper)}};
    json["bytes"] = {{"scene", report.scene_bytes},
                     {"textures", report.texture_bytes},
                     {"packed", report.packed_bytes},
                     {"accel_forecast", report.accel_bytes},
                     {"peak_forecast", report.peak_bytes}};
    json["seconds"] = {{"load", summary.load_seconds}, {"examine", summary.examine_seconds}};
    json["counts"] = {
        {"info", report.infos}, {"repaired", report.repaired}, {"doubtful", report.doubtful}, {"error", report.errors}};
    json.update(lists_json(summary));
    // Names from files need not be UTF-8.
    fmt::print("{}\n", json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
}

int run_info(const Arguments& arguments)
{
    SceneChoice choice;
    bool json = false, strict = false, bvh = false;
    Options options(
        "info", "Says what is in a scene, what was repaired, what looks wrong, and how much memory it takes.",
        "Examples:\n  snell info dragon.ply\n  snell info cornell --json\n  snell info dragon.ply --bvh\n  snell info model.glb --strict\n");
    options.positional("SCENE", scene_help, [&](const std::string& text) { choice.name = text; });
    add_loading_options(options, choice);
    options.flag("--json", "Print one JSON object", [&] { json = true; });
    options.flag("--bvh", "Instead, a table of what each builder of acceleration structures makes of the scene",
                 [&] { bvh = true; });
    options.flag("--strict", "Exit with 1 if anything is doubtful", [&] { strict = true; });
    options.flag("-q,--quiet", "Print no findings", [] { console().level = Console::Level::quiet; });
    options.flag("-v,--verbose", "Print all findings and textures", [] { console().level = Console::Level::verbose; });
    if (const auto code = options.parse(arguments)) return *code;

    if (bvh) {
        print_bvh_info(choice, json);
        return 0;
    }
    const Summary summary = summarise(choice);
    if (json)
        print_json(summary);
    else {
        print_table(summary);
        if (console().level != Console::Level::quiet) print_findings(summary.report);
    }
    const std::size_t doubts = summary.report.doubtful + summary.report.errors;
    return strict && doubts > 0 ? 1 : 0;
}

} // namespace snell::app
