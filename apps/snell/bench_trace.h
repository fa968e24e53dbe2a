// Measuring structures: the same prepared rays through all of them, cross-checked, interleaved.
#pragma once

#include "snell/bvh/accel.h"
#include "snell/kernel/camera.h"
#include "snell/lab/accel_figures.h"

#include <string>
#include <vector>

namespace snell::app {

// One of ours.
struct StructureChoice
{
    std::string name; // of its row
    const AccelInfo* info = nullptr;
    AccelOptions options;
    std::string builder, traversal; // as people name them
};

struct TraceJob
{
    std::vector<StructureChoice> ours; // the first one is what the ratios are about
    bool embree = true;                // where snell is built with it
    bool low_quality = true;           // Embree's LOW beside MEDIUM
    bool high_quality = true;          // and its HIGH
    bool packets = true;               // Embree's calls for 8 and 16 rays as well
    bool robust = false;               // Embree's watertight mode
    bool trace = true;                 // false: build only
    bool all_threads = true;           // measure these too
    bool falsify = false;              // a few answers of all structures but the first: the cross-check must see that
    int runs = 5;
    std::size_t rays = std::size_t{1} << 20; // of each set
    double build_budget = 4;                 // seconds after which a structure is not built again for its median
};

// Builds and measures them all. What the structures disagree about beyond tolerance is appended to `failures`, one line
// each; ours must agree bit for bit.
AccelScene measure_structures(const std::string& name, const PackedScene& scene, const Camera& camera,
                              const TraceJob& job, std::vector<std::string>& failures);

} // namespace snell::app
