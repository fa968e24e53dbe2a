// Following a mesh that changes its shape: refitting our tree and Embree's.
#pragma once

#include "bench_scene.h"

#include "snell/bvh/accel.h"
#include "snell/lab/accel_figures.h"

#include <optional>
#include <string>
#include <vector>

namespace snell::app {

struct RefitFigures
{
    std::string scene;
    std::size_t triangles = 0;
    Spread ours, embree;         // seconds an update, all threads; zeros without Embree
    double rebuild_seconds = 0;  // ours, from nothing, of the last shape
    std::optional<double> ratio; // of Embree's time to ours
};

// Moves all vertices of the world to and fro, `frames` times, and lets both follow each time in turn. Afterwards our
// refitted tree and a new one must give the same hits to the bit, and Embree's nearly the same; what is wrong is
// appended to `failures`. The scene is left deformed.
RefitFigures measure_refit(const std::string& name, BenchScene& scene, const AccelInfo& info, AccelOptions options,
                           bool with_embree, int frames, std::vector<std::string>& failures);

} // namespace snell::app
