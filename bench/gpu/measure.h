// What bench_gpu measures of one scene, and of the device itself.
#pragma once

#include "snell/render/rendering.h"
#include "snell/vulkan/scene.h"

#include <nlohmann/json.hpp>

namespace snell::bench {

struct Measuring
{
    std::string device;   // "gpu:N"
    std::size_t rays = 0; // of each set
    int width = 0, height = 0, runs = 5;
};

// What nothing on the device can exceed.
struct Ceilings
{
    double bytes_per_second = 0; // copied in its memory, each byte counted once read and once written
    double flops_per_second = 0; // fused multiply-adds, each counted as two
};
Ceilings measure_ceilings(Gpu& gpu, int runs);

// A visit of a node or a test of a primitive, for holding rays against the ceilings: it reads a quantised node, and
// does about so much arithmetic (8 children of 6 planes are 48 multiply-adds). Caches may serve the bytes.
inline constexpr double bytes_per_step = 128, flops_per_step = 100;

// They print what they find, and return it.
nlohmann::json measure_rays(const Measuring& job, const Scene& scene, const Ceilings& ceilings);
nlohmann::json measure_trees(const Measuring& job, const Scene& scene);
nlohmann::json measure_frames(const Measuring& job, const Scene& scene);

} // namespace snell::bench
