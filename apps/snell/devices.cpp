#include "devices.h"

#include "usage.h"

#include "snell/core/parallel.h"
#include "snell/core/version.h"

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
    fmt::print("cpu  {}, {} thread{}, instruction sets {}\n", processor_name(), threads, threads == 1 ? "" : "s",
               fmt::join(instruction_sets(), " "));
}

void check_device(const std::string& name)
{
    if (name != "cpu")
        throw UsageError(
            fmt::format("--device: there is no device '{}'; this version renders on the CPU only, --device cpu", name));
}

} // namespace snell::app
