#include "snell/render/gpu_options.h"

#include "snell/core/error.h"

#include <array>

namespace snell {

static const std::array<std::string, 2> keys = {
    "gpu_sort=none  none, or material: paths are shaded in the order of their materials' kinds",
    "gpu_trace=stage  stage: as many workgroups as there are rays for; persistent: a fixed number that fetch rays",
};

std::span<const std::string> gpu_parameters()
{
    return keys;
}

bool is_gpu_parameter(std::string_view key)
{
    for (const std::string& line : keys)
        if (std::string_view(line).substr(0, line.find('=')) == key) return true;
    return false;
}

// True: `yes`.
static bool read_choice(const std::string& key, const std::string& text, const char* no, const char* yes)
{
    if (text != no && text != yes) throw Error(fmt::format("-D {}={} is neither {} nor {}", key, text, no, yes));
    return text == yes;
}

GpuOptions read_gpu_options(const std::map<std::string, std::string>& parameters)
{
    GpuOptions options;
    for (const auto& [key, text] : parameters) {
        if (key == "gpu_sort")
            options.sorts_by_material = read_choice(key, text, "none", "material");
        else if (key == "gpu_trace")
            options.takes_blocks = read_choice(key, text, "stage", "persistent");
    }
    return options;
}

} // namespace snell
