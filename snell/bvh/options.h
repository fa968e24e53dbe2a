// AccelOptions as people give them: -D key=value.
#pragma once

#include "snell/bvh/accel.h"

namespace snell {

// The keys, each "name=default  what it does".
std::span<const std::string> accel_parameters();
bool is_accel_parameter(std::string_view key);

// Takes its own keys from `parameters` and leaves the others alone; what they do not say is as in `base`. Throws Error
// for a value that makes no sense.
AccelOptions read_accel_options(const std::map<std::string, std::string>& parameters, AccelOptions base = {});

} // namespace snell
