// The yardstick: a plain path tracer over Embree. One ray at a time through rtcIntersect1 and rtcOccluded1, one path
// after the other, with the same kernels for everything else; what a good programmer writes in an afternoon.
#pragma once

#include "snell/kernel/path_state.h"
#include "snell/render/film.h"
#include "snell/scene/packed.h"

#include <memory>

namespace snell::bench {

enum class EmbreeQuality
{
    standard,
    high
};

class EmbreePathTracer
{
  public:
    // Refers to the scene. Triangles, spheres and instances are in Embree's tree, planes are tested one by one.
    EmbreePathTracer(const PackedScene& scene, EmbreeQuality quality);
    ~EmbreePathTracer();

    double build_seconds() const;

    // Adds samples [0, count) of all pixels to the film, on all threads. Returns the number of rays.
    std::uint64_t render(const RenderParams& params, uint count, Film& film) const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace snell::bench
