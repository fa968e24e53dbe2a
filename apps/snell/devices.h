// What `--device` can choose from: the processor, and GPUs.
#pragma once

#include <string>

namespace snell::app {

// One line for each device: its name for --device, then what it is, and why it cannot be used where that is so.
void print_devices();

// Throws UsageError, saying what names there are, unless it is the name of a device, there or not.
void check_device(const std::string& name);

// "cpu" or "gpu:N": the device that a name stands for. Says what `auto` has chosen, and why. Throws Error if there is
// no such device.
std::string settle_device(const std::string& name);

} // namespace snell::app
