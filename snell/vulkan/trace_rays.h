// Rays through a scene on a device, without a picture: for the self-test, tests and measurements.
#pragma once

#include "snell/vulkan/scene.h"

#include <span>

namespace snell {

// A batch of rays on the device, to be traced as often as one likes.
class RayBatch
{
  public:
    RayBatch(VulkanScene& scene, std::span<const Ray> rays);

    // Finds the nearest hits; holes in surfaces count as in a path's first ray that is no camera ray. Returns the
    // seconds that the device has taken; 0 where it has no clock.
    double intersect();
    std::vector<Hit> hits() const; // of the last intersect()

    // Finds out which rays are blocked.
    double occlude();
    std::vector<std::uint8_t> blocked() const; // of the last occlude()

  private:
    double run(GpuKernel kernel);
    void read(const GpuBuffer& from, void* to, std::size_t bytes) const;

    VulkanScene& scene_;
    const std::size_t count_;
    const GpuBuffer rays_, states_, hits_, connections_, slots_, counters_, job_;
    const std::vector<Connection> fresh_connections_;
    mutable Gpu::Commands commands_;
};

} // namespace snell
