// The tests run with the validation layers on, and fail if those have anything to say.
#include "snell/vulkan/gpu.h"
#include "tests/vulkan/gpu_test.h"

#include <cstdio>
#include <cstdlib>
#include <utility>

namespace snell::test {

static std::shared_ptr<VulkanMessages> messages = std::make_shared<VulkanMessages>();
static std::string device, device_title;
static bool checks_kernels = false;

const std::string& test_device()
{
    return device;
}

const VulkanMessages& validation_messages()
{
    return *messages;
}

std::vector<std::string> take_validation_messages()
{
    const std::lock_guard lock(messages->mutex);
    return std::exchange(messages->texts, {});
}

bool kernels_are_checked()
{
    return checks_kernels;
}

// Without the layers nothing is checked, which is said.
static void start_validation()
{
    const char* wanted = std::getenv("SNELL_TEST_KERNELS");
    const bool in_kernels = wanted != nullptr && std::string(wanted) == "1";
    try {
        validate_vulkan(messages, in_kernels);
        checks_kernels = in_kernels;
    } catch (const Error& error) {
        std::printf("%s\n", error.what());
    }
}

bool rounds_exactly()
{
    return device_title.find("llvmpipe") != std::string::npos;
}

static void choose_test_device()
{
    const char* wanted = std::getenv("SNELL_TEST_GPU");
    const std::string part = wanted != nullptr ? wanted : "llvmpipe";
    const GpuList list = list_gpus();
    for (const GpuInfo& gpu : list.gpus) {
        if (gpu.title.find(part) == std::string::npos || !gpu.refusal.empty()) continue;
        device = gpu.device;
        device_title = gpu.title;
        return;
    }
    std::printf("No Vulkan device \"%s\" that can be used: the tests of the GPU backend are skipped. %s\n",
                part.c_str(), list.problem.c_str());
}

// The device stays open from the first test to the last: each kernel is then compiled once.
class OneDevice : public testing::Environment
{
    std::shared_ptr<Gpu> gpu_;

    void SetUp() override
    {
        if (!device.empty()) gpu_ = Gpu::open(device);
    }
    void TearDown() override
    {
        gpu_.reset(); // what is left behind would be said now
        const std::lock_guard lock(messages->mutex);
        for (const std::string& text : messages->texts) ADD_FAILURE() << "the validation layers say: " << text;
    }
};

} // namespace snell::test

int main(int argc, char** argv)
{
    testing::InitGoogleTest(&argc, argv);
    if (const char* scratch = std::getenv("TEST_TMPDIR")) // what is cached for the tests is no user's
        setenv("XDG_CACHE_HOME", scratch, 1);
    snell::test::start_validation();
    snell::test::choose_test_device();
    testing::AddGlobalTestEnvironment(new snell::test::OneDevice);
    return RUN_ALL_TESTS();
}
