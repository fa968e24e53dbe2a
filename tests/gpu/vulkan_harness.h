// The least of Vulkan that runs compute shaders on buffers: one device, one queue, buffers by address.
#pragma once

#include <vulkan/vulkan.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace snell::test {

// Memory that both the host (at data) and shaders (at address) see.
class GpuBuffer
{
  public:
    GpuBuffer(VkDevice device, const VkPhysicalDeviceMemoryProperties& types, std::size_t bytes);
    ~GpuBuffer();
    GpuBuffer(const GpuBuffer&) = delete;
    GpuBuffer& operator=(const GpuBuffer&) = delete;

    void* data = nullptr;
    VkDeviceAddress address = 0;
    const std::size_t bytes;

  private:
    VkDevice device;
    VkBuffer buffer = VK_NULL_HANDLE;
    VkDeviceMemory memory = VK_NULL_HANDLE;
};

// A compute shader with entry point main and push constants, no descriptors.
class GpuKernel
{
  public:
    // constant: of the shader's specialization constant 0.
    GpuKernel(VkDevice device, const std::vector<std::uint32_t>& spirv, std::size_t push_bytes, std::uint32_t constant);
    ~GpuKernel();
    GpuKernel(const GpuKernel&) = delete;
    GpuKernel& operator=(const GpuKernel&) = delete;

    VkPipeline pipeline = VK_NULL_HANDLE;
    VkPipelineLayout layout = VK_NULL_HANDLE;
    const std::size_t push_bytes;

  private:
    VkDevice device;
    VkShaderModule module = VK_NULL_HANDLE;
};

// Throws Error if the file cannot be read.
std::vector<std::uint32_t> read_spirv(const std::string& path);

class Gpu
{
  public:
    // Opens the first device whose name contains name_part, with the Khronos validation layer on. Throws Error with the
    // names of all devices if there is none, and if the layer is not installed.
    //   messages  gets what the layer has to say, warnings and errors; must outlive the Gpu
    Gpu(const std::string& name_part, std::vector<std::string>& messages);
    ~Gpu();
    Gpu(const Gpu&) = delete;
    Gpu& operator=(const Gpu&) = delete;

    std::string name() const { return device_name; }
    std::unique_ptr<GpuBuffer> make_buffer(std::size_t bytes) const;
    std::unique_ptr<GpuKernel> make_kernel(const std::vector<std::uint32_t>& spirv, std::size_t push_bytes,
                                           std::uint32_t constant) const;
    // Runs the kernel on that many work groups and waits until the host sees what it wrote. push points to push_bytes.
    void run(const GpuKernel& kernel, const void* push, std::uint32_t groups) const;

  private:
    void create_instance();
    void choose_device(const std::string& name_part);
    void create_device();

    VkInstance instance = VK_NULL_HANDLE;
    VkDebugUtilsMessengerEXT messenger = VK_NULL_HANDLE;
    VkPhysicalDevice physical = VK_NULL_HANDLE;
    VkPhysicalDeviceMemoryProperties memory_types{};
    VkDevice device = VK_NULL_HANDLE;
    VkQueue queue = VK_NULL_HANDLE;
    VkCommandPool pool = VK_NULL_HANDLE;
    std::string device_name;
    std::vector<std::string>& validation_messages;
};

} // namespace snell::test
