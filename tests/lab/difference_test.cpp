#include "snell/lab/difference.h"

#include "snell/core/error.h"
#include "snell/kernel/views.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace snell {
namespace {

Picture pair(vec3 a, vec3 b)
{
    return {2, 1, {a, b}};
}

TEST(Differences, AreShownAsTheySay)
{
    const Picture r = pair(vec3(1.0f, 0.5f, 0.25f), vec3(2.0f)),
                  x = pair(vec3(1.0f, 0.5f, 0.25f), vec3(2.5f, 2.0f, 1.75f));
    const auto at = [&](Difference kind, float gain) { return picture_of_difference(x, r, kind, gain).pixels; };
    for (const auto kind : {Difference::relative, Difference::squared, Difference::absolute})
        EXPECT_EQ(at(kind, 3.0f)[0], kind == Difference::absolute ? vec3(0.0f) : heat_color(0.0f));
    EXPECT_EQ(at(Difference::signed_difference, 2.0f)[0], vec3(0.5f));
    EXPECT_EQ(at(Difference::signed_difference, 2.0f)[1], vec3(1.0f, 0.5f, 0.25f));
    EXPECT_EQ(at(Difference::absolute, 2.0f)[1], vec3(1.0f, 0.0f, 0.5f));
    const float d = luminance(vec3(0.5f, 0.0f, -0.25f));
    EXPECT_LT(length(at(Difference::relative, 4.0f)[1] - heat_color(4.0f * d / 2.01f)), 1e-5f);
    EXPECT_LT(length(at(Difference::squared, 4.0f)[1] - heat_color(16.0f * d * d)), 1e-5f);
    EXPECT_NE(at(Difference::squared, 4.0f)[1], heat_color(0.0f));
}

TEST(Differences, WhatIsNoNumberIsSeen)
{
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const Picture good = pair(vec3(1.0f), vec3(1.0f)), bad = pair(vec3(1.0f, nan, 1.0f), vec3(1.0f));
    for (const auto kind :
         {Difference::signed_difference, Difference::absolute, Difference::relative, Difference::squared}) {
        EXPECT_EQ(picture_of_difference(bad, good, kind).pixels[0], vec3(1.0f, 0.0f, 1.0f));
        EXPECT_EQ(picture_of_difference(good, bad, kind).pixels[0], vec3(1.0f, 0.0f, 1.0f));
        EXPECT_NE(picture_of_difference(good, bad, kind).pixels[1], vec3(1.0f, 0.0f, 1.0f));
    }
    EXPECT_THROW(picture_of_difference(good, Picture{1, 2, good.pixels}, Difference::absolute), Error);
}

} // namespace
} // namespace snell
