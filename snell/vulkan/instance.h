// The Vulkan instance of this program and the devices it sees.
#pragma once

#include "snell/render/device.h"

#include <vulkan/vulkan.h>

#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace snell {

// Throws Error unless the result is VK_SUCCESS: what to do about it where there is something to do, else a message with
// the result's name. what: the call.
void check_vulkan(VkResult result, const char* what);

// Where the validation layers' messages go; off unless a program asks for them.
struct VulkanMessages
{
    std::mutex mutex;
    std::vector<std::string> texts;
};

// From now on, instances are created with the validation layers (core and synchronisation), and what they have to say
// is kept there. in_kernels: also checks of each address that a kernel reads or writes (GPU-assisted validation), which
// takes minutes to compile. For tests, before anything else uses Vulkan. Throws Error if the layers are not installed.
void validate_vulkan(std::shared_ptr<VulkanMessages> messages, bool in_kernels = false);

struct VulkanDevice
{
    VkPhysicalDevice handle = VK_NULL_HANDLE;
    std::uint32_t queue_family = 0; // that computes
    VkPhysicalDeviceProperties properties{};
    VkPhysicalDeviceMemoryProperties memory{};
    VkDeviceSize max_allocation = 0; // bytes
    bool has_timestamps = false;
    std::size_t buffer_margin = 0; // bytes behind each buffer
    GpuInfo info;
};

class VulkanInstance
{
  public:
    // The one that is in use, or a new one. Throws Error if there is no driver.
    static std::shared_ptr<VulkanInstance> get();
    ~VulkanInstance();
    VulkanInstance(const VulkanInstance&) = delete;
    VulkanInstance& operator=(const VulkanInstance&) = delete;

    const std::vector<VulkanDevice>& devices() const { return devices_; }

  private:
    VulkanInstance();
    VkInstance instance_ = VK_NULL_HANDLE;
    VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
    std::shared_ptr<VulkanMessages> messages_;
    std::vector<VulkanDevice> devices_;
};

} // namespace snell
