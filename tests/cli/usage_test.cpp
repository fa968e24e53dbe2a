// What the program says to command lines that make no sense, and to files that are no good.
#include "program.h"

#include <gtest/gtest.h>

namespace snell::test {
namespace {

// One line on stderr, nothing on stdout, no file left behind.
void expect_error(const std::vector<std::string>& arguments, int code, const std::vector<std::string>& words)
{
    Program program;
    const Outcome outcome = program.run(arguments);
    std::string shown;
    for (const std::string& argument : arguments) shown += argument + " ";
    SCOPED_TRACE(shown + "-> " + outcome.err);
    EXPECT_EQ(outcome.code, code) << "signal " << outcome.signal;
    EXPECT_TRUE(outcome.err.starts_with("snell: error: "));
    EXPECT_EQ(line_count(outcome.err), 1u);
    EXPECT_EQ(outcome.out, "");
    for (const std::string& word : words) EXPECT_NE(outcome.err.find(word), std::string::npos) << word;
    EXPECT_TRUE(program.files().empty());
}

TEST(Usage, UnknownWordsNameTheNearestOne)
{
    expect_error({"rendr"}, 2, {"'rendr'", "did you mean 'render'"});
    expect_error({"zzzzzzzzzzzz"}, 2, {"render, view, info, convert, list, compare, probe, camera"});
    expect_error({"--versoin"}, 2, {"'--version'"});
    expect_error({"render", "cornell", "--integratr", "path"}, 2, {"'--integratr'", "'--integrator'"});
    expect_error({"render", "cornell", "--integratr=path"}, 2, {"'--integratr'", "'--integrator'"});
    expect_error({"render", "cornell", "-z"}, 2, {"-z"});
    expect_error({"render", "cornell", "extra"}, 2, {"extra"});
    expect_error({"render", "cornell", "--integrator", "pth"}, 2, {"'pth'", "did you mean 'path'", "whitted"});
    expect_error({"render", "cornell", "--sampler", "sobl"}, 2, {"'sobol'", "independent"});
    expect_error({"render", "cornell", "--accel", "bvhh"}, 2, {"'bvhh'"});
    expect_error({"render", "cornell", "--tone", "acess"}, 2, {"'aces'"});
    expect_error({"render", "cornell", "--triangle-test", "woop"}, 2, {"watertight"});
    expect_error({"render", "cornell", "-D", "max_dpth=3"}, 2, {"'max_depth'"});
    for (const char* device : {"vulkan", "CPU", "gpu:", "gpu:x"})
        expect_error({"render", "cornell", "--device", device}, 2, {"--device", "cpu, gpu, gpu:N or auto"});
    expect_error({"render", "cornell", "--stats=xml"}, 2, {"json"});
    expect_error({"render", "cornel"}, 1, {"cornell"});
    expect_error({"render", "cornell", "--camera", "nosuchcamera"}, 2, {"nosuchcamera"});
    expect_error({"render", "cornell", "--camera", "99"}, 2, {"99"});
    expect_error({"compare", "a.exr", "b.exr", "--metric", "rmse"}, 2, {"'rmse'", "'mse'"});
}

TEST(Usage, MissingValues)
{
    expect_error({"render"}, 2, {"SCENE"});
    expect_error({"render", "cornell", "-o"}, 2, {"-o"});
    expect_error({"render", "cornell", "--spp"}, 2, {"--spp"});
    expect_error({"info"}, 2, {"SCENE"});
    expect_error({"compare"}, 2, {"A"});
    expect_error({"compare", "a.exr"}, 2, {"reference"});
}

TEST(Usage, BadNumbers)
{
    const std::vector<std::vector<std::string>> bad = {
        {"--spp", "0"},
        {"--spp", "-1"},
        {"--spp", "many"},
        {"--spp", "1.5"},
        {"--spp", ""},
        {"--spp", "99999999999999999999"},
        {"--width", "0"},
        {"--height", "100000"},
        {"--size", "640"},
        {"--size", "640x"},
        {"--size", "640x0"},
        {"--size", "4x4x4"},
        {"--eye", "1,2"},
        {"--eye", "1,2,3,4"},
        {"--eye", "1,2,nan"},
        {"--eye", "-1,-2,-inf"},
        {"--target", "1,2,z"},
        {"--fov", "0"},
        {"--fov", "180"},
        {"--fov", "-30"},
        {"--cropwindow", "0,1,0"},
        {"--cropwindow", "0.5,0.5,0,1"},
        {"--cropwindow", "0,2,0,1"},
        {"--pixelbounds", "0,10,0,99999"},
        {"--pixelbounds", "5,4,0,1"},
        {"--pixel", "-1,0"},
        {"--pixel", "512,0"},
        {"--pixel", "1.5,0"},
        {"--threads", "-1"},
        {"--seed", "-1"},
        {"--seed", "4294967296"},
        {"--timeout", "-1"},
        {"--timeout", "soon"},
        {"--exposure", "x"},
        {"--samples-range", "5:5"},
        {"--samples-range", "8"},
        {"--samples-range", "a:b"},
        {"-D", "max_depth"},
        {"-D", "=3"},
        {"-D", "max_depth=2.7"},
        {"-D", "nee=2"},
        {"-D", "mis=0.5"},
        {"-D", "rr=yes"},
    };
    for (const auto& pair : bad) expect_error({"render", "cornell", pair[0], pair[1]}, 2, {pair[0]});
}

TEST(Usage, ErrorsOfNumbersNameTheirLimits)
{
    expect_error({"render", "cornell", "--size", "4x4", "--pixel", "9,9"}, 2, {"9,9", "4x4", "X is from 0 to 3, Y"});
    expect_error({"render", "cornell", "--size", "4x2", "--pixel", "3,2"}, 2, {"X is from 0 to 3, Y from 0 to 1"});
    expect_error({"render", "cornell", "--size", "4x4", "--pixelbounds", "0,9,0,1"}, 2, {"0,9,0,1", "X0,X1,Y0,Y1"});
    for (const char* option : {"--eye", "--target", "--up"})
        expect_error({"render", "cornell", option, "0,-1e30,0"}, 2, {option, "-1e+30 is out of range", "1e+18"});
    expect_error({"render", "cornell", "-D", "max_depth=2.7"}, 2, {"max_depth=2.7", "whole number"});
    expect_error({"render", "cornell", "-D", "nee=2"}, 2, {"nee=2", "neither 0 nor 1"});
    expect_error({"compare", "a.exr", "b.exr", "--threshold", "-1"}, 2, {"--threshold", "-1", "relmse"});
    expect_error({"compare", "a.exr", "b.exr", "--metric", "mse", "--threshold", "-1"}, 2, {"--threshold", "mse"});
    // Decibels may be negative.
    expect_error({"compare", "a.exr", "b.exr", "--metric", "psnr", "--threshold", "-1"}, 1, {"a.exr"});
}

TEST(Usage, OptionsThatExcludeEachOther)
{
    expect_error({"render", "cornell", "--spp", "4", "--samples-range", "0:4"}, 2, {"--spp", "--samples-range"});
    expect_error({"render", "cornell", "--pixel", "1,1", "--cropwindow", "0,1,0,1"}, 2, {"--pixel", "--cropwindow"});
    expect_error({"render", "cornell", "--eye", "1,1,1", "--target", "1,1,1"}, 2, {"same point"});
    expect_error({"render", "cornell", "--up", "0,0,0"}, 2, {"--up"});
}

TEST(Usage, FilesThatAreNoGood)
{
    expect_error({"render", "missing.ply"}, 1, {"missing.ply"});
    expect_error({"info", "missing.obj"}, 1, {"missing.obj"});
    expect_error({"render", "."}, 1, {});
    expect_error({"compare", "missing.exr", "b.exr"}, 1, {"missing.exr"});
}

TEST(Usage, UnreadableOrBrokenScenesLeaveNothingBehind)
{
    Program program;
    program.write("truncated.ply", "ply\nformat binary_little_endian 1.0\nelement vertex 1000000\nproperty float x\n"
                                   "property float y\nproperty float z\nend_header\nabc");
    program.write("garbage.stl", "\x01\x02\x03");
    // Not even root can read this one from its beginning.
    std::filesystem::create_symlink("/proc/self/mem", program.folder() / "unreadable.ply");
    const std::size_t before = program.files().size();
    for (const char* file : {"truncated.ply", "garbage.stl", "unreadable.ply"}) {
        const Outcome outcome = program.run({"render", file, "--spp", "1", "-o", "out.png"});
        SCOPED_TRACE(outcome.err);
        EXPECT_EQ(outcome.code, 1) << "signal " << outcome.signal;
        EXPECT_EQ(line_count(outcome.err), 1u);
        EXPECT_NE(outcome.err.find(file), std::string::npos);
        EXPECT_EQ(program.files().size(), before);
    }
}

TEST(Usage, OutputsAreCheckedBeforeRendering)
{
    // With that many samples the test would never end if it rendered first.
    const std::vector<std::string> long_render = {"render", "cornell", "--spp", "100000000", "-o"};
    for (const char* output : {"nofolder/out.png", "out.gif", "out", "/proc/out.png", "."}) {
        std::vector<std::string> arguments = long_render;
        arguments.emplace_back(output);
        expect_error(arguments, 1, {});
    }
    expect_error({"render", "cornell", "--spp", "100000000", "-o", "good.png", "-o", "nofolder/bad.png"}, 1,
                 {"nofolder"});
    expect_error({"render", "cornell", "-o", "/proc/out.png"}, 1, {"/proc/out.png", "cannot be created"});
    expect_error({"render", "cornell", "--log-file", "nofolder/log"}, 1, {"nofolder/log"});
}

TEST(Usage, NumbersOfBuiltInScenes)
{
    for (const char* number : {"10", "-1", "2.5", "", "x", "99999999999999999999", "4:4"})
        expect_error({"render", std::string("sphereflake:") + number}, 1, {"sphereflake:DEPTH", "from 0 to 9"});
    expect_error({"render", "menger:7"}, 1, {"'menger:7'", "menger:DEPTH", "from 0 to 6"});
    expect_error({"info", "many-lights:0"}, 1, {"many-lights:COUNT", "from 1 to 1000000"});
    expect_error({"render", "cornell:3"}, 1, {"'cornell' takes no number"});
    expect_error({"render", "sphereflak:3"}, 1, {"did you mean 'sphereflake'?", "sphereflake:DEPTH"});
}

TEST(Usage, Help)
{
    Program program;
    for (const std::vector<std::string>& arguments : {std::vector<std::string>{},
                                                      {"--help"},
                                                      {"-h"},
                                                      {"render", "--help"},
                                                      {"info", "-h"},
                                                      {"list", "--help"},
                                                      {"compare", "--help"}}) {
        const Outcome outcome = program.run(arguments);
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        EXPECT_EQ(outcome.err, "");
        EXPECT_NE(outcome.out.find("snell"), std::string::npos);
        EXPECT_NE(outcome.out.find("Examples"), std::string::npos);
    }
    const std::string compare = program.run({"compare", "--help"}).out;
    EXPECT_NE(compare.find("LIST"), std::string::npos);
    EXPECT_EQ(compare.find("LIST ..."), std::string::npos) << "one list, not several";
    const Outcome version = program.run({"--version"});
    EXPECT_EQ(version.code, 0);
    for (const char* word : {"commit", "built with", "instruction sets"})
        EXPECT_NE(version.out.find(word), std::string::npos) << word;
}

} // namespace
} // namespace snell::test
