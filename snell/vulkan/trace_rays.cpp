#include "snell/vulkan/trace_rays.h"

#include "snell/core/error.h"

#include <cstring>

namespace snell {

constexpr auto on_device = GpuBuffer::Placement::device;

RayBatch::RayBatch(VulkanScene& scene, std::span<const Ray> rays)
    : scene_(scene), count_(rays.size()), rays_(*scene.gpu(), count_ * sizeof(Ray), on_device, "rays"),
      states_(*scene.gpu(), count_ * sizeof(PathState), on_device, "rays"),
      hits_(*scene.gpu(), count_ * sizeof(Hit), on_device, "hits"),
      connections_(*scene.gpu(), count_ * sizeof(Connection), on_device, "rays"),
      slots_(*scene.gpu(), count_ * sizeof(SampleSlot), on_device, "hits"),
      counters_(*scene.gpu(), sizeof(GpuCounters), on_device, "counters"),
      job_(*scene.gpu(), sizeof(GpuJob), on_device, "parameters"), commands_(*scene.gpu(), 2)
{
    Gpu& gpu = *scene.gpu();
    std::vector<PathState> states(count_, PathState{});
    std::vector<Connection> connections(count_, Connection{});
    for (std::size_t i = 0; i < count_; ++i) {
        states[i].slot = static_cast<uint>(i);
        connections[i].ray = rays[i];
        connections[i].slot = static_cast<uint>(i);
        connections[i].value = vec3(1.0f);
        connections[i].layer = layer_direct;
    }
    gpu.upload(rays_, 0, rays.data(), count_ * sizeof(Ray));
    gpu.upload(states_, 0, states.data(), count_ * sizeof(PathState));
    gpu.upload(connections_, 0, connections.data(), count_ * sizeof(Connection));
    GpuCounters counters{};
    counters.paths[0] = counters.connections[0] = static_cast<uint>(count_);
    gpu.upload(counters_, 0, &counters, sizeof(counters));
    GpuJob job{};
    scene.describe(job);
    job.rays_0.address = rays_.address;
    job.states_0.address = states_.address;
    job.hits.address = hits_.address;
    job.connections.address = connections_.address;
    job.slots.address = slots_.address;
    job.counters.address = counters_.address;
    gpu.upload(job_, 0, &job, sizeof(job));
}

double RayBatch::run(GpuKernel kernel)
{
    GpuPush push{};
    push.job.address = job_.address;
    commands_.begin();
    vkCmdFillBuffer(commands_.handle, slots_.handle, 0, VK_WHOLE_SIZE, 0);
    commands_.barrier();
    commands_.stamp(0);
    commands_.bind(kernel);
    commands_.push(&push, sizeof(push));
    commands_.dispatch(count_);
    commands_.barrier();
    commands_.stamp(1);
    commands_.run();
    return commands_.seconds(0, 1);
}

double RayBatch::intersect()
{
    return run(scene_.gpu()->kernel("extend", scene_.trace_constants(false)));
}

double RayBatch::occlude()
{
    return run(scene_.gpu()->kernel("connect", scene_.trace_constants(false)));
}

void RayBatch::read(const GpuBuffer& from, void* to, std::size_t bytes) const
{
    const GpuBuffer seen(*scene_.gpu(), bytes, GpuBuffer::Placement::readback, "hits");
    commands_.begin();
    const VkBufferCopy copy{0, 0, bytes};
    vkCmdCopyBuffer(commands_.handle, from.handle, seen.handle, 1, &copy);
    commands_.run();
    std::memcpy(to, seen.data, bytes);
}

std::vector<Hit> RayBatch::hits() const
{
    std::vector<Hit> hits(count_);
    read(hits_, hits.data(), count_ * sizeof(Hit));
    return hits;
}

std::vector<std::uint8_t> RayBatch::blocked() const
{
    std::vector<SampleSlot> slots(count_);
    read(slots_, slots.data(), count_ * sizeof(SampleSlot));
    std::vector<std::uint8_t> blocked(count_);
    for (std::size_t i = 0; i < count_; ++i) blocked[i] = slots[i].layers[layer_direct].x == 0.0f;
    return blocked;
}

} // namespace snell
