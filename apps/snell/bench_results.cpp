#include "bench_results.h"

#include "snell/core/parallel.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace snell::app {

AccelRatios AccelResults::summary(bool all_threads) const
{
    std::vector<AccelRatios> all;
    for (const AccelScene& scene : scenes) all.push_back(ratios_of(scene, scene.rows[0], all_threads));
    if (refit) all.emplace_back().refit = refit->ratio;
    for (const PathResult& path : paths) all.emplace_back().path = path.ratio;
    return mean_ratios(all);
}

double nanoseconds_a_ray(const AccelRow& row, const std::string& set)
{
    const auto found = row.traces.find(set);
    const double rate = found == row.traces.end() ? 0 : found->second.one.median;
    return rate > 0 ? 1e3 / rate : 0;
}

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

void print_scene(const AccelScene& scene, const TraceJob& job)
{
    print_rows(scene, job);
    if (!scene.rows.back().is_ours()) {
        print_ratios(scene, scene.rows[0], false);
        if (job.trace && job.all_threads) print_ratios(scene, scene.rows[0], true);
    }
    std::fflush(stdout);
}

void print_growth(const std::vector<AccelScene>& growth)
{
    if (growth.empty()) return;
    fmt::print("Growth: nanoseconds a ray, one thread, and for incoherent rays what each step adds per tenfold\n");
    fmt::print("{:>12} {:20}", "triangles", "");
    for (const auto& [set, rays] : growth[0].sets) fmt::print(" {:>8}", set);
    fmt::print(" {:>10} {:>9}\n", "incoherent", "+ per 10x");
    for (std::size_t i = 0; i < growth.size(); ++i) {
        for (const AccelRow& row : growth[i].rows) {
            fmt::print("{:12} {:20}", growth[i].triangles, row.name);
            for (const auto& [set, rays] : growth[i].sets) fmt::print(" {:8.1f}", nanoseconds_a_ray(row, set));
            const double cost = 1e3 / incoherent_speed(row).value_or(infinity());
            fmt::print(" {:10.1f}", cost);
            if (i > 0) {
                const auto& before = growth[i - 1];
                const std::size_t number = static_cast<std::size_t>(&row - growth[i].rows.data());
                const double old = 1e3 / incoherent_speed(before.rows[number]).value_or(infinity());
                const double decades =
                    std::log10(static_cast<double>(growth[i].triangles) / static_cast<double>(before.triangles));
                fmt::print(" {:9.1f}", (cost - old) / decades);
            }
            fmt::print("\n");
        }
    }
    std::fflush(stdout);
}

void print_refit(const RefitFigures& refit)
{
    fmt::print("Refit of {} triangles ({}), all {} threads: {:.1f} ms ({:.1f} to {:.1f}); from nothing {:.1f} ms",
               refit.triangles, refit.scene, thread_count(), 1e3 * refit.ours.median, 1e3 * refit.ours.low,
               1e3 * refit.ours.high, 1e3 * refit.rebuild_seconds);
    if (refit.ratio)
        fmt::print("; Embree {:.1f} ms ({:.1f} to {:.1f}): ratio {:.2f}", 1e3 * refit.embree.median,
                   1e3 * refit.embree.low, 1e3 * refit.embree.high, *refit.ratio);
    fmt::print("\n");
    std::fflush(stdout);
}

void print_path(const PathResult& path)
{
    fmt::print("Path tracing {}, 8 bounces, Msamples per second of CPU time:", path.scene);
    for (const auto& [name, rate] : path.rates)
        fmt::print(" {} {:.3f} ({:.3f} to {:.3f});", name, rate.median, rate.low, rate.high);
    fmt::print(" ratio {}\n", ratio(path.ratio));
    std::fflush(stdout);
}

void print_summary(const AccelResults& results)
{
    const AccelRatios one = results.summary(), all = results.summary(true);
    const auto pair = [](const std::optional<double>& a, const std::optional<double>& b) {
        return fmt::format("{} ({})", ratio(a), ratio(b));
    };
    fmt::print("Summary, geometric means of the ratios to Embree, one thread (all threads); above 1 snell is ahead:\n"
               "  incoherent {}  any hit {}  camera {}  build {}  refit {}  bytes {}  path {}\n",
               pair(one.incoherent, all.incoherent), pair(one.any_hit, all.any_hit), pair(one.camera, all.camera),
               ratio(one.build), ratio(one.refit), ratio(one.bytes), ratio(one.path));
}

} // namespace snell::app
