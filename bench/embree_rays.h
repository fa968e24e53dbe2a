// Rays in Embree's own layouts, prepared outside the clock: what its single-ray and packet calls are measured with.
#pragma once

#include "snell/kernel/ray.h"

#include <embree3/rtcore.h>

#include <cstdint>
#include <memory>
#include <span>

namespace snell::bench {

class EmbreeRays
{
  public:
    // width: 1, 8 or 16 rays a call; the last packet is filled up with inactive lanes. any_hit: for rtcOccluded, else
    // for rtcIntersect.
    EmbreeRays(std::span<const Ray> rays, uint width, bool any_hit);
    ~EmbreeRays();

    // Takes back what trace() wrote into the rays. In parallel.
    void reset();

    // Traces rays [begin, end); begin is a multiple of the width. coherent: tells Embree that neighbours point the same
    // way, which makes it treat packets otherwise. Thread-safe for ranges that do not share packets.
    void trace(RTCScene scene, std::size_t begin, std::size_t end, bool coherent);

    // Answers of the last trace() of each ray. Only t of a hit and whether there is one mean something to snell:
    // primitives are numbered as Embree's geometries number them.
    void hits(std::span<Hit> hits) const;
    void blocked(std::span<std::uint8_t> blocked) const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace snell::bench
