#include "snell/vulkan/backend.h"

#include "snell/core/error.h"
#include "snell/core/parallel.h"
#include "snell/core/timer.h"
#include "snell/kernel/views.h"
#include "snell/render/film_samples.h"

#include <algorithm>
#include <cstring>
#include <limits>

namespace snell {

// Samples of a pixel in one batch, at most.
constexpr uint samples_at_once = 64;

// Paths in flight at most: enough for the widest devices there are, and for a processor enough for all its lanes while
// the queues still fit its caches.
constexpr std::size_t most_paths = std::size_t{1} << 20, most_paths_on_processor = std::size_t{1} << 16;
constexpr std::size_t fewest_paths = 4096;
// Whitted's renderer has up to 1 / whitted_cutoff rays of a sample alive: the samples of one pixel must always fit.
constexpr std::size_t fewest_branching_paths = samples_at_once * 256;

// Commands that are handed over together should take that long: nobody waits longer for the device, drivers do not take
// it for hanging (they give up after 2 to 10 seconds), and starting them costs little beside.
constexpr double seconds_at_once = 0.05;

static QueueKinds kinds_of(const BackendJob& job)
{
    QueueKinds kinds;
    kinds.steps = job.integrator.view == view_steps;
    kinds.branches = job.integrator.name == "whitted";
    kinds.first_hits = job.settings.layers;
    return kinds;
}

static std::size_t capacity_for(const Gpu& gpu, const BackendJob& job)
{
    const double samples =
        static_cast<double>(job.settings.width) * job.settings.height * std::min(job.settings.spp, samples_at_once);
    const std::size_t fewest = kinds_of(job).branches ? fewest_branching_paths : fewest_paths;
    std::size_t most = gpu.is_processor() ? most_paths_on_processor : most_paths;
    const std::size_t room = gpu.info().info.memory_bytes / 4;
    while (most > fewest && most * (Queues::bytes_of_path(kinds_of(job)) + sizeof(GpuSlot)) > room) most /= 2;
    std::size_t capacity = fewest;
    while (capacity < most && static_cast<double>(capacity) < samples) capacity *= 2;
    return capacity;
}

std::unique_ptr<Backend> VulkanScene::make_backend(const BackendJob& job)
{
    return std::make_unique<VulkanBackend>(*this, job);
}

VulkanBackend::VulkanBackend(VulkanScene& scene, const BackendJob& job)
    : scene_(scene), job_(job), lens_(scene.gpu()), commands_(*scene.gpu(), 2 + 3 * waves_at_once)
{
    if (job.integrator.radiance)
        throw Error(
            fmt::format("the integrator '{}' is a function in C++, which a GPU cannot run", job.integrator.name),
            "use --device cpu");
    const std::size_t capacity = capacity_for(*scene.gpu(), job);
    queues_ = scene.take_queues(capacity, kinds_of(job));
    batch_paths_ = std::min(capacity, scene.gpu()->is_processor() ? fewest_paths : most_paths / 4);
    GpuJob on_device{};
    scene.describe(on_device);
    on_device.params = job.params;
    if (LensSystem& lens = on_device.params.camera.lens; lens.interface_count > 0) {
        const std::size_t rows = std::size_t{lens.first} + lens.interface_count + lens.pupil_count;
        lens_.follow({{job.params.camera.lens.table.at, rows * sizeof(vec4)}});
        const VkDeviceAddress address = lens_.address(0);
        std::memcpy(&lens.table.at, &address, sizeof(address)); // no pointer of the host's
    }
    queues_->describe(on_device);
}

VulkanBackend::~VulkanBackend()
{
    scene_.give_queues(std::move(queues_));
}

void VulkanBackend::render_samples(const Region& region, uint first_sample, uint count, Film& film,
                                   const std::function<bool()>& keep_going)
{
    const std::size_t pixels =
        static_cast<std::size_t>(region.x1 - region.x0) * static_cast<std::size_t>(region.y1 - region.y0);
    for (uint done = 0; done < count;) {
        Batch batch{region, 0, 0, first_sample + done, std::min(count - done, samples_at_once)};
        while (batch.first_pixel < pixels) {
            batch.pixels = std::clamp<std::size_t>(batch_paths_ / batch.samples, 1, pixels - batch.first_pixel);
            longest_run_ = batch_seconds_ = 0;
            const uint recorded = recorded_samples(job_.settings, batch.first_sample, batch.samples);
            if (!run_batch(batch)) { // it has branched into more paths than there is room for
                SNELL_CHECK_LT(1u, batch.pixels);
                batch_paths_ = std::max<std::size_t>(batch.paths() / 2, 1);
                continue;
            }
            add_to_film(batch, film);
            if (recorded > 0) {
                Batch first = batch;
                first.samples = recorded;
                run_first_hits(first, film);
            }
            adapt();
            batch.first_pixel += batch.pixels;
            if (!keep_going()) return;
        }
        done += batch.samples;
    }
}

void VulkanBackend::adapt()
{
    const double factor = std::clamp(seconds_at_once / std::max(longest_run_, 1e-6), 0.5, 2.0);
    batch_paths_ = std::clamp(static_cast<std::size_t>(static_cast<double>(batch_paths_) * factor),
                              std::min(fewest_paths, batch_paths_), queues_->capacity);
}

// ---- commands ----

GpuPush VulkanBackend::parameters() const
{
    GpuPush push{};
    push.job.address = queues_->job();
    return push;
}

void VulkanBackend::begin()
{
    commands_.begin();
    commands_.stamp(0);
}

void VulkanBackend::run()
{
    const Timer timer;
    commands_.run();
    const double seconds = timer.seconds();
    longest_run_ = std::max(longest_run_, seconds);
    batch_seconds_ += seconds;
}

void VulkanBackend::set_counters(std::size_t paths)
{
    GpuCounters counters{};
    counters.paths[0] = static_cast<uint>(paths);
    counters.path_groups[0] = static_cast<uint>((paths + group_size - 1) / group_size);
    counters.path_groups[1] = counters.path_groups[2] = 1;
    commands_.barrier();
    vkCmdUpdateBuffer(commands_.handle, queues_->counters.handle, 0, sizeof(counters), &counters);
    commands_.barrier();
}

void VulkanBackend::dispatch(GpuKernel kernel, const GpuPush& push, std::size_t items)
{
    commands_.bind(kernel);
    commands_.push(&push, sizeof(push));
    commands_.dispatch(items);
    commands_.barrier();
}

void VulkanBackend::dispatch_indirect(GpuKernel kernel, const GpuPush& push, std::size_t counters_offset)
{
    commands_.bind(kernel);
    commands_.push(&push, sizeof(push));
    commands_.dispatch_indirect(queues_->counters, counters_offset);
    commands_.barrier();
}

void VulkanBackend::copy_back(const GpuBuffer& from, const GpuBuffer& to, std::size_t bytes)
{
    const VkBufferCopy copy{0, 0, bytes};
    vkCmdCopyBuffer(commands_.handle, from.handle, to.handle, 1, &copy);
}

void VulkanBackend::generate(const Batch& batch)
{
    GpuPush push = parameters();
    push.count = static_cast<uint>(batch.paths());
    push.first_pixel = static_cast<uint>(batch.first_pixel);
    push.first_sample = batch.first_sample;
    push.samples = batch.samples;
    push.x0 = static_cast<uint>(batch.region.x0);
    push.y0 = static_cast<uint>(batch.region.y0);
    push.columns = static_cast<uint>(batch.region.x1 - batch.region.x0);
    dispatch(scene_.gpu()->kernel("generate"), push, batch.paths());
}

// ---- integrators ----

// False: there was no room for all the paths of the batch, and nothing has come of it.
bool VulkanBackend::run_batch(const Batch& batch)
{
    stats_.camera_rays += batch.paths();
    stats_.samples += batch.paths();
    const IntegratorInfo& integrator = job_.integrator;
    if (traces_paths(integrator))
        return run_waves(batch, "shade_path", 0, std::uint64_t{job_.params.max_depth} + 1);
    if (integrator.name == "ao") return run_waves(batch, "shade_ambient", 0, 1);
    if (integrator.name == "whitted") {
        if (run_whitted(batch)) return true;
        stats_.camera_rays -= batch.paths();
        stats_.samples -= batch.paths();
        return false;
    }
    SNELL_CHECK_LT(integrator.view, view_count);
    return run_waves(batch, "shade_view", integrator.view, 1);
}

// Paths that have at most one continuation and one connection at each vertex. waves: no more than that.
bool VulkanBackend::run_waves(const Batch& batch, const char* shade_name, uint which, std::uint64_t waves)
{
    Gpu& gpu = *scene_.gpu();
    const GpuKernel extend = gpu.kernel("extend", scene_.trace_constants(job_.integrator.view == view_steps));
    const GpuKernel connect = gpu.kernel("connect", scene_.trace_constants(false));
    const GpuKernel shade = gpu.kernel(shade_name, scene_.shade_constants()), arrange = gpu.kernel("arrange");
    std::uint64_t done = 0;
    for (std::size_t alive = batch.paths(); alive > 0;) {
        const uint count = static_cast<uint>(std::min<std::uint64_t>(waves_at_once, waves - done));
        begin();
        set_counters(alive);
        if (done == 0) generate(batch);
        commands_.stamp(1);
        for (uint wave = 0; wave < count; ++wave) {
            GpuPush push = parameters();
            push.queue = wave & 1u;
            push.wave = wave;
            push.from_camera = done + wave == 0 ? 1 : 0;
            dispatch_indirect(extend, push, offsetof(GpuCounters, path_groups) + 12 * wave);
            commands_.stamp(2 + 3 * wave);
            push.which = which;
            dispatch_indirect(shade, push, offsetof(GpuCounters, path_groups) + 12 * wave);
            dispatch(arrange, push, 1);
            commands_.stamp(3 + 3 * wave);
            push.which = 0; // connections add to the slots
            dispatch_indirect(connect, push, offsetof(GpuCounters, connection_groups) + 12 * wave);
            commands_.stamp(4 + 3 * wave);
        }
        copy_back(queues_->counters, queues_->counters_seen, sizeof(GpuCounters));
        copy_back(queues_->slots, queues_->slots_seen, batch.paths() * sizeof(GpuSlot));
        run();
        stats_.generate_seconds += commands_.seconds(0, 1);
        for (uint wave = 0; wave < count; ++wave) {
            stats_.extend_seconds += commands_.seconds(1 + 3 * wave, 2 + 3 * wave);
            stats_.shade_seconds += commands_.seconds(2 + 3 * wave, 3 + 3 * wave);
            stats_.connect_seconds += commands_.seconds(3 + 3 * wave, 4 + 3 * wave);
            stats_.extension_rays += counters().paths[wave + 1];
            stats_.shadow_rays += counters().connections[wave];
        }
        done += count;
        alive = done < waves ? counters().paths[count] : 0;
    }
    return true;
}

// Tests `rounds` connections of each of `count` paths; returns how many rays that took.
std::size_t VulkanBackend::light_rounds(GpuPush push, std::size_t count, uint rounds)
{
    Gpu& gpu = *scene_.gpu();
    const GpuKernel light = gpu.kernel("light_whitted", scene_.shade_constants()), arrange = gpu.kernel("arrange");
    const GpuKernel connect = gpu.kernel("connect", scene_.trace_constants(false));
    std::size_t rays = 0;
    for (uint done = 0; done < rounds;) {
        const uint now = std::min(rounds - done, waves_at_once);
        begin();
        set_counters(count);
        for (uint round = 0; round < now; ++round) {
            push.wave = round; // so that each round has a counter of its own
            push.which = done + round;
            dispatch(light, push, count);
            dispatch(arrange, push, 1);
            push.which = 1; // connections add to the paths' own slots
            dispatch_indirect(connect, push, offsetof(GpuCounters, connection_groups) + 12 * round);
        }
        commands_.stamp(1);
        copy_back(queues_->counters, queues_->counters_seen, sizeof(GpuCounters));
        run();
        stats_.connect_seconds += commands_.seconds(0, 1);
        for (uint round = 0; round < now; ++round) rays += counters().connections[round];
        done += now;
    }
    return rays;
}

bool VulkanBackend::run_whitted(const Batch& batch)
{
    Gpu& gpu = *scene_.gpu();
    const GpuKernel extend = gpu.kernel("extend", scene_.trace_constants(false));
    const GpuKernel shade = gpu.kernel("shade_whitted", scene_.shade_constants()),
                    gather = gpu.kernel("gather_whitted");
    const GpuKernel sum = gpu.kernel("sum"), spread = gpu.kernel("spread"), enqueue = gpu.kernel("enqueue_whitted");
    const SceneView view = job_.scene.view();
    const uint rounds = view.delta_light_count + (view.light_count > view.delta_light_count ? 1 : 0) +
                        (is_black(view.environment.radiance) ? 0 : 1);

    GpuPush push = parameters();
    std::size_t rays = 0, shadow_rays = 0;
    for (std::size_t count = batch.paths(), wave = 0; count > 0; ++wave) {
        push.count = static_cast<uint>(count);
        push.wave = 0;
        begin();
        set_counters(count);
        if (wave == 0) generate(batch);
        commands_.stamp(1);
        push.from_camera = wave == 0 ? 1 : 0;
        dispatch(extend, push, count);
        commands_.stamp(2);
        dispatch(shade, push, count);
        commands_.stamp(3);
        copy_back(queues_->counters, queues_->counters_seen, sizeof(GpuCounters));
        run();
        stats_.generate_seconds += commands_.seconds(0, 1);
        stats_.extend_seconds += commands_.seconds(1, 2);
        stats_.shade_seconds += commands_.seconds(2, 3);
        shadow_rays += light_rounds(push, count, rounds);

        // What was found goes to the samples; the continuations find their places: sums upwards, then downwards.
        begin();
        push.count = static_cast<uint>(count);
        push.wave = 0;
        dispatch(gather, push, count);
        std::vector<GpuPush> levels;
        GpuPush level = push;
        level.offset = 0;
        for (;; level.count = (level.count + 63) / 64) {
            level.to = level.offset + level.count;
            levels.push_back(level);
            if (level.count <= 64) break;
            dispatch(sum, level, (level.count + 63) / 64);
            level.offset = level.to;
        }
        levels.back().which = 1;
        for (std::size_t i = levels.size(); i-- > 0;) dispatch(spread, levels[i], (levels[i].count + 63) / 64);
        copy_back(queues_->counters, queues_->counters_seen, sizeof(GpuCounters));
        copy_back(queues_->slots, queues_->slots_seen, batch.paths() * sizeof(GpuSlot));
        run();
        const std::size_t next = counters().paths[1];
        if (next > queues_->capacity) return false;
        rays += next;
        if (next > 0) {
            begin();
            dispatch(enqueue, push, count);
            run();
        }
        push.queue = 1 - push.queue;
        count = next;
    }
    stats_.extension_rays += rays;
    stats_.shadow_rays += shadow_rays;
    return true;
}

void VulkanBackend::run_first_hits(const Batch& batch, Film& film)
{
    Gpu& gpu = *scene_.gpu();
    const GpuKernel counted = gpu.kernel("extend", scene_.trace_constants(true));
    const GpuKernel extend = gpu.kernel("extend", scene_.trace_constants(false));
    const GpuKernel record = gpu.kernel("record_hits", scene_.shade_constants()), arrange = gpu.kernel("arrange");
    uint bounce = 0;
    for (std::size_t alive = batch.paths(); alive > 0;) {
        begin();
        set_counters(alive);
        if (bounce == 0) generate(batch);
        for (uint wave = 0; wave < waves_at_once; ++wave) {
            GpuPush push = parameters();
            push.queue = wave & 1u;
            push.wave = wave;
            push.which = bounce + wave;
            push.from_camera = push.which == 0 ? 1 : 0;
            const std::size_t groups = offsetof(GpuCounters, path_groups) + 12 * wave;
            dispatch_indirect(push.which == 0 ? counted : extend, push, groups);
            dispatch_indirect(record, push, groups);
            dispatch(arrange, push, 1);
        }
        bounce += waves_at_once;
        copy_back(queues_->counters, queues_->counters_seen, sizeof(GpuCounters));
        copy_back(*queues_->first_hits, *queues_->first_hits_seen, batch.paths() * sizeof(GpuFirstHit));
        run();
        alive = counters().paths[waves_at_once];
    }

    const auto* hits = static_cast<const GpuFirstHit*>(queues_->first_hits_seen->data);
    const auto columns = static_cast<std::size_t>(batch.region.x1 - batch.region.x0);
    parallel_for(batch.pixels, [&](std::size_t p) {
        const std::size_t at = batch.first_pixel + p;
        const std::size_t pixel =
            (static_cast<std::size_t>(batch.region.y0) + at / columns) * static_cast<std::size_t>(film.width) +
            static_cast<std::size_t>(batch.region.x0) + at % columns;
        for (std::size_t i = p * batch.samples; i < (p + 1) * batch.samples; ++i) {
            const GpuFirstHit& h = hits[i];
            const FirstHit first = {h.albedo, h.normal, h.geometric_normal, h.position,
                                    h.uv,     h.depth,  h.object,           h.material};
            add_first_hit(film.layers, pixel, h.has_hit != 0u ? &first : nullptr, h.steps);
            add_seen(film.layers, pixel, h.albedo, h.normal);
        }
    });
}

// ---- finalize ----

static_assert(sizeof(GpuSlot) == sizeof(SampleSlot) &&
              offsetof(GpuSlot, sees_through) == offsetof(SampleSlot, sees_through));

void VulkanBackend::add_to_film(const Batch& batch, Film& film)
{
    const Timer timer;
    const auto* slots = static_cast<const SampleSlot*>(queues_->slots_seen.data);
    const auto columns = static_cast<std::size_t>(batch.region.x1 - batch.region.x0);
    const std::size_t end = batch.first_pixel + batch.pixels;
    const double share = batch_seconds_ / static_cast<double>(batch.pixels);
    const std::size_t first_row = batch.first_pixel / columns;
    parallel_for((end - 1) / columns - first_row + 1, [&](std::size_t i) { // row by row
        const std::size_t row = first_row + i;
        const std::size_t from = std::max(batch.first_pixel, row * columns), to = std::min(end, (row + 1) * columns);
        const int y = batch.region.y0 + static_cast<int>(row);
        const auto x_of = [&](std::size_t p) { return batch.region.x0 + static_cast<int>(p - row * columns); };
        for (std::size_t p = from; p < to; ++p)
            add_samples(film, job_.settings, x_of(p), y, batch.first_sample,
                        {slots + (p - batch.first_pixel) * batch.samples, batch.samples}, film_mutex_);
        add_time(film, {x_of(from), y, x_of(to), y + 1}, share * static_cast<double>(to - from));
    });
    stats_.finalize_seconds += timer.seconds();
}

} // namespace snell
