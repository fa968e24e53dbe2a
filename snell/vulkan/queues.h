// The memory that the stages of a render work on.
#pragma once

#include "snell/vulkan/scene.h"

namespace snell {

// Which of the queues there are, beside those of all renders.
struct QueueKinds
{
    bool steps = false, branches = false, first_hits = false;
    bool operator==(const QueueKinds&) const = default;
};

class Queues
{
  public:
    // For `capacity` paths. Throws Error if the device has not enough memory.
    Queues(const std::shared_ptr<Gpu>& gpu, std::size_t capacity, QueueKinds kinds);

    static std::size_t bytes_of_path(QueueKinds kinds);
    // Words of branch_counts for so many paths, with the sums over them, level by level.
    static std::size_t count_words(std::size_t paths);

    // Fills in what of a job belongs to the queues, and puts it on the device.
    void describe(GpuJob& job);
    VkDeviceAddress job() const { return job_.address; }

    const std::size_t capacity;
    const QueueKinds kinds;
    const GpuBuffer counters, counters_seen; // GpuCounters on the device, and for the host
    const GpuBuffer slots, slots_seen;       // GpuSlot, likewise
    std::unique_ptr<GpuBuffer> first_hits, first_hits_seen;

  private:
    const std::shared_ptr<Gpu> gpu_;
    const GpuBuffer paths_, job_;
};

} // namespace snell
