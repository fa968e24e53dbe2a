// A Vulkan device at work: memory, kernels, and running them.
#pragma once

#include "snell/vulkan/instance.h"

#include <atomic>
#include <functional>
#include <map>
#include <span>
#include <string_view>

namespace snell {

class Gpu;

// Memory of the device that kernels reach by its address.
class GpuBuffer
{
  public:
    enum class Placement
    {
        device,  // nearest to the device; mapped where the host can see that memory
        upload,  // the host writes it, the device copies from it
        readback // the device copies to it, the host reads it
    };

    // Throws Error if there is not enough memory; what: what for.
    GpuBuffer(const Gpu& gpu, std::size_t bytes, Placement placement, const char* what);
    ~GpuBuffer();
    GpuBuffer(const GpuBuffer&) = delete;
    GpuBuffer& operator=(const GpuBuffer&) = delete;

    const std::size_t bytes;
    VkBuffer handle = VK_NULL_HANDLE;
    VkDeviceAddress address = 0;
    void* data = nullptr; // mapped and coherent; null: the host cannot see it

  private:
    const VkDevice device_;
    VkDeviceMemory memory_ = VK_NULL_HANDLE;
};

// A kernel, made ready for the device.
struct GpuKernel
{
    VkPipeline pipeline = VK_NULL_HANDLE;
};

class Gpu
{
  public:
    // device: "gpu:N". The one that is in use, or a new one, which then has passed its self-test. Throws Error if the
    // device is not there, cannot be used, or fails the test.
    static std::shared_ptr<Gpu> open(const std::string& device);
    ~Gpu();
    Gpu(const Gpu&) = delete;
    Gpu& operator=(const Gpu&) = delete;

    const VulkanDevice& info() const { return info_; }
    VkDevice handle() const { return device_; }
    bool is_processor() const { return info_.properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU; }

    // Kernel `name` of snell/vulkan/shaders/, specialised by its constants 0, 1, ... Compiled once, and kept.
    GpuKernel kernel(std::string_view name, const std::vector<std::uint32_t>& constants = {});
    VkPipelineLayout layout() const { return layout_; } // of all kernels: GpuPush

    // For tests: what is handed over fails from now on, as on a device that is lost.
    std::atomic<bool> acts_lost = false;

    // Copies to a buffer, at once.
    void upload(const GpuBuffer& to, std::size_t offset, const void* data, std::size_t bytes);
    // The same for memory that the host cannot see: through a buffer that both see.
    void upload_by_copy(const GpuBuffer& to, std::size_t offset, const void* data, std::size_t bytes);

    // One set of commands that is recorded and run again and again, by one thread at a time. Sets run in the order in
    // which they are handed over.
    class Commands
    {
      public:
        explicit Commands(Gpu& gpu, std::uint32_t timestamps = 0);
        ~Commands();
        Commands(const Commands&) = delete;
        Commands& operator=(const Commands&) = delete;

        void begin(); // what was handed over has been waited for
        // Hands over what was recorded, and returns at once. Throws DeviceLost if the device is.
        void submit();
        // Waits for it, if there is anything to wait for. Throws DeviceLost if the device is.
        void wait();
        void run()
        {
            submit();
            wait();
        }

        void bind(GpuKernel kernel) { vkCmdBindPipeline(handle, VK_PIPELINE_BIND_POINT_COMPUTE, kernel.pipeline); }
        void push(const void* parameters, std::size_t bytes);
        void dispatch(std::size_t items); // in workgroups of group_size
        void dispatch_indirect(const GpuBuffer& buffer, std::size_t offset);
        // What follows sees what kernels and copies before it have written.
        void barrier();
        // Notes the time when all before is done; see seconds(). Nothing where the device has no clock.
        void stamp(std::uint32_t number);
        // After wait(): between two stamps; 0 where the device has no clock.
        double seconds(std::uint32_t from, std::uint32_t to) const;

        VkCommandBuffer handle = VK_NULL_HANDLE;

      private:
        Gpu& gpu_;
        VkCommandPool pool_ = VK_NULL_HANDLE;
        VkFence fence_ = VK_NULL_HANDLE;
        VkQueryPool queries_ = VK_NULL_HANDLE;
        std::uint32_t query_count_ = 0;
        bool runs_ = false;
        std::vector<std::uint64_t> times_;
        std::vector<bool> stamped_;
    };

  private:
    Gpu(std::shared_ptr<VulkanInstance> instance, const VulkanDevice& info);
    void load_pipelines();
    void save_pipelines() const;

    const std::shared_ptr<VulkanInstance> instance_;
    const VulkanDevice info_;
    VkDevice device_ = VK_NULL_HANDLE;
    VkQueue queue_ = VK_NULL_HANDLE;
    VkPipelineLayout layout_ = VK_NULL_HANDLE;
    VkPipelineCache cache_ = VK_NULL_HANDLE;
    std::mutex queue_mutex_, kernel_mutex_;
    std::map<std::pair<std::string, std::vector<std::uint32_t>>, VkPipeline> pipelines_;
    std::unique_ptr<Commands> uploads_;
    std::unique_ptr<GpuBuffer> staging_;
    std::mutex upload_mutex_;
};

// The SPIR-V of a kernel of snell/vulkan/shaders/, compiled into this program.
std::span<const std::uint32_t> kernel_code(std::string_view name);

// Traces rays whose hits are known. Throws Error if the device finds others.
void test_gpu(std::shared_ptr<Gpu> gpu);

} // namespace snell
