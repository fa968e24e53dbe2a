// Runs every case of tests/gpu/cases in C++ and on the GPU on the same inputs and compares the results word by word.
#include "snell/core/error.h"
#include "snell/vulkan/spirv.h"
#include "tests/gpu/twin.h"
#include "tests/gpu/twin_scene.h"
#include "tests/gpu/vulkan_harness.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <iostream>

namespace snell {
#define GROUP(name) void twin_group_##name();
#include "twin_groups.inc"
#undef GROUP
} // namespace snell

namespace snell::test {

namespace {
constexpr std::size_t items = 100'000;
constexpr std::size_t pattern_words = 1 << 16;

struct Group
{
    const char* name;
    void (*run)();
};
const Group groups[] = {
#define GROUP(name) {#name, twin_group_##name},
#include "twin_groups.inc"
#undef GROUP
};

// Matches TwinPush in twin.glsl.
struct Push
{
    VkDeviceAddress inputs, outputs, given, raw, scene;
    std::uint32_t count, input_words, output_words;
};

// The GPU, its scenes, and why there is none.
struct Machine
{
    std::string trouble;
    std::vector<std::string> messages; // of the validation layer
    std::unique_ptr<Gpu> gpu;
    SceneWords random = random_scene(), pattern = pattern_scene();
    std::unique_ptr<GpuScene> gpu_random, gpu_pattern;
    std::vector<std::uint32_t> raw;
    std::unique_ptr<GpuBuffer> gpu_raw;
};

std::unique_ptr<Machine> the_machine;

Machine& machine()
{
    if (!the_machine) the_machine = std::make_unique<Machine>();
    Machine& m = *the_machine;
    if (m.gpu || !m.trouble.empty()) return m;
    setenv("GALLIVM_PERF", "nopt", 0); // lavapipe spends nearly all of its time on compiling: a sixth less of it
    const char* wish = std::getenv("SNELL_TEST_GPU");
    try {
        m.gpu = std::make_unique<Gpu>(wish && *wish ? wish : "llvmpipe", m.messages);
    } catch (const Error& error) {
        m.trouble = error.what();
        return m;
    }
    m.gpu_random = std::make_unique<GpuScene>(*m.gpu, m.random);
    m.gpu_pattern = std::make_unique<GpuScene>(*m.gpu, m.pattern);
    m.raw.resize(pattern_words);
    for (std::size_t i = 0; i < pattern_words; ++i) m.raw[i] = pattern_word(i);
    m.gpu_raw = m.gpu->make_buffer(pattern_words * sizeof(std::uint32_t));
    std::memcpy(m.gpu_raw->data, m.raw.data(), m.gpu_raw->bytes);
    return m;
}

bool left_out()
{
    const char* no = std::getenv("SNELL_NO_GPU_TESTS");
    return no && std::strcmp(no, "1") == 0;
}

bool is_pattern(const Group& group)
{
    return std::strcmp(group.name, "layout") == 0;
}

std::uint64_t seed_of(const std::string& name)
{
    std::uint64_t h = 0xcbf29ce484222325u; // FNV-1a
    for (char c : name) h = (h ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
    return h;
}

enum class Mode
{
    plain, // within the tolerance of the case
    exact  // bit for bit, but for the sign of a zero and the kind of a NaN
};

struct Comparison
{
    std::size_t values = 0, equal = 0, outliers = 0;
    double worst = 0.0; // relative error, over all values
    double usual = 0.0; // the same, exceeded by one value in a thousand
    bool good = false;
    std::string examples; // the first few outliers, with their inputs
};

float as_float(std::uint32_t word)
{
    return uintBitsToFloat(word);
}

bool agree(std::uint32_t a, std::uint32_t b, bool floats, const TwinCase& limits, Mode mode, double& relative)
{
    relative = 0.0;
    if (a == b) return true;
    relative = 1.0;
    if (!floats) return false;
    const float x = as_float(a), y = as_float(b);
    if (std::isnan(x) || std::isnan(y)) {
        relative = std::isnan(x) && std::isnan(y) ? 0.0 : 1.0;
        return relative == 0.0;
    }
    if (!std::isfinite(x) || !std::isfinite(y)) return false;
    const double size = std::max(std::abs(x), std::abs(y));
    const double error = std::abs(double{x} - double{y});
    relative = size > 0.0 ? error / size : 0.0;
    if (mode == Mode::exact && !limits.builtin) return error == 0.0;
    return error <= double{limits.absolute} + double{limits.relative} * size;
}

std::string describe(std::size_t item, const std::uint32_t* gpu, std::uint32_t gpu_given)
{
    std::string text = fmt::format("  item {}:\n    inputs ", item);
    for (std::size_t at = item; at < twin.inputs.size(); at += twin.count)
        text += fmt::format(" {:08x}={:g}", twin.inputs[at], as_float(twin.inputs[at]));
    if (gpu_given != twin.given_words[item])
        text += fmt::format("\n    C++ gave {} words, the GPU {}", twin.given_words[item], gpu_given);
    for (std::size_t at = item; at < twin.outputs.size(); at += twin.count)
        if (twin.outputs[at] != gpu[at])
            text += fmt::format("\n    value {}: C++ {:08x}={:.9g}, GPU {:08x}={:.9g}", at / twin.count,
                                twin.outputs[at], as_float(twin.outputs[at]), gpu[at], as_float(gpu[at]));
    return text + "\n";
}

Comparison compare(const TwinCase& limits, Mode mode, const std::uint32_t* gpu, const std::uint32_t* gpu_given)
{
    Comparison result;
    std::vector<double> errors;
    for (std::size_t item = 0; item < twin.count; ++item) {
        bool good = twin.given_words[item] == gpu_given[item];
        for (std::size_t word = 0; word < twin.given_words[item]; ++word) {
            const std::size_t at = word * twin.count + item;
            double relative;
            good &= agree(twin.outputs[at], gpu[at], twin.is_float[at], limits, mode, relative);
            ++result.values;
            result.equal += relative == 0.0;
            if (relative > 0.0) errors.push_back(relative);
        }
        if (good) continue;
        if (++result.outliers <= 3) result.examples += describe(item, gpu, gpu_given[item]);
    }
    const std::size_t rank = result.values / 1000;
    if (!errors.empty()) result.worst = *std::max_element(errors.begin(), errors.end());
    if (errors.size() > rank) {
        const auto nth = errors.begin() + static_cast<std::ptrdiff_t>(rank);
        std::nth_element(errors.begin(), nth, errors.end(), std::greater<>());
        result.usual = *nth;
    }
    const double allowed = mode == Mode::exact && !limits.builtin ? 0.0 : double{limits.outliers};
    result.good =
        result.values > 0 && static_cast<double>(result.outliers) <= allowed * static_cast<double>(twin.count);
    return result;
}

// Runs case number `which` of the group in C++.
void run_in_cpp(const Machine& m, const Group& group, std::uint32_t which, const TwinCase& limits)
{
    twin.start(which, items, seed_of(limits.name));
    twin.scene = is_pattern(group) ? m.pattern.view() : m.random.view();
    twin.raw = m.raw.data();
    for (std::size_t i = 0; i < items; ++i) {
        twin.next_item(i);
        group.run();
        twin.end_item();
    }
}

// Runs the same case with the kernel, on the inputs that C++ drew, and compares.
Comparison run_on_gpu(const Machine& m, const Group& group, const GpuKernel& kernel, const TwinCase& limits, Mode mode)
{
    const auto inputs = m.gpu->make_buffer(twin.inputs.size() * sizeof(std::uint32_t));
    const auto outputs = m.gpu->make_buffer(twin.outputs.size() * sizeof(std::uint32_t));
    const auto given = m.gpu->make_buffer(items * sizeof(std::uint32_t));
    std::memcpy(inputs->data, twin.inputs.data(), inputs->bytes);
    std::memset(outputs->data, 0xcd, outputs->bytes); // Twin::unwritten
    std::memset(given->data, 0xcd, given->bytes);
    Push push{};
    push.inputs = inputs->address;
    push.outputs = outputs->address;
    push.given = given->address;
    push.raw = m.gpu_raw->address;
    push.scene = (is_pattern(group) ? m.gpu_pattern : m.gpu_random)->view->address;
    push.count = static_cast<std::uint32_t>(items);
    push.input_words = static_cast<std::uint32_t>(twin.inputs.size() / items);
    push.output_words = static_cast<std::uint32_t>(twin.outputs.size() / items);
    m.gpu->run(kernel, &push, static_cast<std::uint32_t>((items + 63) / 64));
    return compare(limits, mode, static_cast<const std::uint32_t*>(outputs->data),
                   static_cast<const std::uint32_t*>(given->data));
}

std::vector<TwinCase> list_cases(const Group& group)
{
    twin.start(0, 1, 0);
    twin.next_item(0);
    group.run();
    return twin.cases;
}

std::vector<std::uint32_t> load(const std::string& name, Mode mode)
{
    const auto spirv = without_unrolling(read_spirv(std::string(SNELL_TWIN_SHADERS) + "/" + name + ".spv"));
    return mode == Mode::exact ? with_no_contraction(spirv) : spirv;
}

// Case number `which` of a group's shader.
std::unique_ptr<GpuKernel> make_kernel(const Machine& m, const std::vector<std::uint32_t>& spirv, std::uint32_t which)
{
    return m.gpu->make_kernel(spirv, sizeof(Push), which);
}

double percent_equal(const Comparison& c)
{
    return 100.0 * static_cast<double>(c.equal) / static_cast<double>(std::max<std::size_t>(c.values, 1));
}

class TwinTest : public testing::TestWithParam<Group>
{
};

TEST_P(TwinTest, BothLanguagesAgree)
{
    const Group group = GetParam();
    if (left_out()) GTEST_SKIP() << "SNELL_NO_GPU_TESTS=1: the kernels of group " << group.name << " were not run";
    Machine& m = machine();
    ASSERT_TRUE(m.gpu) << m.trouble << "\n(SNELL_NO_GPU_TESTS=1 leaves these tests out)";
    const auto plain_spirv = load(group.name, Mode::plain);
    const auto exact_spirv = load(std::string("exact_") + group.name, Mode::exact);
    // Hardware may round divisions and square roots differently: bits are demanded of lavapipe only.
    const bool demand_bits = m.gpu->name().find("llvmpipe") != std::string::npos;

    const std::vector<TwinCase> cases = list_cases(group);
    ASSERT_FALSE(cases.empty());
    fmt::print("{:<36}{:>10}{:>10}{:>10}{:>10}{:>10}{:>14}\n",
               std::string(group.name) + " on " + m.gpu->name().substr(0, 16), "bit-equal", "99.9% <", "worst",
               "outliers", "allowed", "exact build");
    for (std::size_t i = 0; i < cases.size(); ++i) {
        const TwinCase& limits = cases[i];
        const auto which = static_cast<std::uint32_t>(i) + 1;
        run_in_cpp(m, group, which, limits);
        const Comparison plain = run_on_gpu(m, group, *make_kernel(m, plain_spirv, which), limits, Mode::plain);
        const float allowed = limits.outliers * static_cast<float>(items);
        fmt::print("  {:<34}{:>9.3f}%{:>10.2g}{:>10.2g}{:>10}{:>10.0f}", limits.name, percent_equal(plain), plain.usual,
                   plain.worst, plain.outliers, allowed);
        EXPECT_TRUE(plain.good) << group.name << "." << limits.name << ": " << plain.outliers << " of " << items
                                << " items are out of tolerance, allowed are " << allowed << "\n"
                                << plain.examples;
        if (limits.builtin) { // no bits to demand, and the tolerance has just been checked
            fmt::print("    (built-in)\n");
            continue;
        }
        const Comparison exact = run_on_gpu(m, group, *make_kernel(m, exact_spirv, which), limits, Mode::exact);
        fmt::print("{:>13.3f}%\n", percent_equal(exact));
        if (demand_bits) {
            EXPECT_TRUE(exact.good) << group.name << "." << limits.name << ", exact build: " << exact.outliers << " of "
                                    << items << " items differ\n"
                                    << exact.examples;
        }
    }
    std::cout.flush();
}
INSTANTIATE_TEST_SUITE_P(Groups, TwinTest, testing::ValuesIn(groups),
                         [](const auto& parameter) { return std::string(parameter.param.name); });

// A shader compiled from headers with one number changed (see mutants in CMakeLists.txt): the case must go red.
struct Mutant
{
    const char* name;
    Mode mode;
    const char* group;
    const char* spoiled_case;
};
const Mutant mutants[] = {
#define MUTANT(name, mode, group, spoiled_case) {#name, Mode::mode, #group, #spoiled_case},
#include "twin_mutants.inc"
#undef MUTANT
};

TEST(Twin, FindsAChangedConstant)
{
    if (left_out()) GTEST_SKIP() << "SNELL_NO_GPU_TESTS=1: that the twin test finds changed constants was not checked";
    Machine& m = machine();
    ASSERT_TRUE(m.gpu) << m.trouble << "\n(SNELL_NO_GPU_TESTS=1 leaves these tests out)";
    for (const Mutant& mutant : mutants) {
        const auto group = std::find_if(std::begin(groups), std::end(groups),
                                        [&](const Group& g) { return !std::strcmp(g.name, mutant.group); });
        ASSERT_NE(group, std::end(groups)) << mutant.group;
        const std::vector<TwinCase> cases = list_cases(*group);
        const auto spoiled =
            std::find_if(cases.begin(), cases.end(), [&](const TwinCase& c) { return c.name == mutant.spoiled_case; });
        ASSERT_NE(spoiled, cases.end()) << mutant.spoiled_case;
        const auto which = static_cast<std::uint32_t>(spoiled - cases.begin()) + 1;
        const auto kernel = make_kernel(m, load(mutant.name, mutant.mode), which);
        run_in_cpp(m, *group, which, *spoiled);
        EXPECT_FALSE(run_on_gpu(m, *group, *kernel, *spoiled, mutant.mode).good)
            << "mutant " << mutant.name << " went unnoticed by " << mutant.spoiled_case;
    }
}

// After the last test: everything is given back, and the validation layer must have had nothing to say about any of it.
class Closing : public testing::Environment
{
  public:
    void TearDown() override
    {
        if (!the_machine) return;
        the_machine->gpu_random.reset();
        the_machine->gpu_pattern.reset();
        the_machine->gpu_raw.reset();
        the_machine->gpu.reset();
        for (const std::string& message : the_machine->messages) ADD_FAILURE() << "Vulkan validation: " << message;
    }
};
const testing::Environment* const closing = testing::AddGlobalTestEnvironment(new Closing);
} // namespace
} // namespace snell::test
