#include "devices.h"

#include "console.h"
#include "usage.h"

#include "snell/core/parallel.h"
#include "snell/core/version.h"
#include "snell/render/device.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <fstream>

namespace snell::app {

static std::string processor_name()
{
    std::ifstream stream("/proc/cpuinfo");
    std::string line;
    while (std::getline(stream, line))
        if (const std::size_t colon = line.find(": "); line.starts_with("model name") && colon != std::string::npos)
            return line.substr(colon + 2);
    return "processor"; // not every architecture has a name there
}

void print_devices()
{
    const int threads = thread_count();
    fmt::print("cpu    {}, {} thread{}, instruction sets {}\n", processor_name(), threads, threads == 1 ? "" : "s",
               fmt::join(instruction_sets(), " "));
    const GpuList list = list_gpus();
    for (const GpuInfo& gpu : list.gpus)
        fmt::print("{}  {}, {}, {:.1f} GiB, {}: {}\n", gpu.device, gpu.title, gpu.type,
                   static_cast<double>(gpu.memory_bytes) / 0x1p30, gpu.driver,
                   gpu.refusal.empty() ? "usable" : "cannot be used: " + gpu.refusal);
    if (!list.problem.empty()) fmt::print("gpu    none: {}\n", list.problem);
}

void check_device(const std::string& name)
{
    if (!is_device_name(name))
        throw UsageError(fmt::format(
            "--device: there is no device '{}'; it is cpu, gpu, gpu:N or auto, see `snell --list-devices`", name));
}

std::string settle_device(const std::string& name)
{
    const DeviceChoice choice = choose_device(name);
    if (name == "auto") console().info("--device auto: " + choice.reason);
    return choice.device;
}

} // namespace snell::app
