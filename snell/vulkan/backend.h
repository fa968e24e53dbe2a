// The Vulkan backend: batches of paths through the stages, as kernels over queues in the device's memory (Laine,
// Karras, Aila 2013, Megakernels Considered Harmful: Wavefront Path Tracing on GPUs). The host adds the samples up, by
// the same code as the CPU backend.
#pragma once

#include "snell/render/backend.h"
#include "snell/vulkan/queues.h"

namespace snell {

class VulkanBackend final : public Backend
{
  public:
    // Throws Error for an integrator that is not made of kernels, and if the device has not enough memory.
    VulkanBackend(VulkanScene& scene, const BackendJob& job);
    ~VulkanBackend() override;

    void render_samples(const Region& region, uint first_sample, uint count, Film& film,
                        const std::function<bool()>& keep_going) override;
    RenderStats stats() const override { return stats_; }

  private:
    // Samples [first_sample, + samples) of pixels [first_pixel, + pixels), counted in the rows of the region.
    struct Batch
    {
        Region region;
        std::size_t first_pixel = 0, pixels = 0;
        uint first_sample = 0, samples = 0;

        std::size_t paths() const { return pixels * samples; }
    };

    bool run_batch(const Batch& batch);
    bool run_waves(const Batch& batch, const char* shade, uint which, std::uint64_t waves);
    bool run_whitted(const Batch& batch);
    void run_first_hits(const Batch& batch, Film& film);
    std::size_t light_rounds(GpuPush push, std::size_t count, uint rounds);

    void begin();
    void run();
    void generate(const Batch& batch);
    void set_counters(std::size_t paths);
    void dispatch(GpuKernel kernel, const GpuPush& push, std::size_t items);
    void dispatch_indirect(GpuKernel kernel, const GpuPush& push, std::size_t counters_offset);
    void copy_back(const GpuBuffer& from, const GpuBuffer& to, std::size_t bytes);
    GpuPush parameters() const;
    const GpuCounters& counters() const { return *static_cast<const GpuCounters*>(queues_->counters_seen.data); }

    void add_to_film(const Batch& batch, Film& film);
    void adapt();

    VulkanScene& scene_;
    const BackendJob job_;
    DeviceArrays lens_; // the table of a traced lens
    std::unique_ptr<Queues> queues_;
    Gpu::Commands commands_;
    RenderStats stats_;
    std::mutex film_mutex_;    // of Film::dropped
    std::size_t batch_paths_;  // as many as take about as long as they should
    double longest_run_ = 0;   // of the commands of this batch
    double batch_seconds_ = 0; // that it has taken
};

} // namespace snell
