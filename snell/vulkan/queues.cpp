#include "snell/vulkan/queues.h"

namespace snell {

namespace {
// Parts of one buffer, one after the other.
class Parts
{
  public:
    explicit Parts(VkDeviceAddress begin) : next_(begin) {}
    VkDeviceAddress take(std::size_t bytes)
    {
        const VkDeviceAddress at = next_;
        next_ += (bytes + 255) / 256 * 256;
        return at;
    }

  private:
    VkDeviceAddress next_;
};

constexpr std::size_t parts_at_most = 14;
static_assert(material_kinds < sort_bins); // a bin for each, and one for misses
} // namespace

std::size_t Queues::count_words(std::size_t paths)
{
    std::size_t words = paths;
    while (paths > 64) words += paths = (paths + 63) / 64;
    return words;
}

std::size_t Queues::bytes_of_path(QueueKinds kinds)
{
    std::size_t bytes = 2 * (sizeof(Ray) + sizeof(PathState)) + sizeof(Hit) + sizeof(Connection);
    if (kinds.steps || kinds.first_hits) bytes += sizeof(uint);
    if (kinds.sorts) bytes += 2 * sizeof(uint);
    if (kinds.branches) bytes += sizeof(SampleSlot) + sizeof(GpuBranches) + 5; // 5: of branch_counts
    return bytes;
}

Queues::Queues(const std::shared_ptr<Gpu>& gpu, std::size_t paths, QueueKinds wanted)
    : capacity(paths), kinds(wanted), counters(*gpu, sizeof(GpuCounters), GpuBuffer::Placement::device, "counters"),
      counters_seen(*gpu, sizeof(GpuCounters) + sizeof(GpuDropped), GpuBuffer::Placement::readback, "counters"),
      slots(*gpu, paths * sizeof(SampleSlot), GpuBuffer::Placement::device, "samples"), gpu_(gpu),
      paths_(*gpu, paths * bytes_of_path(kinds) + 4 * 64 + parts_at_most * 256, GpuBuffer::Placement::device,
             "paths on their way"),
      job_(*gpu, sizeof(GpuJob), GpuBuffer::Placement::device, "parameters")
{
    if (!kinds.first_hits) return;
    first_hits = std::make_unique<GpuBuffer>(*gpu, paths * sizeof(GpuFirstHit), GpuBuffer::Placement::device,
                                             "the pictures of first hits");
}

void Queues::describe(GpuJob& job)
{
    Parts parts(paths_.address);
    job.rays_0.address = parts.take(capacity * sizeof(Ray));
    job.rays_1.address = parts.take(capacity * sizeof(Ray));
    job.states_0.address = parts.take(capacity * sizeof(PathState));
    job.states_1.address = parts.take(capacity * sizeof(PathState));
    job.hits.address = parts.take(capacity * sizeof(Hit));
    job.connections.address = parts.take(capacity * sizeof(Connection));
    if (kinds.steps || kinds.first_hits) job.steps.address = parts.take(capacity * sizeof(uint));
    if (kinds.sorts) {
        job.bins.address = parts.take(capacity * sizeof(uint));
        job.sorted.address = parts.take(capacity * sizeof(uint));
    }
    if (kinds.branches) {
        job.lit.address = parts.take(capacity * sizeof(SampleSlot));
        job.branches.address = parts.take(capacity * sizeof(GpuBranches));
        job.branch_counts.address = parts.take(count_words(capacity) * sizeof(uint));
    }
    job.slots.address = slots.address;
    if (first_hits) job.first_hits.address = first_hits->address;
    job.counters.address = counters.address;
    gpu_->upload(job_, 0, &job, sizeof(job));
}

} // namespace snell
