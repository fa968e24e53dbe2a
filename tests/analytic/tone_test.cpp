// The view transforms against values computed elsewhere: in double precision, from the published matrices, and for AgX
// by the polynomial that others fit to its curve.
#include "snell/kernel/tone.h"

#include <gtest/gtest.h>

namespace snell {

static void expect_near(vec3 value, vec3 wanted, float tolerance)
{
    EXPECT_NEAR(value.x, wanted.x, tolerance);
    EXPECT_NEAR(value.y, wanted.y, tolerance);
    EXPECT_NEAR(value.z, wanted.z, tolerance);
}

static const vec3 grey(0.18f), bright(4.0f, 1.0f, 0.1f), brown(0.5f, 0.2f, 0.05f), dark(0.01f, 0.02f, 0.03f),
    glare(20.0f);

TEST(ViewTransform, HillsFitOfAces)
{
    expect_near(tone_curve(grey, tone_aces_hill), vec3(0.10559f), 1e-4f);
    expect_near(tone_curve(brown, tone_aces_hill), vec3(0.36450f, 0.12841f, 0.02258f), 1e-4f);
    expect_near(tone_curve(bright, tone_aces_hill), vec3(1.00208f, 0.66341f, 0.20666f), 1e-4f);
    expect_near(tone_curve(dark, tone_aces_hill), vec3(0.00108f, 0.00319f, 0.00572f), 1e-4f);
}

TEST(ViewTransform, Neutral)
{
    expect_near(tone_curve(grey, tone_neutral), vec3(0.14f), 1e-5f);
    expect_near(tone_curve(brown, tone_neutral), vec3(0.46563f, 0.16563f, 0.01562f), 2e-5f);
    expect_near(tone_curve(bright, tone_neutral), vec3(0.98326f, 0.46830f, 0.31381f), 2e-5f);
    expect_near(tone_curve(dark, tone_neutral), vec3(0.00063f, 0.01063f, 0.02062f), 2e-5f);
    expect_near(tone_curve(glare, tone_neutral), vec3(0.99704f), 2e-5f);
}

TEST(ViewTransform, AgX)
{
    const auto expect = [](vec3 radiance, vec3 encoded) { // with AgX's own gamma of 2.2
        expect_near(pow(tone_curve(radiance, tone_agx), vec3(1.0f / 2.2f)), encoded, 0.012f);
    };
    expect(grey, vec3(0.4967f));
    expect(brown, vec3(0.6996f, 0.5248f, 0.3257f));
    expect(bright, vec3(0.9674f, 0.8061f, 0.5739f));
    expect(dark, vec3(0.1015f, 0.1627f, 0.2116f));
    expect(glare, vec3(0.9985f));
}

TEST(ViewTransform, EndsOfTheRange)
{
    for (uint curve = 0; curve < tone_count; ++curve) {
        const vec3 black = display_value(vec3(0.0f), 0.0f, curve), white = display_value(vec3(1e6f), 0.0f, curve);
        EXPECT_LT(black.x, 0.005f) << curve;
        EXPECT_GT(white.x, 0.98f) << curve;
        EXPECT_LE(white.x, 1.0f) << curve;
        float before = 0.0f; // and never darker for more light
        for (float light = 1e-4f; light < 1e4f; light *= 1.1f) {
            const float now = display_value(vec3(light), 0.0f, curve).y;
            EXPECT_GE(now, before - 1e-5f) << curve << " at " << light;
            before = now;
        }
    }
}

} // namespace snell
