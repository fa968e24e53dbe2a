// The governor against machines that are made up.
#include "snell/render/governor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

namespace snell::test {
namespace {

// What a picture takes: a part that does not depend on its size, and samples that cost more the deeper paths go.
struct Machine
{
    double fixed_ms = 0.5;
    double full_ms = 1000; // at full scale, for the first bounce
    double survival = 0.7; // of a path, from one bounce to the next

    double ms(const GovernorState& state) const
    {
        double bounces = 0, alive = 1;
        const uint most = state.max_depth == 0 ? 60 : state.max_depth;
        for (uint i = 0; i < most; ++i, alive *= survival) bounces += alive;
        return fixed_ms + full_ms * double{state.scale} * double{state.scale} * bounces;
    }
};

std::vector<double> run(Governor& governor, const std::function<double(const GovernorState&)>& machine, int pictures)
{
    std::vector<double> times;
    for (int i = 0; i < pictures; ++i) {
        times.push_back(machine(governor.state()));
        governor.measured(times.back());
    }
    return times;
}

Governor governor_for(double target_ms)
{
    Governor governor;
    governor.set({target_ms, true});
    return governor;
}

TEST(Governor, FindsItsWayWithinAFewPicturesAndStaysThere)
{
    for (const double full_ms : {0.2, 2.0, 20.0, 60.0, 200.0, 600.0, 2000.0})
        for (const double survival : {0.1, 0.6, 0.9})
            for (const double target : {10.0, 25.0, 33.0, 100.0}) {
                SCOPED_TRACE(testing::Message() << full_ms << " ms, " << survival << ", target " << target);
                const Machine machine{0.5, full_ms, survival};
                Governor governor = governor_for(target);
                const std::vector<double> times = run(
                    governor, [&](const auto& s) { return machine.ms(s); }, 40);
                const bool is_cheap = machine.ms({1.0f, 0, 0}) < 0.9 * target;
                const bool is_hopeless = machine.ms({0.125f, 1, 0}) > target;
                for (std::size_t i = 12; i < times.size(); ++i) {
                    EXPECT_TRUE(is_hopeless || times[i] <= 1.1 * target) << "picture " << i << ": " << times[i];
                    EXPECT_NEAR(times[i], times.back(), 0.1 * times.back()) << "picture " << i;
                }
                if (is_cheap) {
                    EXPECT_EQ(governor.state().scale, 1.0f);
                    EXPECT_EQ(governor.state().max_depth, 0u);
                }
                if (is_hopeless) {
                    EXPECT_EQ(governor.state().scale, 0.125f);
                    EXPECT_EQ(governor.state().max_depth, 1u);
                }
            }
}

TEST(Governor, UsesTheTimeThatItMayUse)
{
    const Machine machine{0.5, 200.0, 0.7};
    Governor governor = governor_for(33.0);
    EXPECT_GT(run(
                  governor, [&](const auto& s) { return machine.ms(s); }, 20)
                  .back(),
              0.6 * 33.0);
}

TEST(Governor, TakesResolutionFirstThenDepthAndGivesBackInTheOppositeOrder)
{
    Machine machine{0.5, 4.0, 0.8};
    Governor governor = governor_for(25.0);
    const auto settle = [&] {
        run(
            governor, [&](const auto& s) { return machine.ms(s); }, 40);
        return governor.state();
    };
    EXPECT_EQ(settle().scale, 1.0f);
    float last_scale = 2.0f;
    uint last_depth = 1000;
    for (const double full_ms : {30.0, 100.0, 300.0, 700.0, 1500.0}) {
        machine.full_ms = full_ms;
        const GovernorState state = settle();
        EXPECT_LE(state.scale, last_scale);
        last_scale = state.scale;
        if (state.max_depth == 0) continue;
        EXPECT_EQ(state.scale, 0.125f) << "resolution goes first";
        EXPECT_LE(state.max_depth, last_depth);
        last_depth = state.max_depth;
    }
    EXPECT_LT(last_depth, 4u);
    for (const double full_ms : {700.0, 300.0, 100.0, 30.0, 4.0}) {
        machine.full_ms = full_ms;
        const GovernorState state = settle();
        EXPECT_GE(state.scale, last_scale);
        last_scale = state.scale;
        EXPECT_TRUE(state.scale == 0.125f || state.max_depth == 0) << "depth comes back first";
    }
    EXPECT_EQ(settle().scale, 1.0f);
}

// Scenes cost more or less as one walks, and machines do other things as well.
TEST(Governor, NoiseMakesItNeitherWanderNorStarve)
{
    const Machine machine{0.5, 100.0, 0.6};
    Governor governor = governor_for(25.0);
    std::mt19937 random(1);
    std::normal_distribution<double> noise(1.0, 0.05);
    std::vector<float> scales;
    for (int i = 0; i < 300; ++i) {
        governor.measured(machine.ms(governor.state()) * std::max(0.5, noise(random)));
        if (i >= 20) scales.push_back(governor.state().scale);
    }
    const auto [least, most] = std::minmax_element(scales.begin(), scales.end());
    EXPECT_LE(*most, 1.25f * *least);
    // one picture that something else has held up
    const GovernorState before = governor.state();
    governor.measured(35.0);
    EXPECT_EQ(governor.state().scale, before.scale);
    governor.measured(300.0);
    EXPECT_LT(governor.state().scale, before.scale);
    run(
        governor, [&](const auto& s) { return machine.ms(s); }, 12);
    EXPECT_NEAR(double{governor.state().scale}, double{before.scale}, 0.2 * double{before.scale});
}

TEST(Governor, IsAFunctionOfWhatItWasTold)
{
    const Machine machine{0.5, 900.0, 0.8};
    Governor a = governor_for(20.0), b = governor_for(20.0);
    for (int i = 0; i < 30; ++i) {
        const double ms = machine.ms(a.state()) * (1.0 + 0.3 * std::sin(i));
        a.measured(ms);
        b.measured(ms);
        ASSERT_EQ(a.state().scale, b.state().scale);
        ASSERT_EQ(a.state().max_depth, b.state().max_depth);
        ASSERT_EQ(a.state().measured_ms, ms);
    }
}

TEST(Governor, SwitchedOffItLeavesNothingOut)
{
    Governor governor;
    governor.measured(10'000.0);
    EXPECT_LT(governor.state().scale, 1.0f);
    governor.set({25.0, false});
    EXPECT_EQ(governor.state().scale, 1.0f);
    EXPECT_EQ(governor.state().max_depth, 0u);
    governor.measured(10'000.0);
    EXPECT_EQ(governor.state().scale, 1.0f);
    governor.set({25.0, true});
    EXPECT_LT(governor.state().scale, 1.0f);
}

TEST(Governor, TargetsThatMakeNoSense)
{
    for (const double target : {0.0, -5.0, std::nan(""), HUGE_VAL}) {
        Governor governor = governor_for(target);
        for (const double ms : {5.0, 0.0, -1.0, std::nan(""), HUGE_VAL, 1e-300, 20.0}) governor.measured(ms);
        EXPECT_GE(governor.state().scale, 0.125f);
        EXPECT_LE(governor.state().scale, 1.0f);
    }
}

} // namespace
} // namespace snell::test
