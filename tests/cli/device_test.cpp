// Devices by the command line: what is listed, what renders, and what is said where there is none.
#include "program.h"

#include "snell/io/image/read.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <optional>

namespace snell::test {
namespace {

const std::vector<std::string> small = {"render", "cornell", "--size", "32x24", "--spp", "4"};

std::vector<std::string> with(std::vector<std::string> arguments, const std::vector<std::string>& more)
{
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
}

// A variable of the environment, for the life of this.
class Variable
{
  public:
    Variable(const char* name, const char* value) : name_(name)
    {
        if (const char* before = std::getenv(name)) before_ = before;
        setenv(name, value, 1);
    }
    ~Variable()
    {
        if (before_)
            setenv(name_, before_->c_str(), 1);
        else
            unsetenv(name_);
    }

  private:
    const char* const name_;
    std::optional<std::string> before_;
};

// Where nothing is to be left in the user's own cache.
Variable own_cache()
{
    const char* scratch = std::getenv("TEST_TMPDIR");
    return Variable("XDG_CACHE_HOME", scratch != nullptr ? scratch : "/tmp");
}

// The name of a device that is listed as usable, or nothing.
std::string usable_gpu(const std::string& list)
{
    for (std::size_t begin = 0; begin < list.size();) {
        const std::size_t end = list.find('\n', begin);
        const std::string line = list.substr(begin, end - begin);
        if (line.starts_with("gpu:") && line.ends_with(": usable")) return line.substr(0, line.find(' '));
        begin = end + 1;
    }
    return "";
}

// A Vulkan driver keeps 128 bytes for each instance and is unloaded before the leak sanitizer looks, so that they
// cannot be told from ours: five lines that make an instance and destroy it leak them as well.
static Variable without_leak_check()
{
    const char* before = std::getenv("ASAN_OPTIONS");
    return Variable("ASAN_OPTIONS", (std::string(before != nullptr ? before : "") + ":detect_leaks=0").c_str());
}

TEST(Device, ListOfWhatThereIs)
{
    const Variable options = without_leak_check();
    Program program;
    for (const std::vector<std::string>& arguments :
         {std::vector<std::string>{"--list-devices"}, {"render", "--list-devices"}, with(small, {"--list-devices"})}) {
        const Outcome outcome = program.run(arguments);
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        EXPECT_TRUE(outcome.out.starts_with("cpu ")) << outcome.out;
        EXPECT_GE(line_count(outcome.out), 2u);
        for (const char* word : {"thread", "instruction sets", "gpu"})
            EXPECT_NE(outcome.out.find(word), std::string::npos) << word;
        EXPECT_TRUE(program.files().empty());
    }
    EXPECT_EQ(program.run(with(small, {"--device", "cpu"})).code, 0);
    EXPECT_EQ(program.files(), std::vector<std::string>{"cornell.png"});
}

TEST(Device, WithoutADriverThereIsNoGpu)
{
    const Variable none("VK_DRIVER_FILES", "/nonexistent.json"), none_before("VK_ICD_FILENAMES", "/nonexistent.json");
    Program program;
    const Outcome list = program.run({"--list-devices"});
    EXPECT_EQ(list.code, 0);
    EXPECT_NE(list.out.find("gpu    none: "), std::string::npos) << list.out;
    for (const char* device : {"gpu", "gpu:0"}) {
        const Outcome outcome = program.run(with(small, {"--device", device}));
        EXPECT_EQ(outcome.code, 1);
        EXPECT_EQ(line_count(outcome.err), 1u) << outcome.err;
        EXPECT_TRUE(outcome.err.starts_with("snell: error: ")) << outcome.err;
        EXPECT_NE(outcome.err.find("--device cpu"), std::string::npos) << outcome.err;
        EXPECT_TRUE(program.files().empty());
    }
    const Outcome automatic = program.run(with(small, {"--device", "auto"}));
    EXPECT_EQ(automatic.code, 0) << automatic.err;
    EXPECT_NE(automatic.err.find("--device auto: cpu"), std::string::npos) << automatic.err;
}

TEST(Device, GpuRendersTheSamePicture)
{
    const Variable options = without_leak_check();
    const Variable cache = own_cache();
    Program program;
    const std::string gpu = usable_gpu(program.run({"--list-devices"}).out);
    if (gpu.empty()) GTEST_SKIP() << "there is no Vulkan device";
    EXPECT_EQ(program.run(with(small, {"-o", "cpu.exr"})).code, 0);
    const Outcome outcome = program.run(with(small, {"-o", "gpu.exr", "--device", gpu, "--stats", "-v"}));
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    for (const char* word : {"copied", "camera", "extend", "shade"})
        EXPECT_NE(outcome.err.find(word), std::string::npos) << word << " in " << outcome.err;
    const Picture a = read_picture(program.folder() / "cpu.exr"), b = read_picture(program.folder() / "gpu.exr");
    ASSERT_EQ(a.pixels.size(), b.pixels.size());
    std::size_t others = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i)
        for (int c = 0; c < 3; ++c)
            if (!(std::abs(a.pixels[i][c] - b.pixels[i][c]) <= 1e-3f * std::abs(a.pixels[i][c]) + 1e-5f)) {
                ++others;
                break;
            }
    EXPECT_LE(others, a.pixels.size() / 100);
    // A structure that no GPU traces is no reason to take another.
    const Outcome other = program.run(with(small, {"--device", gpu, "--accel", "embree"}));
    EXPECT_EQ(other.code, 1);
    EXPECT_NE(other.err.find("bvh8q"), std::string::npos) << other.err;
}

} // namespace
} // namespace snell::test
