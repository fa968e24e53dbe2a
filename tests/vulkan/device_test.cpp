// Choosing devices, and what is said where one cannot be had.
#include "snell/render/backend.h"
#include "snell/render/integrator.h"
#include "snell/vulkan/gpu.h"
#include "tests/render/scenes.h"
#include "tests/vulkan/gpu_test.h"

#include <cstring>

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
    register_integrator("gpu-test-custom", "for this test",
                        [](const RayScene&, const Ray&, SampleStream&) { return vec3(1.0f); });
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

// As on devices whose memory the host cannot see.
TEST(GpuDevice, TakesMoreThanOneCopyAtATime)
{
    SNELL_NEEDS_GPU();
    const std::shared_ptr<Gpu> gpu = Gpu::open(test_device());
    std::vector<std::uint32_t> words(9'000'000); // 36 MB: the staging buffer has 32
    for (std::size_t i = 0; i < words.size(); ++i) words[i] = static_cast<std::uint32_t>(2654435761u * i);
    const std::size_t bytes = words.size() * sizeof(std::uint32_t);
    const GpuBuffer there(*gpu, bytes + 64, GpuBuffer::Placement::device, "this test");
    const GpuBuffer back(*gpu, bytes, GpuBuffer::Placement::readback, "this test");
    gpu->upload_by_copy(there, 64, words.data(), bytes);
    Gpu::Commands commands(*gpu);
    commands.begin();
    const VkBufferCopy copy{64, 0, bytes};
    vkCmdCopyBuffer(commands.handle, there.handle, back.handle, 1, &copy);
    commands.run();
    EXPECT_EQ(std::memcmp(back.data, words.data(), bytes), 0);
}

namespace {
// A device that is lost in its second pass.
class FailingBackend final : public Backend
{
  public:
    void render_samples(const Region&, uint, uint count, Film& film, const std::function<bool()>&) override
    {
        if (stats_.samples >= works_for) check_vulkan(VK_ERROR_DEVICE_LOST, "vkQueueSubmit");
        for (std::size_t pixel = 0; pixel < film.sum.size(); ++pixel)
            for (uint i = 0; i < count; ++i) film.add_sample(pixel, vec3(0.5f));
        stats_.samples += film.sum.size() * count;
    }
    RenderStats stats() const override { return stats_; }
    std::uint64_t works_for = 1;

  private:
    RenderStats stats_;
};

class FailingDevice final : public DeviceScene
{
  public:
    explicit FailingDevice(std::uint64_t works_for) : works_for_(works_for) {}
    std::unique_ptr<Backend> make_backend(const BackendJob&) override
    {
        auto backend = std::make_unique<FailingBackend>();
        backend->works_for = works_for_;
        return backend;
    }
    void update(const PackedChanges&) override {}
    std::string title() const override { return "failing"; }
    std::size_t bytes() const override { return 0; }

  private:
    const std::uint64_t works_for_;
};
} // namespace

TEST(GpuDevice, WhatALostDeviceHasGivenIsKept)
{
    RenderSettings settings = small_picture("path");
    settings.layers = false;
    settings.spp = 64;
    const auto prepared = prepare(mixed_scene(), settings);
    prepared->device = std::make_unique<FailingDevice>(1);
    const RenderResult result = render(*prepared, settings);
    expect_words(result.lost, {"device lost", "--device cpu"});
    EXPECT_TRUE(result.stats.cancelled);
    EXPECT_EQ(result.film.sample_count.front(), 8u); // of the first pass
    prepared->device = std::make_unique<FailingDevice>(0);
    EXPECT_THROW(render(*prepared, settings), DeviceLost);
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
