// The memory that the stages of a render work on.
#pragma once

#include "snell/vulkan/device_film.h"
#include "snell/vulkan/scene.h"

namespace snell {

// Which of the queues there are, beside those of all renders.
struct QueueKinds
{
    bool steps = false, branches = false, first_hits = false, sorts = false;
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
    const GpuBuffer counters;              // GpuCounters on the device
    const GpuBuffer counters_seen;         // for the host: GpuCounters, and GpuDropped behind them
    const GpuBuffer slots;                 // SampleSlot
    std::unique_ptr<GpuBuffer> first_hits; // GpuFirstHit
    std::unique_ptr<DeviceFilm> film;      // of the picture that was last rendered with these

    // What the host has seen last.
    const GpuCounters& counters_read() const { return *static_cast<const GpuCounters*>(counters_seen.data); }
    const GpuDropped& dropped_read() const
    {
        return *reinterpret_cast<const GpuDropped*>(static_cast<const std::byte*>(counters_seen.data) +
                                                    sizeof(GpuCounters));
    }

  private:
    const std::shared_ptr<Gpu> gpu_;
    const GpuBuffer paths_, job_;
};

} // namespace snell
