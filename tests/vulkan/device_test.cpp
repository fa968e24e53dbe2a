// Choosing devices, and what is said where one cannot be had.
#include "snell/render/integrator.h"
#include "snell/vulkan/gpu.h"
#include "tests/render/scenes.h"
#include "tests/vulkan/gpu_test.h"

namespace snell::test {
namespace {

std::string message_of(const std::function<void()>& body)
{
    try {
        body();
    } catch (const Error& error) {
        return error.what();
    }
    return "no error";
}

void expect_words(const std::string& text, std::initializer_list<const char*> words)
{
    for (const char* word : words) EXPECT_NE(text.find(word), std::string::npos) << word << " is not in: " << text;
}

TEST(GpuDevice, Names)
{
    for (const char* name : {"cpu", "gpu", "gpu:0", "gpu:12", "auto"}) EXPECT_TRUE(is_device_name(name)) << name;
    for (const char* name : {"", "CPU", "gpu:", "gpu:x", "gpu:01", "gpu:-1", "gpu:1234", "gpu1", "vulkan"})
        EXPECT_FALSE(is_device_name(name)) << name;
    EXPECT_EQ(choose_device("cpu").device, "cpu");
}

TEST(GpuDevice, IsListedWithWhatItIs)
{
    SNELL_NEEDS_GPU();
    const GpuList list = list_gpus();
    EXPECT_EQ(list.problem, "");
    for (const GpuInfo& gpu : list.gpus) {
        EXPECT_TRUE(gpu.device.starts_with("gpu:"));
        EXPECT_FALSE(gpu.title.empty() || gpu.type.empty() || gpu.driver.empty());
        EXPECT_GT(gpu.memory_bytes, 0u);
    }
    EXPECT_EQ(choose_device(test_device()).device, test_device());
    EXPECT_TRUE(choose_device("gpu").device.starts_with("gpu:"));
    const DeviceChoice automatic = choose_device("auto");
    EXPECT_FALSE(automatic.reason.empty());
    expect_words(message_of([] { choose_device("gpu:99"); }), {"gpu:99", "--list-devices"});
}

TEST(GpuDevice, SaysWhatItCannotDo)
{
    SNELL_NEEDS_GPU();
    register_integrator("gpu-test-custom", "for this test", [](const RayScene&, const Ray&, SampleStream&) {
        return vec3(1.0f);
    });
    RenderSettings settings = small_picture("gpu-test-custom");
    settings.device = test_device();
    expect_words(message_of([&] { render(mixed_scene(), settings); }), {"gpu-test-custom", "--device cpu"});
    settings = small_picture("path");
    settings.device = test_device();
    settings.accel = "bvh8";
    expect_words(message_of([&] { render(mixed_scene(), settings); }), {"bvh8q", "bvh2"});
    settings.accel = "";
    settings.device = "gpu:99";
    expect_words(message_of([&] { render(mixed_scene(), settings); }), {"gpu:99"});
}

TEST(GpuDevice, SaysHowMuchMemoryIsMissing)
{
    SNELL_NEEDS_GPU();
    const std::shared_ptr<Gpu> gpu = Gpu::open(test_device());
    const std::size_t bytes = static_cast<std::size_t>(gpu->info().info.memory_bytes) + (std::size_t{1} << 20);
    expect_words(message_of([&] { GpuBuffer(*gpu, bytes, GpuBuffer::Placement::device, "this test"); }),
                 {"this test", "MiB", "--device cpu"});
}

TEST(GpuDevice, IsSharedByAllWhoUseIt)
{
    SNELL_NEEDS_GPU();
    const std::shared_ptr<Gpu> gpu = Gpu::open(test_device());
    EXPECT_EQ(gpu, Gpu::open(test_device()));
    EXPECT_EQ(gpu->kernel("arrange").pipeline, gpu->kernel("arrange").pipeline);
}

} // namespace
} // namespace snell::test
