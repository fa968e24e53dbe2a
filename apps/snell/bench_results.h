// What `snell bench accel` has found, and how it is shown: tables, JSON, HTML.
#pragma once

#include "bench_refit.h"
#include "bench_trace.h"

#include "snell/lab/accel_figures.h"

#include <optional>
#include <string>
#include <vector>

namespace snell::app {

// The whole renderer beside the plain path tracer over Embree.
struct PathResult
{
    std::string scene;
    std::vector<std::pair<std::string, Spread>> rates; // Msamples a second of CPU time; ours first
    std::optional<double> ratio;
};

struct AccelResults
{
    int threads = 0, runs = 0;
    bool quick = false;
    std::vector<AccelScene> scenes;
    std::vector<AccelScene> growth; // one scene with ever more triangles
    std::optional<RefitFigures> refit;
    std::vector<PathResult> paths;
    std::vector<std::string> failures;

    // Geometric means over the scenes, of the first of our structures.
    AccelRatios summary(bool all_threads = false) const;
};

// Part after part, on stdout.
void print_scene(const AccelScene& scene, const TraceJob& job);
void print_growth(const std::vector<AccelScene>& growth);
void print_refit(const RefitFigures& refit);
void print_path(const PathResult& path);
void print_summary(const AccelResults& results);

// The keys are documented in docs/benchmarks.md.
std::string results_json(const AccelResults& results);

// One page that needs nothing else.
std::string results_html(const AccelResults& results);

// Nanoseconds a ray of one set, one thread; 0 if it was not measured.
double nanoseconds_a_ray(const AccelRow& row, const std::string& set);

} // namespace snell::app
