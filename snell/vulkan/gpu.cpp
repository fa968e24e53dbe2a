#include "snell/vulkan/gpu.h"

#include "snell/core/error.h"
#include "snell/vulkan/shaders/job.h"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <limits>

namespace snell {

// Large enough to keep the bus busy, small enough to be had anywhere.
constexpr std::size_t staging_bytes = std::size_t{32} << 20;

static std::mutex open_mutex;                               // of what follows
static std::map<std::string, std::weak_ptr<Gpu>> open_gpus; // by device

std::shared_ptr<Gpu> Gpu::open(const std::string& device)
{
    const std::lock_guard lock(open_mutex);
    if (std::shared_ptr<Gpu> gpu = open_gpus[device].lock()) return gpu;
    const std::shared_ptr<VulkanInstance> instance = VulkanInstance::get();
    for (const VulkanDevice& candidate : instance->devices()) {
        if (candidate.info.device != device) continue;
        if (!candidate.info.refusal.empty())
            throw Error(fmt::format("{} ({}) cannot be used: {}", device, candidate.info.title, candidate.info.refusal),
                        "update its driver, or use another device of `snell --list-devices`");
        std::shared_ptr<Gpu> gpu(new Gpu(instance, candidate));
        test_gpu(gpu);
        open_gpus[device] = gpu;
        return gpu;
    }
    throw Error(fmt::format("there is no device {}", device), "`snell --list-devices` shows what there is");
}

Gpu::Gpu(std::shared_ptr<VulkanInstance> instance, const VulkanDevice& chosen)
    : instance_(std::move(instance)), info_(chosen)
{
    const float priority = 1.0f;
    VkDeviceQueueCreateInfo queue{};
    queue.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO;
    queue.queueFamilyIndex = info_.queue_family;
    queue.queueCount = 1;
    queue.pQueuePriorities = &priority;
    VkPhysicalDeviceVulkan12Features features{};
    features.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES;
    features.bufferDeviceAddress = VK_TRUE;
    features.scalarBlockLayout = VK_TRUE;
    VkDeviceCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO;
    info.pNext = &features;
    info.queueCreateInfoCount = 1;
    info.pQueueCreateInfos = &queue;
    check_vulkan(vkCreateDevice(info_.handle, &info, nullptr, &device_), "vkCreateDevice");
    vkGetDeviceQueue(device_, info_.queue_family, 0, &queue_);

    const VkPushConstantRange range{VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof(GpuPush)};
    VkPipelineLayoutCreateInfo layout{};
    layout.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO;
    layout.pushConstantRangeCount = 1;
    layout.pPushConstantRanges = &range;
    check_vulkan(vkCreatePipelineLayout(device_, &layout, nullptr, &layout_), "vkCreatePipelineLayout");
    load_pipelines();
    uploads_ = std::make_unique<Commands>(*this);
}

Gpu::~Gpu()
{
    if (device_ == VK_NULL_HANDLE) return;
    vkDeviceWaitIdle(device_);
    uploads_.reset();
    staging_.reset();
    for (const auto& [key, pipeline] : pipelines_) vkDestroyPipeline(device_, pipeline, nullptr);
    vkDestroyPipelineCache(device_, cache_, nullptr);
    vkDestroyPipelineLayout(device_, layout_, nullptr);
    vkDestroyDevice(device_, nullptr);
}

// ---- memory ----

// The first type that has all of one of these sets of properties; the sets come in the order of preference.
static std::uint32_t find_memory_type(const VkPhysicalDeviceMemoryProperties& memory, std::uint32_t allowed,
                                      std::initializer_list<VkMemoryPropertyFlags> wishes)
{
    for (const VkMemoryPropertyFlags wish : wishes)
        for (std::uint32_t type = 0; type < memory.memoryTypeCount; ++type)
            if ((allowed >> type & 1u) && (memory.memoryTypes[type].propertyFlags & wish) == wish) return type;
    return 0; // not reached: the specification promises a type for the last set of each list
}

GpuBuffer::GpuBuffer(const Gpu& gpu, std::size_t size, Placement placement, const char* what)
    : bytes(std::max<std::size_t>(size, 16)), device_(gpu.handle())
{
    VkBufferCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO;
    info.size = bytes + gpu.info().buffer_margin;
    info.usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT |
                 VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT |
                 VK_BUFFER_USAGE_TRANSFER_DST_BIT;
    check_vulkan(vkCreateBuffer(device_, &info, nullptr, &handle), "vkCreateBuffer");

    VkMemoryRequirements needs;
    vkGetBufferMemoryRequirements(device_, handle, &needs);
    constexpr VkMemoryPropertyFlags near = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
    constexpr VkMemoryPropertyFlags seen = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    const VkPhysicalDeviceMemoryProperties& memory = gpu.info().memory;
    const std::uint32_t type =
        placement == Placement::device ? find_memory_type(memory, needs.memoryTypeBits, {near, 0})
        : placement == Placement::upload
            ? find_memory_type(memory, needs.memoryTypeBits, {seen})
            : find_memory_type(memory, needs.memoryTypeBits, {seen | VK_MEMORY_PROPERTY_HOST_CACHED_BIT, seen});

    VkMemoryAllocateFlagsInfo flags{};
    flags.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO;
    flags.flags = VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT;
    VkMemoryAllocateInfo allocation{};
    allocation.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
    allocation.pNext = &flags;
    allocation.allocationSize = needs.size;
    allocation.memoryTypeIndex = type;
    const VkResult result = needs.size > memory.memoryHeaps[memory.memoryTypes[type].heapIndex].size
                                ? VK_ERROR_OUT_OF_DEVICE_MEMORY
                                : vkAllocateMemory(device_, &allocation, nullptr, &memory_);
    if (result != VK_SUCCESS) {
        vkDestroyBuffer(device_, handle, nullptr);
        if (result != VK_ERROR_OUT_OF_DEVICE_MEMORY && result != VK_ERROR_OUT_OF_HOST_MEMORY)
            check_vulkan(result, "vkAllocateMemory");
        throw Error(fmt::format("{} has no memory left for {}: {:.1f} MiB are needed, it has {:.0f} MiB in all",
                                gpu.info().info.title, what, static_cast<double>(needs.size) / 0x1p20,
                                static_cast<double>(gpu.info().info.memory_bytes) / 0x1p20),
                    "close what else uses the GPU, make the scene or the picture smaller, or use --device cpu");
    }
    check_vulkan(vkBindBufferMemory(device_, handle, memory_, 0), "vkBindBufferMemory");
    if ((memory.memoryTypes[type].propertyFlags & seen) == seen)
        check_vulkan(vkMapMemory(device_, memory_, 0, VK_WHOLE_SIZE, 0, &data), "vkMapMemory");
    VkBufferDeviceAddressInfo where{};
    where.sType = VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO;
    where.buffer = handle;
    address = vkGetBufferDeviceAddress(device_, &where);
}

GpuBuffer::~GpuBuffer()
{
    vkDestroyBuffer(device_, handle, nullptr);
    vkFreeMemory(device_, memory_, nullptr);
}

void Gpu::upload(const GpuBuffer& to, std::size_t offset, const void* data, std::size_t bytes)
{
    SNELL_CHECK_LE(offset + bytes, to.bytes);
    if (bytes == 0) return;
    if (to.data != nullptr) {
        std::memcpy(static_cast<std::byte*>(to.data) + offset, data, bytes);
        return;
    }
    upload_by_copy(to, offset, data, bytes);
}

void Gpu::upload_by_copy(const GpuBuffer& to, std::size_t offset, const void* data, std::size_t bytes)
{
    const std::lock_guard lock(upload_mutex_);
    if (!staging_)
        staging_ = std::make_unique<GpuBuffer>(*this, staging_bytes, GpuBuffer::Placement::upload, "copying to it");
    for (std::size_t done = 0; done < bytes;) {
        const std::size_t part = std::min(bytes - done, staging_bytes);
        std::memcpy(staging_->data, static_cast<const std::byte*>(data) + done, part);
        uploads_->begin();
        const VkBufferCopy copy{0, offset + done, part};
        vkCmdCopyBuffer(uploads_->handle, staging_->handle, to.handle, 1, &copy);
        uploads_->run();
        done += part;
    }
}

// ---- commands ----

Gpu::Commands::Commands(Gpu& gpu, std::uint32_t timestamps) : gpu_(gpu)
{
    VkCommandPoolCreateInfo pool{};
    pool.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO;
    pool.flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT;
    pool.queueFamilyIndex = gpu.info_.queue_family;
    check_vulkan(vkCreateCommandPool(gpu.device_, &pool, nullptr, &pool_), "vkCreateCommandPool");
    VkCommandBufferAllocateInfo buffer{};
    buffer.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO;
    buffer.commandPool = pool_;
    buffer.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
    buffer.commandBufferCount = 1;
    check_vulkan(vkAllocateCommandBuffers(gpu.device_, &buffer, &handle), "vkAllocateCommandBuffers");
    VkFenceCreateInfo fence{};
    fence.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO;
    check_vulkan(vkCreateFence(gpu.device_, &fence, nullptr, &fence_), "vkCreateFence");
    if (timestamps == 0 || !gpu.info_.has_timestamps) return;
    VkQueryPoolCreateInfo queries{};
    queries.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO;
    queries.queryType = VK_QUERY_TYPE_TIMESTAMP;
    queries.queryCount = timestamps;
    check_vulkan(vkCreateQueryPool(gpu.device_, &queries, nullptr, &queries_), "vkCreateQueryPool");
    query_count_ = timestamps;
}

Gpu::Commands::~Commands()
{
    if (runs_) vkWaitForFences(gpu_.device_, 1, &fence_, VK_TRUE, std::numeric_limits<std::uint64_t>::max());
    vkDestroyQueryPool(gpu_.device_, queries_, nullptr);
    vkDestroyFence(gpu_.device_, fence_, nullptr);
    vkDestroyCommandPool(gpu_.device_, pool_, nullptr);
}

void Gpu::Commands::begin()
{
    check_vulkan(vkResetCommandPool(gpu_.device_, pool_, 0), "vkResetCommandPool");
    VkCommandBufferBeginInfo info{};
    info.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO;
    info.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
    check_vulkan(vkBeginCommandBuffer(handle, &info), "vkBeginCommandBuffer");
    times_.assign(query_count_, 0);
    stamped_.assign(query_count_, false);
    if (query_count_ > 0) vkCmdResetQueryPool(handle, queries_, 0, query_count_);
}

void Gpu::Commands::submit()
{
    VkMemoryBarrier to_host{};
    to_host.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER;
    to_host.srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_WRITE_BIT;
    to_host.dstAccessMask = VK_ACCESS_HOST_READ_BIT;
    vkCmdPipelineBarrier(handle, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT,
                         VK_PIPELINE_STAGE_HOST_BIT, 0, 1, &to_host, 0, nullptr, 0, nullptr);
    check_vulkan(vkEndCommandBuffer(handle), "vkEndCommandBuffer");
    VkSubmitInfo submit{};
    submit.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO;
    submit.commandBufferCount = 1;
    submit.pCommandBuffers = &handle;
    if (gpu_.acts_lost) check_vulkan(VK_ERROR_DEVICE_LOST, "vkQueueSubmit");
    {
        const std::lock_guard lock(gpu_.queue_mutex_);
        check_vulkan(vkQueueSubmit(gpu_.queue_, 1, &submit, fence_), "vkQueueSubmit");
    }
    runs_ = true;
}

void Gpu::Commands::wait()
{
    if (!runs_) return;
    runs_ = false; // whatever comes of it: who has lost a device waits for nothing
    check_vulkan(vkWaitForFences(gpu_.device_, 1, &fence_, VK_TRUE, std::numeric_limits<std::uint64_t>::max()),
                 "vkWaitForFences");
    check_vulkan(vkResetFences(gpu_.device_, 1, &fence_), "vkResetFences");
    for (std::uint32_t i = 0; i < query_count_; ++i)
        if (stamped_[i])
            check_vulkan(vkGetQueryPoolResults(gpu_.device_, queries_, i, 1, sizeof(std::uint64_t), &times_[i],
                                               sizeof(std::uint64_t), VK_QUERY_RESULT_64_BIT),
                         "vkGetQueryPoolResults");
}

void Gpu::Commands::push(const void* parameters, std::size_t bytes)
{
    vkCmdPushConstants(handle, gpu_.layout_, VK_SHADER_STAGE_COMPUTE_BIT, 0, static_cast<std::uint32_t>(bytes),
                       parameters);
}

void Gpu::Commands::dispatch(std::size_t items)
{
    vkCmdDispatch(handle, static_cast<std::uint32_t>((items + group_size - 1) / group_size), 1, 1);
}

void Gpu::Commands::dispatch_indirect(const GpuBuffer& buffer, std::size_t offset)
{
    vkCmdDispatchIndirect(handle, buffer.handle, offset);
}

void Gpu::Commands::barrier()
{
    VkMemoryBarrier barrier{};
    barrier.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER;
    barrier.srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_TRANSFER_WRITE_BIT |
                            VK_ACCESS_TRANSFER_READ_BIT;
    barrier.dstAccessMask = VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_READ_BIT |
                            VK_ACCESS_TRANSFER_WRITE_BIT | VK_ACCESS_INDIRECT_COMMAND_READ_BIT;
    constexpr VkPipelineStageFlags work = VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT;
    vkCmdPipelineBarrier(handle, work | VK_PIPELINE_STAGE_DRAW_INDIRECT_BIT, work | VK_PIPELINE_STAGE_DRAW_INDIRECT_BIT,
                         0, 1, &barrier, 0, nullptr, 0, nullptr);
}

void Gpu::Commands::stamp(std::uint32_t number)
{
    if (number >= query_count_) return;
    vkCmdWriteTimestamp(handle, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, queries_, number);
    stamped_[number] = true;
}

double Gpu::Commands::seconds(std::uint32_t from, std::uint32_t to) const
{
    if (to >= query_count_ || !stamped_[from] || !stamped_[to] || times_[to] < times_[from]) return 0;
    return 1e-9 * static_cast<double>(gpu_.info_.properties.limits.timestampPeriod) *
           static_cast<double>(times_[to] - times_[from]);
}

} // namespace snell
