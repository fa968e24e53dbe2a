// The whole renderer beside a plain path tracer over Embree, with the same kernels, interleaved in one run.
#pragma once

#include "snell/render/render.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace snell::app {

// One renderer in the comparison.
struct PathContender
{
    std::string name;
    double build_seconds = 0;
    std::function<std::uint64_t(Film&)> render; // returns the number of rays
    std::vector<double> rates;                  // samples a second of CPU time, one a run
    std::vector<double> wall_rates;
    std::uint64_t rays = 0;
    Picture picture;
};

struct PathFigures
{
    std::vector<PathContender> contenders; // ours first; the others are Embree's
    double samples = 0;                    // of one picture
    std::uint32_t max_depth = 0;
    std::optional<double> ratio; // of ours to the better of Embree's, by CPU time; nothing without Embree
};

// settings: of the picture; its integrator is "path".
PathFigures measure_paths(const Prepared& prepared, const RenderSettings& settings, int runs);

} // namespace snell::app
