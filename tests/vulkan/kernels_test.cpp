// With SNELL_TEST_KERNELS=1: each address that kernels read or write is checked while the other tests run. Here: that
// it is.
#include "snell/vulkan/gpu.h"
#include "snell/vulkan/shaders/job.h"
#include "tests/vulkan/gpu_test.h"

namespace snell::test {
namespace {

TEST(GpuKernels, AreWatchedForAddressesOutOfBounds)
{
    SNELL_NEEDS_GPU();
    if (!kernels_are_checked()) GTEST_SKIP() << "SNELL_TEST_KERNELS is not 1";
    Gpu& gpu = *Gpu::open(test_device());
    const GpuBuffer job_buffer(gpu, sizeof(GpuJob), GpuBuffer::Placement::device, "a test");
    const GpuBuffer too_small(gpu, 16, GpuBuffer::Placement::device, "a test");
    static_assert(sizeof(GpuCounters) > 16 + 64); // more than the buffer and what lies behind it
    GpuJob job{};
    job.counters.address = too_small.address;
    gpu.upload(job_buffer, 0, &job, sizeof(job));
    GpuPush push{};
    push.job.address = job_buffer.address;
    EXPECT_EQ(take_validation_messages().size(), 0u) << "said before this test";
    Gpu::Commands commands(gpu);
    commands.begin();
    commands.bind(gpu.kernel("arrange"));
    commands.push(&push, sizeof(push));
    commands.dispatch(1);
    commands.run();
    const std::vector<std::string> texts = take_validation_messages();
    ASSERT_EQ(texts.size(), 1u);
    EXPECT_NE(texts[0].find("out of bounds"), std::string::npos) << texts[0];
}

} // namespace
} // namespace snell::test
