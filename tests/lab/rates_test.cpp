#include "snell/lab/rates.h"

#include <gtest/gtest.h>

namespace snell {
namespace {

RenderStats at(double seconds, double speed)
{
    RenderStats s;
    s.camera_rays = static_cast<std::uint64_t>(1000 * speed * seconds);
    s.extension_rays = 2 * s.camera_rays;
    s.shadow_rays = 3 * s.camera_rays;
    s.samples = s.camera_rays;
    s.extend_seconds = 3 * seconds;
    s.shade_seconds = seconds;
    return s;
}

TEST(Rates, AreMeansOverTheWindow)
{
    RateMeter meter(1.0);
    EXPECT_EQ(meter.rates().rays(), 0.0);
    meter.add(10.0, at(0, 1));
    EXPECT_EQ(meter.rates().rays(), 0.0);
    for (int i = 1; i <= 20; ++i) meter.add(10.0 + 0.25 * i, at(0.25 * i, 1));
    EXPECT_NEAR(meter.rates().camera_rays, 1000, 1);
    EXPECT_NEAR(meter.rates().rays(), 6000, 6);
    EXPECT_NEAR(meter.rates().stages[1], 0.75, 1e-9);
    EXPECT_NEAR(meter.rates().stages[2], 0.25, 1e-9);
    // it rests: after the window nothing is left of what was
    for (int i = 1; i <= 8; ++i) meter.add(15.0 + 0.25 * i, at(5, 1));
    EXPECT_EQ(meter.rates().samples, 0.0);
    EXPECT_EQ(meter.rates().stages[1], 0.0);
}

TEST(Rates, CountAnewWithTheRenderer)
{
    RateMeter meter;
    meter.add(0, at(100, 1));
    meter.add(1, at(0, 1)); // another scene
    EXPECT_EQ(meter.rates().rays(), 0.0);
    meter.add(1, at(1, 1)); // no time has passed
    EXPECT_EQ(meter.rates().rays(), 0.0);
    meter.add(2, at(2, 1));
    EXPECT_NEAR(meter.rates().camera_rays, 1000, 1);
}

} // namespace
} // namespace snell
