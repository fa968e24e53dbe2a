#include "snell/render/device.h"

#include "snell/core/error.h"

#include <algorithm>
#include <array>

namespace snell {

bool is_device_name(const std::string& name)
{
    if (name == "cpu" || name == "gpu" || name == "auto") return true;
    const std::string number = name.starts_with("gpu:") ? name.substr(4) : "";
    return !number.empty() && number.size() <= 3 && number.find_first_not_of("0123456789") == std::string::npos &&
           (number == "0" || number[0] != '0');
}

std::span<const std::string_view> gpu_accels()
{
    static constexpr std::array<std::string_view, 2> names = {"bvh8q", "bvh2"};
    return names;
}

// The best GPU that can be used; nullptr: none.
static const GpuInfo* best_of(const std::vector<GpuInfo>& gpus)
{
    static constexpr std::array order = {"discrete GPU", "integrated GPU", "virtual GPU", "CPU", "other"};
    for (const char* type : order)
        for (const GpuInfo& gpu : gpus)
            if (gpu.type == type && gpu.refusal.empty()) return &gpu;
    return nullptr;
}

static std::string described(const GpuInfo& gpu)
{
    return fmt::format("{}, {} ({})", gpu.device, gpu.title, gpu.type);
}

DeviceChoice choose_device(const std::string& name)
{
    if (name == "cpu") return {"cpu", "as asked for"};
    const GpuList list = list_gpus();
    const GpuInfo* best = best_of(list.gpus);
    if (name == "auto") {
        if (best != nullptr && best->type == "discrete GPU") return {best->device, described(*best)};
        std::string reason = !list.problem.empty() ? list.problem
                             : best != nullptr     ? fmt::format("the best GPU is {}", described(*best))
                                                   : "no GPU here can be used";
        return {"cpu", "cpu: there is no discrete GPU (" + reason + ")"};
    }
    if (!list.problem.empty()) throw Error(list.problem);
    if (name == "gpu") {
        if (best != nullptr) return {best->device, described(*best)};
        const GpuInfo& gpu = list.gpus.front();
        throw Error(fmt::format("no GPU here can be used; {}: {}", described(gpu), gpu.refusal),
                    "`snell --list-devices` shows all of them; --device cpu always works");
    }
    for (const GpuInfo& gpu : list.gpus) {
        if (gpu.device != name) continue;
        if (!gpu.refusal.empty())
            throw Error(fmt::format("{} cannot be used: {}", described(gpu), gpu.refusal),
                        "update its driver, or use another device of `snell --list-devices`");
        return {gpu.device, described(gpu)};
    }
    throw Error(fmt::format("there is no device {}; the last one is gpu:{}", name, list.gpus.size() - 1),
                "`snell --list-devices` shows what there is");
}

} // namespace snell
