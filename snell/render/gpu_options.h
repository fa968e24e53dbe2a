// How a GPU goes about its work, as people give it: -D key=value. Pictures do not depend on it.
#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>

namespace snell {

struct GpuOptions
{
    bool sorts_by_material = false; // neighbouring invocations of the shade kernel have materials of one kind
    bool takes_blocks = false;      // a fixed number of workgroups fetches rays until there are no more
};

// The keys, each "name=default  what it does".
std::span<const std::string> gpu_parameters();
bool is_gpu_parameter(std::string_view key);

// Takes its own keys from `parameters` and leaves the others alone. Throws Error for a value that makes no sense.
GpuOptions read_gpu_options(const std::map<std::string, std::string>& parameters);

} // namespace snell
