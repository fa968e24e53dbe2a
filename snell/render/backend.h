// Backends: who carries out the stages.
#pragma once

#include "snell/kernel/path_state.h"
#include "snell/render/integrator.h"
#include "snell/render/render.h"

#include <functional>
#include <memory>

namespace snell {

// What a backend works on; referred to until the backend goes.
struct BackendJob
{
    const PackedScene& scene;
    const Accel& accel;
    const RenderParams& params;
    const RenderSettings& settings;
    const IntegratorInfo& integrator;
};

class Backend
{
  public:
    virtual ~Backend() = default;

    // Adds samples [first_sample, first_sample + count) of the region's pixels to the film. Calls keep_going() now and
    // then, from one thread at a time, and returns early if it says false; pixels then differ in their sample counts.
    // Throws Error for a non-finite sample if the settings are strict.
    virtual void render_samples(const Region& region, uint first_sample, uint count, Film& film,
                                const std::function<bool()>& keep_going) = 0;

    // Rays, samples and stage times so far. May be called from keep_going().
    virtual RenderStats stats() const = 0;
};

// Implemented in snell/cpu/. Those of GPUs: DeviceScene in device.h.
std::unique_ptr<Backend> make_cpu_backend(const BackendJob& job);

} // namespace snell
