// What the tests of the GPU backend share: the device that they run on.
#pragma once

#include "snell/core/error.h"
#include "snell/render/render.h"
#include "snell/vulkan/instance.h"

#include <gtest/gtest.h>

namespace snell::test {

// The device of the tests, "gpu:N": lavapipe, or the one that has SNELL_TEST_GPU in its name. Empty: there is none, and
// the reason was said.
const std::string& test_device();

// What the validation layers have said so far.
const VulkanMessages& validation_messages();

// The same, which then are no failure of the tests.
std::vector<std::string> take_validation_messages();

// The layers also check what kernels do: SNELL_TEST_KERNELS is 1.
bool kernels_are_checked();

// In tests with no device to run on.
#define SNELL_NEEDS_GPU()                                                                                              \
    if (test_device().empty()) GTEST_SKIP() << "there is no Vulkan device"

// lavapipe rounds as IEEE 754 has it, and so gives the CPU's bits where the kernels only add, multiply, divide and take
// roots.
bool rounds_exactly();

} // namespace snell::test
