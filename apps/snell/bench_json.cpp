// The figures for programs.
#include "bench_results.h"

#include "snell/core/version.h"

#include <nlohmann/json.hpp>

#include <algorithm>

namespace snell::app {

using Json = nlohmann::ordered_json;

static Json spread_json(const Spread& spread)
{
    return {{"median", spread.median}, {"low", spread.low}, {"high", spread.high}};
}

static Json optional_json(const std::optional<double>& value)
{
    return value ? Json(*value) : Json(nullptr);
}

static Json ratios_json(const AccelRatios& r)
{
    return {{"incoherent", optional_json(r.incoherent)},
            {"any_hit", optional_json(r.any_hit)},
            {"camera", optional_json(r.camera)},
            {"build", optional_json(r.build)},
            {"refit", optional_json(r.refit)},
            {"bytes", optional_json(r.bytes)},
            {"path", optional_json(r.path)}};
}

static Json row_json(const AccelScene& scene, const AccelRow& row)
{
    static constexpr const char* qualities[] = {"", "low", "medium", "high"};
    Json json = {{"name", row.name}, {"kind", row.is_ours() ? "snell" : "embree"}};
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
    auto& traces = json["mrays_per_second"] = Json::object();
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

static Json scene_json(const AccelScene& scene)
{
    Json json = {{"scene", scene.name},
                 {"triangles", scene.triangles},
                 {"spheres", scene.spheres},
                 {"instances", scene.instances}};
    auto& sets = json["rays"] = Json::object();
    for (const auto& [set, rays] : scene.sets) sets[set] = rays;
    auto& rows = json["rows"] = Json::array();
    for (const AccelRow& row : scene.rows) rows.push_back(row_json(scene, row));
    json["ratios"] = ratios_json(ratios_of(scene, scene.rows[0]));
    json["ratios_all_threads"] = ratios_json(ratios_of(scene, scene.rows[0], true));
    json["on_front"] = is_on_front(scene, scene.rows[0]);
    return json;
}

static Json refit_json(const RefitFigures& refit)
{
    Json json = {{"scene", refit.scene},
                 {"triangles", refit.triangles},
                 {"seconds", spread_json(refit.ours)},
                 {"rebuild_seconds", refit.rebuild_seconds}};
    json["embree_seconds"] = refit.ratio ? spread_json(refit.embree) : Json(nullptr);
    json["ratio"] = optional_json(refit.ratio);
    return json;
}

static Json path_json(const PathResult& path)
{
    Json json = {{"scene", path.scene}};
    auto& rows = json["rows"] = Json::array();
    for (const auto& [name, rate] : path.rates)
        rows.push_back({{"name", name}, {"msamples_per_core_second", spread_json(rate)}});
    json["ratio"] = optional_json(path.ratio);
    return json;
}

static Json growth_json(const AccelScene& scene)
{
    Json json = {{"triangles", scene.triangles}};
    auto& rows = json["nanoseconds_a_ray"] = Json::object();
    for (const AccelRow& row : scene.rows)
        for (const auto& [set, rays] : scene.sets) rows[row.name][set] = nanoseconds_a_ray(row, set);
    return json;
}

std::string results_json(const AccelResults& results)
{
    Json json = {{"version", version()},
                 {"commit", commit()},
                 {"compiler", compiler()},
                 {"threads", results.threads},
                 {"runs", results.runs},
                 {"quick", results.quick},
                 {"summary", ratios_json(results.summary())}};
    json["summary_all_threads"] = ratios_json(results.summary(true));
    const auto list = [&](const char* key, const auto& all, const auto& one_json) {
        json[key] = Json::array();
        for (const auto& one : all) json[key].push_back(one_json(one));
    };
    list("scenes", results.scenes, scene_json);
    list("growth", results.growth, growth_json);
    list("path", results.paths, path_json);
    json["refit"] = results.refit ? refit_json(*results.refit) : Json(nullptr);
    json["failures"] = results.failures;
    // Names from files need not be UTF-8.
    return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

} // namespace snell::app
