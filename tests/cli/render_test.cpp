// What the program does when all is well, and when it is interrupted.
#include "program.h"

#include "snell/io/image/read.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <chrono>
#include <cmath>
#include <csignal>
#include <thread>

namespace snell::test {
namespace {

using nlohmann::json;

// 0.1 s of rendering.
const std::vector<std::string> small = {"render", "cornell", "--size", "32x24", "--spp", "4"};

std::vector<std::string> with(std::vector<std::string> arguments, const std::vector<std::string>& more)
{
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
}

TEST(Render, WritesAPictureNamedAfterTheScene)
{
    Program program;
    const Outcome outcome = program.run(small);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(outcome.out, "") << "messages belong on stderr";
    EXPECT_NE(outcome.err.find("wrote cornell.png"), std::string::npos);
    for (const char* word : {"camera", "extension", "shadow", "rays/s", "samples/s", "build", "peak memory"})
        EXPECT_NE(outcome.err.find(word), std::string::npos) << word;
    EXPECT_EQ(program.files(), std::vector<std::string>{"cornell.png"});
    const Picture picture = read_picture(program.folder() / "cornell.png");
    EXPECT_EQ(picture.width, 32);
    EXPECT_EQ(picture.height, 24);
}

TEST(Render, SeveralOutputsFromOneRender)
{
    Program program;
    const Outcome outcome = program.run({"render", "-o", "a.exr", "--outfile", "b.png", "-oc.pfm", "cornell",
                                         "--resolution=16x16", "--samples", "2", "-o", "d.hdr", "-t", "1"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(program.files(), (std::vector<std::string>{"a.exr", "b.png", "c.pfm", "d.hdr"}));
    const Picture exr = read_picture(program.folder() / "a.exr"), pfm = read_picture(program.folder() / "c.pfm");
    EXPECT_EQ(exr.pixels, pfm.pixels);
}

TEST(Render, QuietSaysNothing)
{
    Program program;
    const Outcome outcome = program.run(with(small, {"-q"}));
    EXPECT_EQ(outcome.code, 0);
    EXPECT_EQ(outcome.err, "");
    EXPECT_EQ(outcome.out, "");
}

TEST(Render, StatsAsJson)
{
    Program program;
    for (const bool quiet : {false, true}) {
        const Outcome outcome = program.run(with(small, quiet ? std::vector<std::string>{"--stats=json", "-q"}
                                                              : std::vector<std::string>{"--stats=json"}));
        ASSERT_EQ(outcome.code, 0) << outcome.err;
        ASSERT_EQ(line_count(outcome.out), 1u);
        const json stats = json::parse(outcome.out);
        EXPECT_EQ(stats.at("rays").at("camera"), 32 * 24 * 4);
        EXPECT_GT(stats.at("rays").at("extension"), 0);
        EXPECT_GT(stats.at("rays").at("shadow"), 0);
        EXPECT_GT(stats.at("rays_per_second"), 0.0);
        EXPECT_GT(stats.at("samples_per_second"), 0.0);
        for (const char* key : {"load", "build", "render"}) EXPECT_GE(stats.at("seconds").at(key), 0.0) << key;
        EXPECT_GT(stats.at("peak_memory_bytes"), 1000000);
        EXPECT_EQ(stats.at("dropped_samples"), 0);
    }
}

TEST(Render, StatsAsText)
{
    Program program;
    const Outcome outcome = program.run(with(small, {"--stats"}));
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    for (const char* word : {"generate", "extend", "shade", "connect", "finalize", "pack", "bytes a triangle"})
        EXPECT_NE(outcome.err.find(word), std::string::npos) << word;
}

TEST(Render, LogFileHasTheMessages)
{
    Program program;
    const Outcome outcome = program.run(with(small, {"-q", "--log-file", "log.txt"}));
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");
    EXPECT_GT(std::filesystem::file_size(program.folder() / "log.txt"), 100u);
}

TEST(Render, NegativeNumbersAreValuesNotOptions)
{
    Program program;
    const Outcome outcome =
        program.run(with(small, {"--eye", "-.1,1,-5", "--target", "-0.1,1,0", "--exposure", "-1", "--up=0,1,0"}));
    EXPECT_EQ(outcome.code, 0) << outcome.err;
}

TEST(Render, OnlyTheRegion)
{
    Program program;
    ASSERT_EQ(program.run(with(small, {"-o", "all.pfm"})).code, 0);
    ASSERT_EQ(program.run(with(small, {"-o", "part.pfm", "--pixelbounds", "8,16,4,12"})).code, 0);
    ASSERT_EQ(program.run(with(small, {"-o", "crop.pfm", "--cropwindow", "0.25,0.5,0.16666,0.5"})).code, 0);
    const Picture all = read_picture(program.folder() / "all.pfm"), part = read_picture(program.folder() / "part.pfm"),
                  crop = read_picture(program.folder() / "crop.pfm");
    for (int y = 0; y < 24; ++y)
        for (int x = 0; x < 32; ++x) {
            const bool inside = x >= 8 && x < 16 && y >= 4 && y < 12;
            EXPECT_EQ(part.at(x, y), inside ? all.at(x, y) : vec3(0.0f)) << x << "," << y;
        }
    EXPECT_EQ(crop.pixels, part.pixels);
}

TEST(Render, SampleRangesAddUp)
{
    Program program;
    ASSERT_EQ(program.run(with(small, {"-o", "all.pfm"})).code, 0);
    std::vector<std::string> no_spp(small.begin(), small.end() - 2);
    ASSERT_EQ(program.run(with(no_spp, {"-o", "a.pfm", "--samples-range", "0:2"})).code, 0);
    ASSERT_EQ(program.run(with(no_spp, {"-o", "b.pfm", "--samples-range", "2:4"})).code, 0);
    const Picture all = read_picture(program.folder() / "all.pfm"), a = read_picture(program.folder() / "a.pfm"),
                  b = read_picture(program.folder() / "b.pfm");
    EXPECT_NE(a.pixels, b.pixels);
    for (std::size_t i = 0; i < all.pixels.size(); ++i)
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(0.5f * (a.pixels[i][c] + b.pixels[i][c]), all.pixels[i][c], 1e-5f * (1.0f + all.pixels[i][c]));
}

TEST(Render, SceneWithoutCameraAndLightSaysWhatItGot)
{
    Program program;
    program.write("one.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    const Outcome outcome = program.run({"render", "one.obj", "--size", "16x16", "--spp", "2"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_NE(outcome.err.find("camera"), std::string::npos);
    EXPECT_NE(outcome.err.find("light"), std::string::npos);
    EXPECT_TRUE(std::filesystem::exists(program.folder() / "one.png"));
}

TEST(Render, TimeoutWritesWhatThereIs)
{
    Program program;
    const Outcome outcome =
        program.run({"render", "cornell", "--size", "64x64", "--spp", "100000000", "--timeout", "0.5"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_NE(outcome.err.find("out of time"), std::string::npos) << outcome.err;
    EXPECT_EQ(program.files(), std::vector<std::string>{"cornell.png"});
}

class RenderInterrupted : public ::testing::TestWithParam<int>
{
};

TEST_P(RenderInterrupted, WritesThePictureSoFar)
{
    Program program;
    program.start({"render", "cornell", "--size", "64x64", "--spp", "100000000", "-v", "-o", "part.exr"});
    ASSERT_TRUE(program.wait_for("rendering"));
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    program.send(GetParam());
    const Outcome outcome = program.wait();
    EXPECT_EQ(outcome.code, 128 + GetParam()) << outcome.err;
    EXPECT_NE(outcome.err.find("interrupted"), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find("of 100000000 samples a pixel"), std::string::npos) << outcome.err;
    EXPECT_EQ(program.files(), std::vector<std::string>{"part.exr"});
    const Picture picture = read_picture(program.folder() / "part.exr");
    double sum = 0;
    for (const vec3& c : picture.pixels) sum += static_cast<double>(c.x + c.y + c.z);
    EXPECT_GT(sum, 0.0);
    EXPECT_TRUE(std::isfinite(sum));
}

INSTANTIATE_TEST_SUITE_P(BySignal, RenderInterrupted, ::testing::Values(SIGINT, SIGTERM));

TEST(Render, TwoInterruptsStopItAtOnce)
{
    Program program;
    program.start({"render", "cornell", "--size", "64x64", "--spp", "100000000", "-v", "-o", "part.pfm"});
    ASSERT_TRUE(program.wait_for("rendering"));
    program.send(SIGINT);
    program.send(SIGINT);
    EXPECT_EQ(program.wait().code, 130);
}

TEST(Info, TextAndJson)
{
    Program program;
    program.write("quad.obj", "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nf 1 2 3 4\n");
    const Outcome text = program.run({"info", "quad.obj"});
    ASSERT_EQ(text.code, 0) << text.err;
    EXPECT_NE(text.out.find("triangles"), std::string::npos);
    EXPECT_NE(text.out.find("bounds"), std::string::npos);

    const Outcome outcome = program.run({"info", "quad.obj", "--json"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    ASSERT_EQ(line_count(outcome.out), 1u);
    const json info = json::parse(outcome.out);
    EXPECT_EQ(info.at("meshes"), 1);
    EXPECT_EQ(info.at("triangles"), 2);
    EXPECT_EQ(info.at("cameras").size(), 0u);
    EXPECT_EQ(info.at("bounds").at("upper"), json::array({2.0, 1.0, 0.0}));
    EXPECT_GT(info.at("bytes").at("accel_forecast"), 0);
    EXPECT_TRUE(info.at("notes").is_array());
}

TEST(List, NamesEverythingThatRenderTakes)
{
    Program program;
    const Outcome outcome = program.run({"list", "--json"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const json list = json::parse(outcome.out);
    const auto names = [&](const char* key) {
        std::vector<std::string> all;
        for (const json& entry : list.at(key)) all.push_back(entry.at("name"));
        return all;
    };
    for (const std::string& integrator : names("integrators"))
        EXPECT_EQ(program.run(with(small, {"--integrator", integrator})).code, 0) << integrator;
    for (const std::string& accel : names("accels"))
        EXPECT_EQ(program.run(with(small, {"--accel", accel})).code, 0) << accel;
    EXPECT_EQ(names("gpu_parameters").size(), 2u);
    for (const std::string& parameter : names("gpu_parameters")) { // name=default, on every device
        EXPECT_EQ(program.run(with(small, {"-D", parameter})).code, 0) << parameter;
        EXPECT_EQ(program.run(with(small, {"-D", parameter + "x"})).code, 2) << parameter;
    }
    for (const std::string& sampler : names("samplers"))
        EXPECT_EQ(program.run(with(small, {"--sampler", sampler})).code, 0) << sampler;
    for (const std::string& curve : names("tone_curves"))
        EXPECT_EQ(program.run(with(small, {"--tone", curve})).code, 0) << curve;
    for (const std::string& ending : names("picture_formats"))
        EXPECT_EQ(program.run(with(small, {"-o", "picture" + ending})).code, 0) << ending;
    EXPECT_GE(names("scenes").size(), 7u);
    for (const std::string& scene : names("scenes")) EXPECT_EQ(program.run({"info", scene, "-q"}).code, 0) << scene;

    const Outcome text = program.run({"list"});
    EXPECT_EQ(text.code, 0);
    for (const char* word : {"whitted", "path", "sobol", "cornell", ".exr"})
        EXPECT_NE(text.out.find(word), std::string::npos) << word;
}

TEST(BuiltIn, ScenesOfAnySize)
{
    Program program;
    const auto info = [&](const char* scene) {
        const Outcome outcome = program.run({"info", scene, "--json"});
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        return json::parse(outcome.out);
    };
    EXPECT_EQ(info("sphereflake:2").at("placed_spheres"), 91);
    EXPECT_EQ(info("sphereflake:7").at("placed_spheres"), 5380840);
    EXPECT_EQ(info("menger:0").at("placed_triangles"), 12);
    EXPECT_EQ(info("many-lights:50").at("lights"), 50);
    EXPECT_EQ(info("many-lights").at("lights"), 400);

    const Outcome outcome = program.run({"render", "sphereflake:1", "--size", "8x8", "--spp", "1"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(program.files(), std::vector<std::string>{"sphereflake-1.png"});
    const std::string list = program.run({"list"}).out;
    for (const char* words : {"sphereflake:DEPTH", "menger:DEPTH", "many-lights:COUNT"})
        EXPECT_NE(list.find(words), std::string::npos) << words;
}

TEST(Compare, ExitCodeByThreshold)
{
    Program program;
    ASSERT_EQ(program.run(with(small, {"-q", "-o", "a.pfm"})).code, 0);
    ASSERT_EQ(program.run(with(small, {"-q", "-o", "b.pfm", "--seed", "1"})).code, 0);
    EXPECT_EQ(program.run({"compare", "a.pfm", "a.pfm", "--threshold", "0"}).code, 0);
    EXPECT_EQ(program.run({"compare", "a.pfm", "b.pfm"}).code, 0);
    EXPECT_EQ(program.run({"compare", "a.pfm", "b.pfm", "--threshold", "0"}).code, 1);
    EXPECT_EQ(program.run({"compare", "a.pfm", "--reference", "b.pfm", "--metric", "psnr", "--threshold", "0"}).code,
              0);
    EXPECT_EQ(program.run({"compare", "a.pfm", "b.pfm", "--metric", "psnr", "--threshold", "500"}).code, 1);
    EXPECT_EQ(program.run({"compare", "a.pfm", "a.pfm", "--metric", "psnr", "--threshold", "500"}).code, 0);

    const Outcome outcome = program.run({"compare", "a.pfm", "b.pfm", "--metric", "mse,relmse,psnr", "--json",
                                         "--threshold", "0", "-o", "difference.pfm"});
    EXPECT_EQ(outcome.code, 1);
    ASSERT_EQ(line_count(outcome.out), 1u);
    const json result = json::parse(outcome.out);
    EXPECT_GT(result.at("mse"), 0.0);
    EXPECT_GT(result.at("relmse"), 0.0);
    EXPECT_GT(result.at("psnr"), 0.0);
    EXPECT_EQ(result.at("pass"), false);
    EXPECT_TRUE(std::filesystem::exists(program.folder() / "difference.pfm"));
}

TEST(Compare, SizesAndValuesThatCannotBeCompared)
{
    Program program;
    const std::string nan("\x00\x00\xc0\x7f", 4), one("\x00\x00\x80\x3f", 4);
    program.write("nan.pfm", "PF\n1 1\n-1.0\n" + nan + one + one);
    program.write("one.pfm", "PF\n1 1\n-1.0\n" + one + one + one);
    program.write("two.pfm", "PF\n2 1\n-1.0\n" + one + one + one + one + one + one);
    EXPECT_EQ(program.run({"compare", "one.pfm", "one.pfm"}).code, 0);
    for (const auto& [a, b] : {std::pair{"nan.pfm", "one.pfm"}, {"one.pfm", "nan.pfm"}, {"nan.pfm", "nan.pfm"}}) {
        const Outcome outcome = program.run({"compare", a, b});
        EXPECT_EQ(outcome.code, 1) << a << " " << b;
        EXPECT_NE(outcome.err.find("1 pixels are not finite"), std::string::npos) << outcome.err;
    }
    const Outcome outcome = program.run({"compare", "one.pfm", "two.pfm"});
    EXPECT_EQ(outcome.code, 1);
    EXPECT_EQ(line_count(outcome.err), 1u);
    EXPECT_NE(outcome.err.find("1x1 against 2x1"), std::string::npos) << outcome.err;
}

} // namespace
} // namespace snell::test
