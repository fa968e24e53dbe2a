#include "snell/vulkan/backend.h"

#include "snell/core/error.h"
#include "snell/kernel/views.h"
#include "snell/render/film_samples.h"
#include "snell/render/render_stats.h"

#include <algorithm>
#include <cstring>

namespace snell {

// Samples of a pixel in one batch, at most.
constexpr uint samples_at_once = 64;

// Paths in flight at most: enough for the widest devices there are, and for a processor enough for all its lanes while
// the queues still fit its caches.
constexpr std::size_t most_paths = std::size_t{1} << 20, most_paths_on_processor = std::size_t{1} << 16;
constexpr std::size_t fewest_paths = 4096;
// Whitted's renderer has up to 1 / whitted_cutoff rays of a sample alive: the samples of one pixel must always fit.
constexpr std::size_t fewest_branching_paths = samples_at_once * 256;

// Commands that are handed over together should take that long: nobody waits longer than for two lots of them, drivers
// do not take the device for hanging (they give up after 2 to 10 seconds), and starting them costs little beside. Half
// of it made lavapipe a tenth slower.
constexpr double seconds_at_once = 0.05;
// How often the film comes to the host at least: what a device that is lost takes with it.
constexpr double film_interval = 1.0;

static QueueKinds kinds_of(const BackendJob& job)
{
    QueueKinds kinds;
    kinds.sorts = read_gpu_options(job.settings.parameters).sorts_by_material;
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
    const std::size_t room = gpu.info().info.memory_bytes / 8; // there are two of them
    while (most > fewest && most * (Queues::bytes_of_path(kinds_of(job)) + sizeof(SampleSlot)) > room) most /= 2;
    std::size_t capacity = fewest;
    while (capacity < most && static_cast<double>(capacity) < samples) capacity *= 2;
    return capacity;
}

// The pixels that a render is asked for.
static Region area_of(const RenderSettings& settings)
{
    const Region whole{0, 0, settings.width, settings.height};
    if (!settings.region) return whole;
    const Region& r = *settings.region;
    return {std::max(r.x0, 0), std::max(r.y0, 0), std::min(r.x1, whole.x1), std::min(r.y1, whole.y1)};
}

std::unique_ptr<Backend> VulkanScene::make_backend(const BackendJob& job)
{
    return std::make_unique<VulkanBackend>(*this, job);
}

VulkanBackend::Flight::Flight(Gpu& gpu, std::unique_ptr<Queues> owned)
    : queues(std::move(owned)), commands(gpu, 4 + 3 * waves_at_once)
{
}

VulkanBackend::VulkanBackend(VulkanScene& scene, const BackendJob& job)
    : scene_(scene), job_(job), options_(read_gpu_options(job.settings.parameters)), lens_(scene.gpu()),
      film_commands_(*scene.gpu())
{
    if (job.integrator.radiance)
        throw Error(
            fmt::format("the integrator '{}' is a function in C++, which a GPU cannot run", job.integrator.name),
            "use --device cpu");
    capacity_ = capacity_for(*scene.gpu(), job);
    batch_paths_ = std::min(capacity_, scene.gpu()->is_processor() ? fewest_paths : most_paths / 4);
    scene.describe(on_device_);
    on_device_.params = job.params;
    if (LensSystem& lens = on_device_.params.camera.lens; lens.interface_count > 0) {
        const std::size_t rows = std::size_t{lens.first} + lens.interface_count + lens.pupil_count;
        lens_.follow({{job.params.camera.lens.table.at, rows * sizeof(vec4)}});
        const VkDeviceAddress address = lens_.address(0);
        std::memcpy(&lens.table.at, &address, sizeof(address)); // no pointer of the host's
    }
    std::unique_ptr<Queues> queues = scene.take_queues(capacity_, kinds_of(job));
    const Region area = area_of(job.settings);
    const std::size_t pixels =
        static_cast<std::size_t>(area.x1 - area.x0) * static_cast<std::size_t>(area.y1 - area.y0);
    if (!queues->film || !queues->film->has_room(pixels, job.settings.layers)) {
        queues->film.reset(); // not two of them at a time
        queues->film = std::make_unique<DeviceFilm>(scene.gpu(), pixels, job.settings.layers);
    }
    film_ = queues->film.get();
    film_->begin(area);
    on_device_.film = film_->describe();
    GpuJob on_device = on_device_;
    queues->describe(on_device);
    flights_[0] = std::make_unique<Flight>(*scene.gpu(), std::move(queues));
}

VulkanBackend::~VulkanBackend()
{
    wait_for_all();
    for (const std::unique_ptr<Flight>& f : flights_)
        if (f) scene_.give_queues(std::move(f->queues));
}

// The second one is made when there is something for it to do.
VulkanBackend::Flight& VulkanBackend::flight(std::size_t number)
{
    if (!flights_[number]) {
        std::unique_ptr<Queues> queues = scene_.take_queues(capacity_, kinds_of(job_));
        GpuJob on_device = on_device_;
        queues->describe(on_device);
        flights_[number] = std::make_unique<Flight>(*scene_.gpu(), std::move(queues));
    }
    return *flights_[number];
}

// ---- batches ----

void VulkanBackend::render_samples(const Region& region, uint first_sample, uint count, Film& film,
                                   const std::function<bool()>& keep_going)
{
    if (count == 0) return;
    film_commands_.wait();
    film_commands_.begin();
    film_->follow(film_commands_, film, region);
    film_commands_.submit();
    last_landing_ = last_fetch_ = clock_.seconds();
    film_samples_ = stats_.samples;
    Call call{region, first_sample, count, film, keep_going};
    try {
        if (job_.integrator.name == "whitted")
            render_in_turn(call);
        else
            render_overlapping(call);
    } catch (...) {
        wait_for_all();
        stats_.samples = stats_.camera_rays = film_samples_; // the others never came
        throw;
    }
}

// As many pixels as make a batch of about batch_paths_.
VulkanBackend::Batch VulkanBackend::next_batch(Call& call) const
{
    const std::size_t pixels = static_cast<std::size_t>(call.region.x1 - call.region.x0) *
                               static_cast<std::size_t>(call.region.y1 - call.region.y0);
    Batch batch{call.region, call.next_pixel, 0, call.first_sample + call.samples_done,
                std::min(call.count - call.samples_done, samples_at_once)};
    batch.pixels = std::clamp<std::size_t>(batch_paths_ / batch.samples, 1, pixels - batch.first_pixel);
    call.next_pixel += batch.pixels;
    if (call.next_pixel == pixels) {
        call.next_pixel = 0;
        call.samples_done += batch.samples;
    }
    return batch;
}

// Batches reach the film in their order, whichever is through the stages first: so a pixel's samples are in theirs.
void VulkanBackend::render_overlapping(Call& call)
{
    std::deque<Flight*> order; // of the batches
    const auto take_off = [&](Flight& f) {
        start(f, next_batch(call));
        record_stage(f);
        order.push_back(&f);
    };
    for (std::size_t i = 0; i < std::size(flights_) && !call.is_over(); ++i) {
        begin(flight(i));
        take_off(flight(i));
        submit(flight(i));
    }
    while (!under_way_.empty()) {
        Flight& landed = *under_way_.front();
        land(call);
        if (call.stopped) continue; // a batch that is not in the film by now never will be
        if (landed.stage == Flight::Stage::first_hits || landed.stage == Flight::Stage::waves) {
            begin(landed);
            record_stage(landed);
            submit(landed);
        }
        while (!call.stopped && !order.empty() && order.front()->stage == Flight::Stage::finished) {
            Flight& f = *order.front();
            order.pop_front();
            begin(f);
            finish(f, call, order.empty());
            if (!call.is_over()) take_off(f);
            submit(f);
        }
    }
}

void VulkanBackend::start(Flight& f, const Batch& batch)
{
    f.batch = batch;
    f.recorded = recorded_samples(job_.settings, batch.first_sample, batch.samples);
    f.stage = f.recorded > 0 ? Flight::Stage::first_hits : Flight::Stage::waves;
    f.waves = 0;
    f.alive = f.recorded > 0 ? batch.pixels * f.recorded : batch.paths();
    f.stats = {};
    f.stats.camera_rays = f.stats.samples = batch.paths();
    f.seconds = f.longest = 0;
}

void VulkanBackend::record_stage(Flight& f)
{
    if (f.stage == Flight::Stage::first_hits)
        record_first_hits(f);
    else
        record_waves(f);
}

void VulkanBackend::submit(Flight& f)
{
    f.commands.submit();
    f.submitted = clock_.seconds();
    under_way_.push_back(&f);
}

// Waits for what was handed over first, and looks at what has come of it.
void VulkanBackend::land(Call& call)
{
    Flight& f = *under_way_.front();
    f.commands.wait();
    under_way_.pop_front();
    const double now = clock_.seconds();
    const double taken = now - std::max(f.submitted, last_landing_); // the device does one after the other
    last_landing_ = now;
    f.seconds += taken;
    f.longest = std::max(f.longest, taken);
    stats_.finalize_seconds += f.commands.seconds(0, 1);
    if (f.has_finalized) {
        f.has_finalized = false;
        const GpuDropped& dropped = f.queues->dropped_read();
        if (job_.settings.strict && dropped.samples > 0) {
            const Region area = area_of(job_.settings);
            const auto columns = static_cast<uint>(area.x1 - area.x0);
            refuse_sample(dropped.sample_number, area.x0 + static_cast<int>(dropped.pixel % columns),
                          area.y0 + static_cast<int>(dropped.pixel / columns), dropped.radiance);
        }
        if (f.fetches) take_film(f, call);
    }
    if (f.stage == Flight::Stage::waves) {
        count_waves(f);
        f.waves += f.waves_now;
        f.alive = f.waves < waves().most ? f.queues->counters_read().paths[f.waves_now] : 0;
        if (f.alive == 0) f.stage = Flight::Stage::finished;
    } else if (f.stage == Flight::Stage::first_hits) {
        f.waves += waves_at_once;
        f.alive = f.queues->counters_read().paths[waves_at_once];
        if (f.alive > 0) return;
        f.stage = Flight::Stage::waves;
        f.waves = 0;
        f.alive = f.batch.paths();
    }
}

void VulkanBackend::take_film(Flight& f, Call& call)
{
    const Timer timer;
    film_->take(call.film, f.queues->dropped_read());
    film_samples_ = f.film_samples;
    f.fetches = is_fetching_ = false;
    last_fetch_ = clock_.seconds();
    stats_.finalize_seconds += timer.seconds();
}

// Records what adds the batch to the film, after all batches before it. is_last: no other one is on its way.
void VulkanBackend::finish(Flight& f, Call& call, bool is_last)
{
    record_finalize(f);
    const Batch& batch = f.batch;
    add(stats_, f.stats);
    film_->note_changed(batch.first_pixel, batch.pixels);
    add_batch_time(f, call.film);
    const double factor = std::clamp(seconds_at_once / std::max(f.longest, 1e-6), 0.5, 2.0);
    batch_paths_ = std::clamp(static_cast<std::size_t>(static_cast<double>(batch_paths_) * factor),
                              std::min(fewest_paths, batch_paths_), capacity_);
    f.stage = Flight::Stage::idle;
    if (!call.keep_going()) call.stopped = true;
    const bool is_end = call.stopped || (is_last && call.is_over());
    while (is_end && is_fetching_) land(call);
    if (is_end || (!is_fetching_ && clock_.seconds() - last_fetch_ > film_interval)) {
        film_->fetch(f.commands);
        f.fetches = is_fetching_ = true;
        f.film_samples = stats_.samples;
    }
    f.commands.stamp(1);
}

// The time that a batch has taken, shared alike by its pixels.
void VulkanBackend::add_batch_time(const Flight& f, Film& film) const
{
    const Batch& batch = f.batch;
    const auto columns = static_cast<std::size_t>(batch.region.x1 - batch.region.x0);
    const std::size_t end = batch.first_pixel + batch.pixels;
    const double share = f.seconds / static_cast<double>(batch.pixels);
    for (std::size_t row = batch.first_pixel / columns; row * columns < end; ++row) {
        const std::size_t from = std::max(batch.first_pixel, row * columns), to = std::min(end, (row + 1) * columns);
        const int y = batch.region.y0 + static_cast<int>(row);
        const auto x_of = [&](std::size_t p) { return batch.region.x0 + static_cast<int>(p - row * columns); };
        add_time(film, {x_of(from), y, x_of(to), y + 1}, share * static_cast<double>(to - from));
    }
}

void VulkanBackend::wait_for_all() noexcept
{
    for (Flight* f : under_way_) {
        try {
            f->commands.wait();
        } catch (const Error&) { // lost: there is nothing to wait for
        }
    }
    try {
        film_commands_.wait();
    } catch (const Error&) {
    }
    under_way_.clear();
    is_fetching_ = false;
    for (const std::unique_ptr<Flight>& f : flights_)
        if (f) f->fetches = f->has_finalized = false;
}

// ---- commands ----

GpuPush VulkanBackend::parameters(const Flight& f) const
{
    GpuPush push{};
    push.job.address = f.queues->job();
    return push;
}

// For kernels that know pixels.
GpuPush VulkanBackend::batch_parameters(const Flight& f, uint samples) const
{
    const Batch& batch = f.batch;
    GpuPush push = parameters(f);
    push.first_pixel = static_cast<uint>(batch.first_pixel);
    push.first_sample = batch.first_sample;
    push.samples = samples;
    push.x0 = static_cast<uint>(batch.region.x0);
    push.y0 = static_cast<uint>(batch.region.y0);
    push.columns = static_cast<uint>(batch.region.x1 - batch.region.x0);
    return push;
}

void VulkanBackend::begin(Flight& f)
{
    f.commands.begin();
    f.commands.barrier(); // behind what was handed over before
    f.commands.stamp(0);
}

void VulkanBackend::set_counters(Flight& f, std::size_t paths)
{
    GpuCounters counters{};
    counters.paths[0] = static_cast<uint>(paths);
    counters.path_groups[0] = static_cast<uint>((paths + group_size - 1) / group_size);
    counters.path_groups[1] = counters.path_groups[2] = 1;
    f.commands.barrier();
    vkCmdUpdateBuffer(f.commands.handle, f.queues->counters.handle, 0, sizeof(counters), &counters);
    f.commands.barrier();
}

void VulkanBackend::dispatch(Flight& f, GpuKernel kernel, const GpuPush& push, std::size_t items)
{
    f.commands.bind(kernel);
    f.commands.push(&push, sizeof(push));
    f.commands.dispatch(items);
    f.commands.barrier();
}

void VulkanBackend::dispatch_indirect(Flight& f, GpuKernel kernel, const GpuPush& push, std::size_t counters_offset)
{
    f.commands.bind(kernel);
    f.commands.push(&push, sizeof(push));
    f.commands.dispatch_indirect(f.queues->counters, counters_offset);
    f.commands.barrier();
}

void VulkanBackend::copy_counters(Flight& f)
{
    const VkBufferCopy copy{0, 0, sizeof(GpuCounters)};
    vkCmdCopyBuffer(f.commands.handle, f.queues->counters.handle, f.queues->counters_seen.handle, 1, &copy);
}

void VulkanBackend::generate(Flight& f, uint samples)
{
    GpuPush push = batch_parameters(f, samples);
    push.count = static_cast<uint>(f.batch.pixels * samples);
    dispatch(f, scene_.gpu()->kernel("generate"), push, push.count);
}

void VulkanBackend::record_finalize(Flight& f)
{
    Gpu& gpu = *scene_.gpu();
    GpuPush push = batch_parameters(f, f.batch.samples);
    push.count = static_cast<uint>(f.batch.pixels);
    dispatch(f, gpu.kernel("finalize"), push, push.count);
    if (f.recorded > 0) {
        push.samples = f.recorded;
        dispatch(f, gpu.kernel("finalize_hits"), push, push.count);
    }
    const VkBufferCopy copy{0, sizeof(GpuCounters), sizeof(GpuDropped)};
    vkCmdCopyBuffer(f.commands.handle, film_->dropped.handle, f.queues->counters_seen.handle, 1, &copy);
    f.has_finalized = true;
}

} // namespace snell
