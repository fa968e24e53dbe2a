#include "info_bvh.h"

#include "bench_scene.h"
#include "bench_trace.h"
#include "console.h"

#include "snell/core/error.h"
#include "snell/lab/bvh_probe.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace snell::app {

void print_bvh_info(const SceneChoice& choice, bool json)
{
    TraceJob job;
    job.embree = false;
    job.all_threads = false;
    job.runs = 3;
    job.rays = std::size_t{1} << 16;
    job.build_budget = 1;
    for (const BuilderInfo& builder : builders()) {
        StructureChoice one;
        one.name = builder.name;
        one.builder = builder.name;
        one.traversal = "auto";
        one.info = &accels().front();
        one.options.build.builder = builder.name;
        job.ours.push_back(std::move(one));
    }
    const BenchScene scene = open_bench_scene(choice.name, choice, CameraChoice(), false, job.rays);
    std::vector<std::string> failures;
    const AccelScene measured = measure_structures(choice.name, scene.packed, scene.camera, job, failures);

    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    if (!json) {
        fmt::print("{}: {} triangles, {} spheres, {} instances\n", measured.name, measured.triangles, measured.spheres,
                   measured.instances);
        fmt::print("{:12} {:>9} {:>10} {:>8} {:>8} {:>9} {:>9} {:>5}   Mrays/s, one thread\n", "", "", "", "", "", "",
                   "", "");
        fmt::print("{:12} {:>9} {:>10} {:>8} {:>8} {:>9} {:>9} {:>5}", "builder", "build ms", "bytes", "SAH", "EPO",
                   "nodes", "leaves", "depth");
        for (const auto& [set, rays] : measured.sets) fmt::print(" {:>7}", set);
        fmt::print("\n");
    }
    for (std::size_t i = 0; i < measured.rows.size(); ++i) {
        const AccelRow& row = measured.rows[i];
        console().info(fmt::format("{}: quality of {}", measured.name, row.name));
        const TreeQuality quality = measure_scene_quality(scene.packed, job.ours[i].options.build).sum;
        if (json) {
            nlohmann::ordered_json traces = nlohmann::ordered_json::object();
            for (const auto& [set, figure] : row.traces) traces[set] = figure.one.median;
            list.push_back({{"builder", row.name},
                            {"build_seconds", row.build.median},
                            {"bytes", row.bytes},
                            {"sah", quality.sah},
                            {"epo", quality.epo},
                            {"nodes", quality.nodes},
                            {"leaves", quality.leaves},
                            {"references", quality.references},
                            {"depth", quality.depth},
                            {"mean_leaf_depth", quality.mean_leaf_depth},
                            {"mean_leaf_size", quality.mean_leaf_size},
                            {"mrays_per_second", std::move(traces)}});
            continue;
        }
        fmt::print("{:12} {:9.1f} {:>10} {:8.2f} {:8.2f} {:9} {:9} {:5}", row.name, 1e3 * row.build.median,
                   short_bytes(static_cast<double>(row.bytes)), quality.sah, quality.epo, quality.nodes, quality.leaves,
                   quality.depth);
        for (const auto& [set, rays] : measured.sets) {
            const auto found = row.traces.find(set);
            fmt::print(" {:7.2f}", found == row.traces.end() ? 0.0 : found->second.one.median);
        }
        fmt::print("\n");
    }
    if (json) {
        nlohmann::ordered_json all = {{"scene", measured.name},
                                      {"triangles", measured.triangles},
                                      {"spheres", measured.spheres},
                                      {"instances", measured.instances},
                                      {"builders", std::move(list)}};
        fmt::print("{}\n", all.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
    } else if (!scene.packed.groups.empty()) {
        fmt::print("nodes and leaves of the binary trees of {} groups and of the world; SAH and EPO of the largest\n",
                   scene.packed.groups.size());
    }
    if (!failures.empty()) throw Error(failures.front(), "the builders' trees must give the same hits; please report");
}

} // namespace snell::app
