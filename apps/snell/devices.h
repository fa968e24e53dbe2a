// What `--device` can choose from: so far the processor alone.
#pragma once

#include <string>

namespace snell::app {

// One line for each device: its name for --device, then what it is.
void print_devices();

// Throws UsageError, saying what there is, unless it is the name of a device.
void check_device(const std::string& name);

} // namespace snell::app
