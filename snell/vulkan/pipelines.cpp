// Kernels: the compiled ones, and the cache that drivers fill, which is kept in the user's cache folder.
#include "snell/core/error.h"
#include "snell/core/hash.h"
#include "snell/vulkan/gpu.h"
#include "snell/vulkan/spirv.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>

#include <unistd.h>

namespace snell {

namespace {
struct Kernel
{
    std::string_view name;
    std::span<const std::uint32_t> code;
};

#include "snell_vulkan_kernels.inc"

// $XDG_CACHE_HOME/snell, else ~/.cache/snell; empty: there is no such place.
std::filesystem::path cache_folder()
{
    if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache != nullptr && *cache == '/')
        return std::filesystem::path(cache) / "snell";
    if (const char* home = std::getenv("HOME"); home != nullptr && *home == '/')
        return std::filesystem::path(home) / ".cache" / "snell";
    return {};
}

// One file for each driver of each device.
std::filesystem::path cache_file(const VkPhysicalDeviceProperties& p)
{
    const std::filesystem::path folder = cache_folder();
    if (folder.empty()) return {};
    const Hash128 who = hash_bytes(p.pipelineCacheUUID, sizeof(p.pipelineCacheUUID), p.driverVersion);
    return folder / fmt::format("pipelines-{:x}-{:x}-{}.bin", p.vendorID, p.deviceID, to_hex(who));
}

// A file is the hash of what follows, and that: drivers need not survive what a full disk has left of their data.
std::vector<char> read_cache(const std::filesystem::path& path)
{
    std::ifstream file(path, std::ios::binary);
    std::vector<char> bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    Hash128 hash;
    if (bytes.size() < sizeof(hash)) return {};
    std::memcpy(&hash, bytes.data(), sizeof(hash));
    bytes.erase(bytes.begin(), bytes.begin() + sizeof(hash));
    return hash_bytes(bytes.data(), bytes.size()) == hash ? bytes : std::vector<char>();
}

// What cannot be written is not: the next start takes longer, that is all.
void write_cache(const std::filesystem::path& path, const std::vector<char>& bytes)
{
    std::error_code ignored;
    std::filesystem::create_directories(path.parent_path(), ignored);
    std::filesystem::path fresh = path;
    fresh += fmt::format(".{}", ::getpid()); // others may be writing theirs
    {
        std::ofstream file(fresh, std::ios::binary);
        const Hash128 hash = hash_bytes(bytes.data(), bytes.size());
        file.write(reinterpret_cast<const char*>(&hash), sizeof(hash));
        file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
        if (!file.good()) {
            file.close();
            std::filesystem::remove(fresh, ignored);
            return;
        }
    }
    std::filesystem::rename(fresh, path, ignored);
    if (ignored) std::filesystem::remove(fresh, ignored);
}
} // namespace

// Kernels that are ready for some scene, one file each; all of them go when there are many.
constexpr std::size_t most_kept_kernels = 512;
constexpr std::uint64_t kept_format = 1; // to be raised when they are made ready otherwise

// A kernel as drivers get it. is_final: its constants have their values.
static std::vector<std::uint32_t> ready_code(std::string_view name, const std::vector<std::uint32_t>& constants,
                                             bool& is_final)
{
    const std::span<const std::uint32_t> words = kernel_code(name);
    Hash128 hash = hash_bytes(words.data(), words.size_bytes());
    hash = hash_bytes(constants.data(), constants.size() * sizeof(constants[0]), hash.low ^ hash.high ^ kept_format);
    const std::filesystem::path folder = cache_folder();
    const std::filesystem::path path = folder.empty() ? folder : folder / "kernels" / (to_hex(hash) + ".spv");
    is_final = true;
    if (!path.empty())
        if (const std::vector<char> bytes = read_cache(path); !bytes.empty()) {
            std::vector<std::uint32_t> code(bytes.size() / sizeof(std::uint32_t));
            std::memcpy(code.data(), bytes.data(), code.size() * sizeof(std::uint32_t));
            return code;
        }
    // Kernels round as they are written, on every device: hits and pictures are then as near to the CPU's as can be,
    // and neighbouring triangles agree about their common vertices.
    std::vector<std::uint32_t> code =
        without_unrolling(with_no_contraction(std::vector<std::uint32_t>(words.begin(), words.end())));
    std::vector<std::uint32_t> final_code = specialised(code, constants);
    is_final = !final_code.empty();
    if (!is_final) return code;
    if (!path.empty()) {
        std::error_code ignored;
        std::size_t kept = 0;
        for ([[maybe_unused]] const auto& file : std::filesystem::directory_iterator(path.parent_path(), ignored))
            ++kept;
        if (kept >= most_kept_kernels) std::filesystem::remove_all(path.parent_path(), ignored);
        const auto* data = reinterpret_cast<const char*>(final_code.data());
        write_cache(path, std::vector<char>(data, data + final_code.size() * sizeof(std::uint32_t)));
    }
    return final_code;
}

std::span<const std::uint32_t> kernel_code(std::string_view name)
{
    for (const Kernel& kernel : kernels)
        if (kernel.name == name) return kernel.code;
    fail_check(__FILE__, __LINE__, fmt::format("there is no kernel {}", name));
}

void Gpu::load_pipelines()
{
    const std::filesystem::path path = cache_file(info_.properties);
    const std::vector<char> bytes = path.empty() ? std::vector<char>() : read_cache(path);
    VkPipelineCacheCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO;
    info.initialDataSize = bytes.size();
    info.pInitialData = bytes.data();
    check_vulkan(vkCreatePipelineCache(device_, &info, nullptr, &cache_), "vkCreatePipelineCache");
}

void Gpu::save_pipelines() const
{
    const std::filesystem::path path = cache_file(info_.properties);
    std::size_t size = 0;
    if (path.empty() || vkGetPipelineCacheData(device_, cache_, &size, nullptr) != VK_SUCCESS || size == 0) return;
    std::vector<char> bytes(size);
    if (vkGetPipelineCacheData(device_, cache_, &size, bytes.data()) != VK_SUCCESS) return;
    bytes.resize(size);
    write_cache(path, bytes);
}

GpuKernel Gpu::kernel(std::string_view name, const std::vector<std::uint32_t>& constants)
{
    const std::lock_guard lock(kernel_mutex_);
    VkPipeline& pipeline = pipelines_[{std::string(name), constants}];
    if (pipeline != VK_NULL_HANDLE) return {pipeline};

    bool is_final = false;
    const std::vector<std::uint32_t> code = ready_code(name, constants, is_final);
    VkShaderModuleCreateInfo module_info{};
    module_info.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO;
    module_info.codeSize = code.size() * sizeof(std::uint32_t);
    module_info.pCode = code.data();
    VkShaderModule module = VK_NULL_HANDLE;
    check_vulkan(vkCreateShaderModule(device_, &module_info, nullptr, &module), "vkCreateShaderModule");

    std::vector<VkSpecializationMapEntry> entries;
    for (std::uint32_t i = 0; i < constants.size(); ++i)
        entries.push_back({i, i * static_cast<std::uint32_t>(sizeof(std::uint32_t)), sizeof(std::uint32_t)});
    const VkSpecializationInfo specialization{static_cast<std::uint32_t>(entries.size()), entries.data(),
                                              constants.size() * sizeof(std::uint32_t), constants.data()};
    VkComputePipelineCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO;
    info.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
    info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
    info.stage.module = module;
    info.stage.pName = "main";
    info.stage.pSpecializationInfo = is_final || constants.empty() ? nullptr : &specialization;
    info.layout = layout_;
    const VkResult result = vkCreateComputePipelines(device_, cache_, 1, &info, nullptr, &pipeline);
    vkDestroyShaderModule(device_, module, nullptr);
    check_vulkan(result, "vkCreateComputePipelines");
    save_pipelines();
    return {pipeline};
}

} // namespace snell
