// The memory of one batch of paths, and the counters of what was done with it.
#pragma once

#include "snell/kernel/path_state.h"
#include "snell/render/film_samples.h"
#include "snell/render/render.h"

#include <vector>

namespace snell {

// What kernels and stage loops need to know; the same for all tiles of a render.
struct StageContext
{
    const SceneView& scene;
    const RenderParams& params;
    const Accel& accel;
};

// Rays with the states of their paths, in structure-of-arrays so that accelerators get plain rays.
struct PathQueue
{
    std::vector<Ray> rays;
    std::vector<PathState> states;

    std::size_t size() const { return rays.size(); }
    void clear() { rays.clear(), states.clear(); }
    void push(const CameraPath& path) { rays.push_back(path.ray), states.push_back(path.state); }
};

struct ConnectionQueue
{
    struct Target
    {
        vec3 value;
        uint slot;
        uint layer;
        uint seed;
    };
    std::vector<Ray> rays;
    std::vector<Target> targets;

    std::size_t size() const { return rays.size(); }
    void clear() { rays.clear(), targets.clear(); }
    void push(const Connection& c) { rays.push_back(c.ray), targets.push_back({c.value, c.slot, c.layer, c.seed}); }
};

struct Batch
{
    PathQueue paths, next;
    ConnectionQueue connections;
    std::vector<Hit> hits;
    std::vector<uint> steps;
    std::vector<std::uint8_t> blocked;
    std::vector<SampleSlot> slots;
    RenderStats stats; // of the work done with this batch
};

} // namespace snell
