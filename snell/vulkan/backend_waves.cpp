// Integrators with at most one continuation and one connection at each vertex on a Vulkan device: wave after wave, a
// bounce of all paths each.
#include "snell/core/error.h"
#include "snell/kernel/views.h"
#include "snell/vulkan/backend.h"

#include <algorithm>

namespace snell {

// Workgroups that fetch rays: as many as the widest devices run at a time, and for a processor a few for each thread.
constexpr std::size_t fetching_groups = 4096, fetching_groups_on_processor = 16;

GpuKernel VulkanBackend::trace_kernel(const char* name, bool counts_steps) const
{
    std::vector<std::uint32_t> constants = scene_.trace_constants(counts_steps);
    if (options_.takes_blocks) constants.push_back(1);
    return scene_.gpu()->kernel(name, constants);
}

// counters_offset: where the number of workgroups stands that there are rays for.
void VulkanBackend::dispatch_trace(Flight& f, GpuKernel kernel, const GpuPush& push, std::size_t counters_offset)
{
    if (!options_.takes_blocks) return dispatch_indirect(f, kernel, push, counters_offset);
    const std::size_t groups = scene_.gpu()->is_processor() ? fetching_groups_on_processor : fetching_groups;
    dispatch(f, kernel, push, groups * group_size);
}

VulkanBackend::Waves VulkanBackend::waves() const
{
    const IntegratorInfo& integrator = job_.integrator;
    if (traces_paths(integrator))
        return {"shade_path", 0, std::uint64_t{job_.params.max_depth} + 1, true};
    if (integrator.name == "ao") return {"shade_ambient", 0, 1, false};
    SNELL_CHECK_LT(integrator.view, view_count);
    return {"shade_view", integrator.view, 1, false};
}

// The next few waves of paths that have at most one continuation and one connection at each vertex.
void VulkanBackend::record_waves(Flight& f)
{
    Gpu& gpu = *scene_.gpu();
    const Waves all = waves();
    const GpuKernel extend = trace_kernel("extend", job_.integrator.view == view_steps);
    const GpuKernel connect = trace_kernel("connect", false), arrange = gpu.kernel("arrange");
    const bool sorts = options_.sorts_by_material && all.can_be_sorted;
    std::vector<std::uint32_t> constants = scene_.shade_constants();
    if (sorts) constants.push_back(1);
    const GpuKernel shade = gpu.kernel(all.shade, constants);
    f.waves_now = static_cast<uint>(std::min<std::uint64_t>(waves_at_once, all.most - f.waves));
    set_counters(f, f.alive);
    f.commands.stamp(2);
    if (f.waves == 0) generate(f, f.batch.samples);
    f.commands.stamp(3);
    for (uint wave = 0; wave < f.waves_now; ++wave) {
        GpuPush push = parameters(f);
        push.queue = wave & 1u;
        push.wave = wave;
        push.from_camera = f.waves + wave == 0 ? 1 : 0;
        const std::size_t groups = offsetof(GpuCounters, path_groups) + 12 * wave;
        dispatch_trace(f, extend, push, groups);
        f.commands.stamp(4 + 3 * wave);
        if (sorts) {
            dispatch_indirect(f, gpu.kernel("sort_count"), push, groups);
            dispatch_indirect(f, gpu.kernel("sort_place"), push, groups);
        }
        push.which = all.which;
        dispatch_indirect(f, shade, push, groups);
        dispatch(f, arrange, push, 1);
        f.commands.stamp(5 + 3 * wave);
        push.which = 0; // connections add to the slots
        dispatch_trace(f, connect, push, offsetof(GpuCounters, connection_groups) + 12 * wave);
        f.commands.stamp(6 + 3 * wave);
    }
    copy_counters(f);
}

void VulkanBackend::count_waves(Flight& f)
{
    const GpuCounters& counters = f.queues->counters_read();
    f.stats.generate_seconds += f.commands.seconds(2, 3);
    for (uint wave = 0; wave < f.waves_now; ++wave) {
        f.stats.extend_seconds += f.commands.seconds(3 + 3 * wave, 4 + 3 * wave);
        f.stats.shade_seconds += f.commands.seconds(4 + 3 * wave, 5 + 3 * wave);
        f.stats.connect_seconds += f.commands.seconds(5 + 3 * wave, 6 + 3 * wave);
        f.stats.extension_rays += counters.paths[wave + 1];
        f.stats.shadow_rays += counters.connections[wave];
    }
}

// Before the batch's own paths: the samples that these start with stay where they are.
void VulkanBackend::record_first_hits(Flight& f)
{
    Gpu& gpu = *scene_.gpu();
    const GpuKernel counted = trace_kernel("extend", true), extend = trace_kernel("extend", false);
    const GpuKernel record = gpu.kernel("record_hits", scene_.shade_constants()), arrange = gpu.kernel("arrange");
    set_counters(f, f.alive);
    if (f.waves == 0) generate(f, f.recorded);
    for (uint wave = 0; wave < waves_at_once; ++wave) {
        GpuPush push = parameters(f);
        push.queue = wave & 1u;
        push.wave = wave;
        push.which = static_cast<uint>(f.waves) + wave;
        push.from_camera = push.which == 0 ? 1 : 0;
        const std::size_t groups = offsetof(GpuCounters, path_groups) + 12 * wave;
        dispatch_trace(f, push.which == 0 ? counted : extend, push, groups);
        dispatch_indirect(f, record, push, groups);
        dispatch(f, arrange, push, 1);
    }
    copy_counters(f);
}

} // namespace snell
