// The Vulkan backend: batches of paths through the stages, as kernels over queues in the device's memory (Laine,
// Karras, Aila 2013, Megakernels Considered Harmful: Wavefront Path Tracing on GPUs). Two batches are on their way at a
// time: while the device works on one, the host has handed over the next.
#pragma once

#include "snell/core/timer.h"
#include "snell/render/backend.h"
#include "snell/render/gpu_options.h"
#include "snell/vulkan/queues.h"

#include <deque>

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

    // For tests.
    const DeviceFilm& film() const { return *film_; }
    std::size_t handed_over() const { return under_way_.size(); } // and not waited for

  private:
    // Samples [first_sample, + samples) of pixels [first_pixel, + pixels), counted in the rows of the region.
    struct Batch
    {
        Region region;
        std::size_t first_pixel = 0, pixels = 0;
        uint first_sample = 0, samples = 0;

        std::size_t paths() const { return pixels * samples; }
    };

    // What was asked for, and how far batches have been made of it.
    struct Call
    {
        const Region region;
        const uint first_sample, count;
        Film& film;
        const std::function<bool()>& keep_going;
        std::size_t next_pixel = 0;
        uint samples_done = 0; // of all pixels
        bool stopped = false;

        bool is_over() const { return stopped || samples_done >= count; }
    };

    // A batch on its way.
    struct Flight
    {
        Flight(Gpu& gpu, std::unique_ptr<Queues> owned);

        enum class Stage
        {
            idle,       // no batch
            first_hits, // on its way through mirrors and glass, for the pictures beside the colour
            waves,      // from bounce to bounce
            finished,   // not yet in the film
        };
        std::unique_ptr<Queues> queues;
        Gpu::Commands commands;
        Stage stage = Stage::idle;
        Batch batch;
        uint recorded = 0;       // samples of each pixel whose first hits are
        std::uint64_t waves = 0; // that this stage has done
        uint waves_now = 0;      // that were handed over
        std::size_t alive = 0;   // paths, before the next wave
        RenderStats stats;       // of the batch
        double seconds = 0;      // that the batch has taken
        double longest = 0;      // of what was handed over together
        double submitted = 0;    // when, by clock_
        // What else was handed over with it: the batch before goes to the film, the film comes to the host.
        bool has_finalized = false, fetches = false;
        std::uint64_t film_samples = 0; // that this film has
    };

    // The kernels of an integrator with at most one continuation and one connection at each vertex.
    struct Waves
    {
        const char* shade;
        uint which;
        std::uint64_t most;
        bool can_be_sorted;
    };
    Waves waves() const;

    void render_overlapping(Call& call);
    void render_in_turn(Call& call);
    Batch next_batch(Call& call) const;
    Flight& flight(std::size_t number);
    void start(Flight& f, const Batch& batch);
    void record_stage(Flight& f);
    void submit(Flight& f);
    void land(Call& call);
    void take_film(Flight& f, Call& call);
    void finish(Flight& f, Call& call, bool is_last);
    void add_batch_time(const Flight& f, Film& film) const;
    void wait_for_all() noexcept;

    void record_waves(Flight& f);
    void count_waves(Flight& f);
    void record_first_hits(Flight& f);
    void record_finalize(Flight& f);
    bool run_whitted(Flight& f, Call& call);
    std::size_t light_rounds(Flight& f, Call& call, GpuPush push, std::size_t count, uint rounds);

    void begin(Flight& f);
    void generate(Flight& f, uint samples);
    void set_counters(Flight& f, std::size_t paths);
    void copy_counters(Flight& f);
    void dispatch(Flight& f, GpuKernel kernel, const GpuPush& push, std::size_t items);
    GpuKernel trace_kernel(const char* name, bool counts_steps) const;
    void dispatch_trace(Flight& f, GpuKernel kernel, const GpuPush& push, std::size_t counters_offset);
    void dispatch_indirect(Flight& f, GpuKernel kernel, const GpuPush& push, std::size_t counters_offset);
    GpuPush parameters(const Flight& f) const;
    GpuPush batch_parameters(const Flight& f, uint samples) const;

    VulkanScene& scene_;
    const BackendJob job_;
    const GpuOptions options_;
    DeviceArrays lens_; // the table of a traced lens
    std::size_t capacity_ = 0;
    GpuJob on_device_{};
    std::unique_ptr<Flight> flights_[2];
    std::deque<Flight*> under_way_; // handed over and not waited for, in this order
    DeviceFilm* film_ = nullptr;    // that of the first flight's queues
    Gpu::Commands film_commands_;
    const Timer clock_;
    double last_landing_ = 0, last_fetch_ = 0;
    bool is_fetching_ = false;
    RenderStats stats_;
    std::uint64_t film_samples_ = 0; // that have come to the host
    std::size_t batch_paths_;        // as many as take about as long as they should
};

} // namespace snell
