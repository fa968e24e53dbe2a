#include "snell/vulkan/instance.h"

#include "snell/core/error.h"

#include <algorithm>
#include <cstring>

namespace snell {

namespace {
constexpr const char* validation_layer = "VK_LAYER_KHRONOS_validation";
// The layers (1.3.239) call the last struct of a full buffer out of bounds, such as the last of nine rays of 32 bytes
// in 288. With 64 bytes behind it they do not.
constexpr std::size_t checked_margin = 64;
constexpr const char* install_driver =
    "install the driver of your GPU, or mesa-vulkan-drivers, which runs on any processor; or use --device cpu";

std::mutex instance_mutex; // of the three that follow
std::weak_ptr<VulkanInstance> current_instance;
std::shared_ptr<VulkanMessages> wanted_messages;
bool checks_kernels = false;

const char* result_name(VkResult result)
{
    switch (result) {
    case VK_ERROR_OUT_OF_HOST_MEMORY:
        return "out of host memory";
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
        return "out of device memory";
    case VK_ERROR_INITIALIZATION_FAILED:
        return "initialization failed";
    case VK_ERROR_DEVICE_LOST:
        return "device lost";
    case VK_ERROR_LAYER_NOT_PRESENT:
        return "layer not present";
    case VK_ERROR_EXTENSION_NOT_PRESENT:
        return "extension not present";
    case VK_ERROR_FEATURE_NOT_PRESENT:
        return "feature not present";
    case VK_ERROR_INCOMPATIBLE_DRIVER:
        return "incompatible driver";
    case VK_ERROR_TOO_MANY_OBJECTS:
        return "too many objects";
    default:
        return nullptr;
    }
}

VKAPI_ATTR VkBool32 VKAPI_CALL keep_message(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                                            const VkDebugUtilsMessengerCallbackDataEXT* data, void* user)
{
    auto& messages = *static_cast<VulkanMessages*>(user);
    const std::lock_guard lock(messages.mutex);
    messages.texts.emplace_back(data->pMessage);
    return VK_FALSE;
}

VkDebugUtilsMessengerCreateInfoEXT messenger_info(VulkanMessages& messages)
{
    VkDebugUtilsMessengerCreateInfoEXT info{};
    info.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT;
    info.messageSeverity =
        VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
    info.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT;
    info.pfnUserCallback = keep_message;
    info.pUserData = &messages;
    return info;
}

template <class Function>
Function find_function(VkInstance instance, const char* name)
{
    return reinterpret_cast<Function>(vkGetInstanceProcAddr(instance, name));
}

const char* type_name(VkPhysicalDeviceType type)
{
    switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
        return "discrete GPU";
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
        return "integrated GPU";
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
        return "virtual GPU";
    case VK_PHYSICAL_DEVICE_TYPE_CPU:
        return "CPU";
    default:
        return "other";
    }
}

// Fills in the queue family; false: the device has none that computes.
bool find_queue(VulkanDevice& device)
{
    std::uint32_t count = 0;
    vkGetPhysicalDeviceQueueFamilyProperties(device.handle, &count, nullptr);
    std::vector<VkQueueFamilyProperties> families(count);
    vkGetPhysicalDeviceQueueFamilyProperties(device.handle, &count, families.data());
    for (std::uint32_t i = 0; i < count; ++i) {
        if (!(families[i].queueFlags & VK_QUEUE_COMPUTE_BIT)) continue;
        device.queue_family = i;
        device.has_timestamps = families[i].timestampValidBits > 0 && device.properties.limits.timestampPeriod > 0;
        return true;
    }
    return false;
}

// Why the device cannot be used, or nothing.
std::string find_refusal(VulkanDevice& device)
{
    if (device.properties.apiVersion < VK_API_VERSION_1_2)
        return fmt::format("its driver has Vulkan {}.{}, and 1.2 is needed",
                           VK_API_VERSION_MAJOR(device.properties.apiVersion),
                           VK_API_VERSION_MINOR(device.properties.apiVersion));
    VkPhysicalDeviceVulkan12Features features{};
    features.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES;
    VkPhysicalDeviceFeatures2 all{};
    all.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2;
    all.pNext = &features;
    vkGetPhysicalDeviceFeatures2(device.handle, &all);
    VkPhysicalDeviceSubgroupProperties subgroups{};
    subgroups.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES;
    VkPhysicalDeviceProperties2 properties{};
    properties.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2;
    properties.pNext = &subgroups;
    vkGetPhysicalDeviceProperties2(device.handle, &properties);

    std::string missing;
    const auto need = [&](bool there, const char* name) {
        if (!there) missing += (missing.empty() ? "" : ", ") + std::string(name);
    };
    need(features.bufferDeviceAddress, "bufferDeviceAddress");
    need(features.scalarBlockLayout, "scalarBlockLayout");
    need((subgroups.supportedStages & VK_SHADER_STAGE_COMPUTE_BIT) != 0 &&
             (subgroups.supportedOperations & VK_SUBGROUP_FEATURE_BALLOT_BIT) != 0,
         "subgroup ballots in compute shaders");
    need(find_queue(device), "a queue that computes");
    return missing.empty() ? "" : "it lacks " + missing;
}

VulkanDevice look_at(VkPhysicalDevice handle, std::size_t number)
{
    VulkanDevice device;
    device.handle = handle;
    vkGetPhysicalDeviceProperties(handle, &device.properties);
    vkGetPhysicalDeviceMemoryProperties(handle, &device.memory);
    GpuInfo& info = device.info;
    info.device = fmt::format("gpu:{}", number);
    info.title = device.properties.deviceName;
    info.type = type_name(device.properties.deviceType);
    for (std::uint32_t i = 0; i < device.memory.memoryHeapCount; ++i)
        if (device.memory.memoryHeaps[i].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT)
            info.memory_bytes = std::max<std::uint64_t>(info.memory_bytes, device.memory.memoryHeaps[i].size);
    info.refusal = find_refusal(device);
    info.driver = "unknown";
    if (device.properties.apiVersion >= VK_API_VERSION_1_2) {
        VkPhysicalDeviceVulkan11Properties v11{};
        v11.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_PROPERTIES;
        VkPhysicalDeviceVulkan12Properties v12{};
        v12.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_PROPERTIES;
        v12.pNext = &v11;
        VkPhysicalDeviceProperties2 properties{};
        properties.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2;
        properties.pNext = &v12;
        vkGetPhysicalDeviceProperties2(handle, &properties);
        info.driver = fmt::format("{} {}", v12.driverName, v12.driverInfo);
        device.max_allocation = v11.maxMemoryAllocationSize;
    }
    return device;
}
} // namespace

void check_vulkan(VkResult result, const char* what)
{
    if (result == VK_SUCCESS) return;
    if (result == VK_ERROR_DEVICE_LOST)
        throw DeviceLost("the GPU has stopped answering (device lost)",
                         "try again; if it happens again, update its driver, or use --device cpu");
    if (result == VK_ERROR_OUT_OF_DEVICE_MEMORY || result == VK_ERROR_OUT_OF_HOST_MEMORY)
        throw Error(fmt::format("{} in {}", result_name(result), what),
                    "close what else uses the GPU, make the picture or the scene smaller, or use --device cpu");
    const char* name = result_name(result);
    throw Error(fmt::format("Vulkan: {} failed: {}", what,
                            name != nullptr ? name : fmt::format("VkResult {}", static_cast<int>(result))),
                "`snell --list-devices` shows what there is; --device cpu always works");
}

void validate_vulkan(std::shared_ptr<VulkanMessages> messages, bool in_kernels)
{
    std::uint32_t count = 0;
    check_vulkan(vkEnumerateInstanceLayerProperties(&count, nullptr), "vkEnumerateInstanceLayerProperties");
    std::vector<VkLayerProperties> layers(count);
    check_vulkan(vkEnumerateInstanceLayerProperties(&count, layers.data()), "vkEnumerateInstanceLayerProperties");
    if (std::none_of(layers.begin(), layers.end(),
                     [](const VkLayerProperties& layer) { return !std::strcmp(layer.layerName, validation_layer); }))
        throw Error("the Vulkan validation layer is not installed", "install the package vulkan-validationlayers");
    const std::lock_guard lock(instance_mutex);
    SNELL_CHECK_EQ(current_instance.expired(), true);
    wanted_messages = std::move(messages);
    checks_kernels = in_kernels;
}

std::shared_ptr<VulkanInstance> VulkanInstance::get()
{
    const std::lock_guard lock(instance_mutex);
    std::shared_ptr<VulkanInstance> instance = current_instance.lock();
    if (!instance) {
        instance.reset(new VulkanInstance);
        current_instance = instance;
    }
    return instance;
}

VulkanInstance::VulkanInstance() : messages_(wanted_messages)
{
    VkApplicationInfo application{};
    application.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO;
    application.pApplicationName = "snell";
    application.apiVersion = VK_API_VERSION_1_2;
    VkInstanceCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO;
    info.pApplicationInfo = &application;

    VkDebugUtilsMessengerCreateInfoEXT messenger{};
    const VkValidationFeatureEnableEXT checks[] = {VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT,
                                                   VK_VALIDATION_FEATURE_ENABLE_GPU_ASSISTED_EXT};
    VkValidationFeaturesEXT validation{};
    const char* extension = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
    if (messages_) {
        messenger = messenger_info(*messages_);
        validation.sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT;
        validation.pNext = &messenger;
        validation.enabledValidationFeatureCount = checks_kernels ? 2 : 1;
        validation.pEnabledValidationFeatures = checks;
        info.pNext = &validation;
        info.enabledLayerCount = 1;
        info.ppEnabledLayerNames = &validation_layer;
        info.enabledExtensionCount = 1;
        info.ppEnabledExtensionNames = &extension;
    }
    const VkResult result = vkCreateInstance(&info, nullptr, &instance_);
    if (result == VK_ERROR_INCOMPATIBLE_DRIVER) throw Error("there is no Vulkan driver", install_driver);
    check_vulkan(result, "vkCreateInstance");
    if (messages_) {
        const auto create =
            find_function<PFN_vkCreateDebugUtilsMessengerEXT>(instance_, "vkCreateDebugUtilsMessengerEXT");
        check_vulkan(create(instance_, &messenger, nullptr, &messenger_), "vkCreateDebugUtilsMessengerEXT");
    }
    std::uint32_t count = 0;
    check_vulkan(vkEnumeratePhysicalDevices(instance_, &count, nullptr), "vkEnumeratePhysicalDevices");
    std::vector<VkPhysicalDevice> handles(count);
    check_vulkan(vkEnumeratePhysicalDevices(instance_, &count, handles.data()), "vkEnumeratePhysicalDevices");
    for (const VkPhysicalDevice handle : handles) {
        devices_.push_back(look_at(handle, devices_.size()));
        if (messages_ && checks_kernels) devices_.back().buffer_margin = checked_margin;
    }
}

VulkanInstance::~VulkanInstance()
{
    if (messenger_)
        find_function<PFN_vkDestroyDebugUtilsMessengerEXT>(instance_, "vkDestroyDebugUtilsMessengerEXT")(
            instance_, messenger_, nullptr);
    if (instance_) vkDestroyInstance(instance_, nullptr);
}

GpuList list_gpus()
{
    GpuList list;
    try {
        const std::shared_ptr<VulkanInstance> instance = VulkanInstance::get();
        for (const VulkanDevice& device : instance->devices()) list.gpus.push_back(device.info);
        if (list.gpus.empty())
            list.problem = fmt::format("the Vulkan drivers of this machine find no device; {}", install_driver);
    } catch (const Error& error) {
        list.problem = error.what();
    }
    return list;
}

} // namespace snell
