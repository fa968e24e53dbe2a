#include "snell/view/display.h"

#include "snell/core/timer.h"
#include "snell/kernel/tone.h"
#include "snell/view/record.h"
#include "snell/view/script.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace snell::view {

static void expect_texel(std::uint32_t texel, vec3 encoded, const char* what)
{
    for (int channel = 0; channel < 3; ++channel)
        EXPECT_LE(std::abs(static_cast<float>(texel >> 8 * channel & 255u) - 255.0f * encoded[channel]), 1.0f)
            << what << ", channel " << channel;
    EXPECT_EQ(texel >> 24, 255u);
}

TEST(Display, AgreesWithTheKernelForEveryViewTransform)
{
    std::mt19937 random(7);
    std::uniform_real_distribution<float> exponent(-12.0f, 8.0f);
    for (uint curve = 0; curve < tone_count; ++curve)
        for (int i = 0; i < 20000; ++i) {
            const vec3 light(std::exp2(exponent(random)), std::exp2(exponent(random)), std::exp2(exponent(random)));
            std::uint32_t texel = 0;
            to_screen(&light, 1, {0.7f, curve}, &texel);
            expect_texel(texel, display_value(light, 0.7f, curve), std::to_string(curve).c_str());
            if (HasFailure()) return;
        }
}

TEST(Display, WhatIsNoColourDoesNoHarm)
{
    const vec3 lights[] = {vec3(0.0f), vec3(-1.0f), vec3(NAN), vec3(INFINITY), vec3(1e30f), vec3(1e-30f)};
    for (uint curve = 0; curve < tone_count; ++curve) {
        std::uint32_t texels[6] = {};
        to_screen(lights, 6, {100.0f, curve}, texels);
        for (const std::uint32_t texel : texels) EXPECT_EQ(texel >> 24, 255u);
    }
}

static Shot shot_of(int width, int height, vec3 color, uint samples)
{
    Shot shot;
    shot.film = Film(width, height, false);
    shot.width = width, shot.height = height;
    shot.spp = samples;
    for (std::size_t i = 0; i < shot.film.sum.size(); ++i) {
        shot.film.sum[i] = color * static_cast<float>(samples);
        shot.film.sample_count[i] = samples;
    }
    return shot;
}

TEST(Display, DataAreShownAsTheyAre)
{
    Shot shot = shot_of(4, 4, vec3(0.25f), 3);
    ScreenPicture light, data;
    to_screen(shot, {2.0f, tone_none}, light);
    expect_texel(light.texels[5], vec3(1.0f), "four times as bright");
    shot.is_data = true;
    to_screen(shot, {2.0f, tone_agx}, data);
    expect_texel(data.texels[5], vec3(srgb_encode(0.25f)), "data");
}

TEST(Display, WhatIsNotRenderedYetShowsThePreview)
{
    Shot shot = shot_of(8, 8, vec3(1.0f), 0);
    shot.film.sum[0] = vec3(0.5f), shot.film.sample_count[0] = 1;
    shot.under = std::make_shared<Shot>(shot_of(2, 2, vec3(0.2f), 1));
    ScreenPicture picture;
    to_screen(shot, {}, picture);
    expect_texel(picture.texels[0], vec3(srgb_encode(0.5f)), "rendered");
    expect_texel(picture.texels[63], vec3(srgb_encode(0.2f)), "enlarged");
}

TEST(Display, AWholeWindowTakesMilliseconds)
{
    const Shot shot = shot_of(1280, 720, vec3(0.3f, 0.5f, 0.9f), 5);
    ScreenPicture picture;
    for (uint curve = 0; curve < tone_count; ++curve) {
        double best = 1.0;
        for (int i = 0; i < 5; ++i) {
            const Timer timer;
            to_screen(shot, {0.5f, curve}, picture);
            best = std::min(best, timer.seconds());
        }
        RecordProperty("curve_" + std::to_string(curve) + "_microseconds", static_cast<int>(1e6 * best));
        EXPECT_LT(best, 0.2) << curve; // generous: sanitizers, and machines with other work
    }
}

TEST(Script, SaysWhereItIsWrong)
{
    const auto message = [](const std::string& text) -> std::string {
        try {
            parse_script(text, "tour.txt");
        } catch (const std::exception& error) {
            return error.what();
        }
        return "";
    };
    EXPECT_EQ(message("# nothing\n\nopen cornell\nwait picture # and more\nquit\n"), "");
    EXPECT_NE(
        message("open cornell\nopne menger\n").find("tour.txt:2: there is no command 'opne'; did you mean 'open'?"),
        std::string::npos);
    EXPECT_NE(message("size 100\n").find("tour.txt:1: "), std::string::npos);
    EXPECT_NE(message("size 100 wide\n").find("'wide' is not a number"), std::string::npos);
    EXPECT_NE(message("press \"Frame\n").find("no end"), std::string::npos);
    EXPECT_NE(message("key Nonsense\n").find("no key 'Nonsense'"), std::string::npos);
    EXPECT_EQ(parse_script("press \"Frame the scene\"", "x")[0].words[1], "Frame the scene");
}

TEST(Record, NumbersFiles)
{
    EXPECT_EQ(numbered_file("walk.%04d.png", 7), "walk.0007.png");
    EXPECT_EQ(numbered_file("%d.exr", 123), "123.exr");
    for (const char* wrong : {"walk.png", "%s.png", "%d%d.png", "%", "%0999d.png"})
        EXPECT_THROW(numbered_file(wrong, 1), std::exception) << wrong;
}

} // namespace snell::view
