// Transforms taken apart and put together.
#include "snell/scene/keyframes.h"
#include "snell/view/panels/transform_editor.h"

#include <gtest/gtest.h>

#include <random>

namespace snell::view {
namespace {

void expect_near(const Transform& a, const Transform& b)
{
    for (const auto& [p, q] : {std::pair{a.x, b.x}, {a.y, b.y}, {a.z, b.z}})
        for (int i = 0; i < 4; ++i) EXPECT_NEAR(p[i], q[i], 2e-5f * (1.0f + std::abs(q[i])));
}

TEST(TransformEditorTest, PartsMakeTheMapAgain)
{
    std::mt19937 random(1);
    std::uniform_real_distribution<float> number(-1.0f, 1.0f);
    const auto vector = [&](float scale) { return scale * vec3(number(random), number(random), number(random)); };
    for (int i = 0; i < 1000; ++i) {
        vec3 degrees = vector(180.0f);
        if (i % 10 == 0) degrees.y = i % 20 == 0 ? 90.0f : -90.0f; // x and z turn around the same axis
        vec3 scale = abs(vector(2.0f)) + vec3(0.1f);
        if (i % 3 == 0) scale.y = -scale.y;
        const Transform map = compose_parts(vector(10.0f), degrees, scale);
        const std::optional<TransformParts> parts = take_apart(map);
        ASSERT_TRUE(parts.has_value());
        expect_near(compose_parts(parts->translation, parts->degrees, parts->scale), map);
        EXPECT_EQ(parts->scale.x < 0.0f, i % 3 == 0) << "of a map that mirrors, the first scale is negative";
    }
}

TEST(TransformEditorTest, WhatShearsOrIsFlatHasNoParts)
{
    EXPECT_FALSE(take_apart(compose(scaling(vec3(1, 2, 1)), rotation(vec3(0, 0, 1), 30.0f))).has_value());
    EXPECT_FALSE(take_apart(scaling(vec3(1, 0, 1))).has_value());
}

TEST(TransformEditorTest, QuaternionsTurnAsTheAnglesDo)
{
    for (const vec3 degrees : {vec3(0), vec3(30, 0, 0), vec3(10, 50, -120), vec3(90, 90, 90), vec3(-170, 20, 3)})
        expect_near(compose_trs(vec3(1, 2, 3), quaternion_of(degrees), vec3(2)),
                    compose_parts(vec3(1, 2, 3), degrees, vec3(2)));
}

} // namespace
} // namespace snell::view
