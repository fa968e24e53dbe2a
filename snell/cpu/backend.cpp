// The CPU backend: batches of paths through the stages, tiles on threads.
#include "snell/render/backend.h"
#include "snell/core/error.h"
#include "snell/core/parallel.h"
#include "snell/core/timer.h"
#include "snell/cpu/stages.h"
#include "snell/kernel/views.h"
#include "snell/render/film_samples.h"

#include <algorithm>
#include <atomic>
#include <mutex>

#include <time.h>

namespace snell {

// Paths in one batch, about: enough to keep many rays in flight until the last bounces, few enough for the L2 cache.
constexpr uint batch_paths = 2048;

namespace {
class CpuBackend final : public Backend
{
  public:
    explicit CpuBackend(const BackendJob& job) : job_(job), view_(job.scene.view()) {}

    void render_samples(const Region& region, uint first_sample, uint count, Film& film,
                        const std::function<bool()>& keep_going) override;
    RenderStats stats() const override;

  private:
    void render_tile(const Region& tile, uint first_sample, uint count, Film& film);
    void finalize(const Batch& batch, const Region& tile, uint first_sample, uint count, Film& film);
    std::unique_ptr<Batch> take_batch();
    void give_batch(std::unique_ptr<Batch> batch);

    const BackendJob job_;
    const SceneView view_;
    mutable std::mutex mutex_; // of what follows, and of Film::dropped
    std::vector<std::unique_ptr<Batch>> free_batches_;
    RenderStats stats_;
};
} // namespace

std::unique_ptr<Backend> make_cpu_backend(const BackendJob& job)
{
    return std::make_unique<CpuBackend>(job);
}

void CpuBackend::render_samples(const Region& region, uint first_sample, uint count, Film& film,
                                const std::function<bool()>& keep_going)
{
    const int size = job_.settings.tile_size > 0 ? job_.settings.tile_size : 16;
    const int columns = (region.x1 - region.x0 + size - 1) / size;
    const int rows = (region.y1 - region.y0 + size - 1) / size;
    const uint samples_at_once = std::max(1u, batch_paths / static_cast<uint>(std::min(size * size, 2048)));
    std::atomic<bool> stop = false;
    std::mutex callback;
    parallel_for(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), [&](std::size_t i) {
        const int x0 = region.x0 + static_cast<int>(i % static_cast<std::size_t>(columns)) * size;
        const int y0 = region.y0 + static_cast<int>(i / static_cast<std::size_t>(columns)) * size;
        const Region tile{x0, y0, std::min(x0 + size, region.x1), std::min(y0 + size, region.y1)};
        for (uint done = 0; done < count && !stop; done += samples_at_once) {
            render_tile(tile, first_sample + done, std::min(samples_at_once, count - done), film);
            if (const std::unique_lock lock(callback, std::try_to_lock); lock.owns_lock() && !keep_going()) stop = true;
        }
    });
}

static void run_integrator(const StageContext& context, const IntegratorInfo& integrator, Batch& batch)
{
    if (integrator.radiance) return run_custom(context, batch, integrator.radiance);
    const std::string& name = integrator.name;
    if (traces_paths(integrator)) return run_path(context, batch);
    if (name == "whitted") return run_whitted(context, batch);
    if (name == "ao") return run_ambient_occlusion(context, batch);
    SNELL_CHECK_LT(integrator.view, view_count);
    run_view(context, batch, integrator.view);
}

// Time that this thread has worked: what others do on the same processor does not count.
static double thread_seconds()
{
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

void CpuBackend::render_tile(const Region& tile, uint first_sample, uint count, Film& film)
{
    const double start = thread_seconds();
    std::unique_ptr<Batch> batch = take_batch();
    const StageContext context{view_, job_.params, job_.accel};
    if (const uint recorded = recorded_samples(job_.settings, first_sample, count); recorded > 0)
        record_first_hits(context, *batch, tile, first_sample, recorded, film);
    generate_stage(context, *batch, tile, first_sample, count);
    run_integrator(context, job_.integrator, *batch);
    const Timer timer;
    finalize(*batch, tile, first_sample, count, film);
    batch->stats.finalize_seconds += timer.seconds();
    // A batch goes through the stages as a whole, so its time is shared by the tile's pixels alike.
    add_time(film, tile, thread_seconds() - start);
    give_batch(std::move(batch));
}

void CpuBackend::finalize(const Batch& batch, const Region& tile, uint first_sample, uint count, Film& film)
{
    const std::span slots(batch.slots);
    std::size_t slot = 0;
    for (int y = tile.y0; y < tile.y1; ++y)
        for (int x = tile.x0; x < tile.x1; ++x, slot += count)
            add_samples(film, job_.settings, x, y, first_sample, slots.subspan(slot, count), mutex_);
}

std::unique_ptr<Batch> CpuBackend::take_batch()
{
    const std::lock_guard lock(mutex_);
    if (free_batches_.empty()) return std::make_unique<Batch>();
    std::unique_ptr<Batch> batch = std::move(free_batches_.back());
    free_batches_.pop_back();
    return batch;
}

void CpuBackend::give_batch(std::unique_ptr<Batch> batch)
{
    const std::lock_guard lock(mutex_);
    const RenderStats& s = batch->stats;
    stats_.camera_rays += s.camera_rays;
    stats_.extension_rays += s.extension_rays;
    stats_.shadow_rays += s.shadow_rays;
    stats_.samples += batch->slots.size();
    stats_.generate_seconds += s.generate_seconds;
    stats_.extend_seconds += s.extend_seconds;
    stats_.shade_seconds += s.shade_seconds;
    stats_.connect_seconds += s.connect_seconds;
    stats_.finalize_seconds += s.finalize_seconds;
    batch->stats = {};
    free_batches_.push_back(std::move(batch));
}

RenderStats CpuBackend::stats() const
{
    const std::lock_guard lock(mutex_);
    return stats_;
}

} // namespace snell
