// Whitted's renderer on a Vulkan device: samples that branch, so that the host looks after each bounce how many paths
// there are.
#include "snell/core/error.h"
#include "snell/vulkan/backend.h"

#include <algorithm>

namespace snell {

void VulkanBackend::render_in_turn(Call& call)
{
    Flight& f = flight(0);
    while (!call.is_over()) {
        const std::size_t pixel = call.next_pixel;
        const uint samples = call.samples_done;
        start(f, next_batch(call));
        while (f.stage == Flight::Stage::first_hits) {
            begin(f);
            record_first_hits(f);
            submit(f);
            land(call);
        }
        f.stage = Flight::Stage::idle; // its waves are counted here
        if (!run_whitted(f, call)) {   // it has branched into more paths than there is room for
            SNELL_CHECK_LT(1u, f.batch.pixels);
            batch_paths_ = std::max<std::size_t>(f.batch.paths() / 2, 1);
            call.next_pixel = pixel;
            call.samples_done = samples;
            continue;
        }
        begin(f);
        finish(f, call, true);
        submit(f);
        land(call);
    }
}

// Tests `rounds` connections of each of `count` paths; returns how many rays that took.
std::size_t VulkanBackend::light_rounds(Flight& f, Call& call, GpuPush push, std::size_t count, uint rounds)
{
    Gpu& gpu = *scene_.gpu();
    const GpuKernel light = gpu.kernel("light_whitted", scene_.shade_constants()), arrange = gpu.kernel("arrange");
    const GpuKernel connect = trace_kernel("connect", false);
    std::size_t rays = 0;
    for (uint done = 0; done < rounds;) {
        const uint now = std::min(rounds - done, waves_at_once);
        begin(f);
        set_counters(f, count);
        f.commands.stamp(2);
        for (uint round = 0; round < now; ++round) {
            push.wave = round; // so that each round has a counter of its own
            push.which = done + round;
            dispatch(f, light, push, count);
            dispatch(f, arrange, push, 1);
            push.which = 1; // connections add to the paths' own slots
            dispatch_trace(f, connect, push, offsetof(GpuCounters, connection_groups) + 12 * round);
        }
        f.commands.stamp(3);
        copy_counters(f);
        submit(f);
        land(call);
        f.stats.connect_seconds += f.commands.seconds(2, 3);
        for (uint round = 0; round < now; ++round) rays += f.queues->counters_read().connections[round];
        done += now;
    }
    return rays;
}

// False: there was no room for all the paths of the batch, and nothing has come of it.
bool VulkanBackend::run_whitted(Flight& f, Call& call)
{
    Gpu& gpu = *scene_.gpu();
    const GpuKernel extend = trace_kernel("extend", false);
    const GpuKernel shade = gpu.kernel("shade_whitted", scene_.shade_constants()),
                    gather = gpu.kernel("gather_whitted");
    const GpuKernel sum = gpu.kernel("sum"), spread = gpu.kernel("spread"), enqueue = gpu.kernel("enqueue_whitted");
    const SceneView view = job_.scene.view();
    const uint rounds = view.delta_light_count + (view.light_count > view.delta_light_count ? 1 : 0) +
                        (is_black(view.environment.radiance) ? 0 : 1);

    GpuPush push = parameters(f);
    for (std::size_t count = f.batch.paths(), wave = 0; count > 0; ++wave) {
        push.count = static_cast<uint>(count);
        push.wave = 0;
        begin(f);
        set_counters(f, count);
        f.commands.stamp(2);
        if (wave == 0) generate(f, f.batch.samples);
        f.commands.stamp(3);
        push.from_camera = wave == 0 ? 1 : 0;
        dispatch_trace(f, extend, push, offsetof(GpuCounters, path_groups));
        f.commands.stamp(4);
        dispatch(f, shade, push, count);
        f.commands.stamp(5);
        submit(f);
        land(call);
        f.stats.generate_seconds += f.commands.seconds(2, 3);
        f.stats.extend_seconds += f.commands.seconds(3, 4);
        f.stats.shade_seconds += f.commands.seconds(4, 5);
        f.stats.shadow_rays += light_rounds(f, call, push, count, rounds);

        // What was found goes to the samples; the continuations find their places: sums upwards, then downwards.
        begin(f);
        push.count = static_cast<uint>(count);
        push.wave = 0;
        dispatch(f, gather, push, count);
        std::vector<GpuPush> levels;
        GpuPush level = push;
        level.offset = 0;
        for (;; level.count = (level.count + 63) / 64) {
            level.to = level.offset + level.count;
            levels.push_back(level);
            if (level.count <= 64) break;
            dispatch(f, sum, level, (level.count + 63) / 64);
            level.offset = level.to;
        }
        levels.back().which = 1;
        for (std::size_t i = levels.size(); i-- > 0;) dispatch(f, spread, levels[i], (levels[i].count + 63) / 64);
        copy_counters(f);
        submit(f);
        land(call);
        const std::size_t next = f.queues->counters_read().paths[1];
        if (next > f.queues->capacity) return false;
        f.stats.extension_rays += next;
        if (next > 0) {
            begin(f);
            dispatch(f, enqueue, push, count);
            submit(f);
            land(call);
        }
        push.queue = 1 - push.queue;
        count = next;
    }
    return true;
}

} // namespace snell
