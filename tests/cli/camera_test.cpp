// snell camera: the numbers it prints, and what it says to nonsense.
#include "program.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>

namespace snell::test {
namespace {

nlohmann::json measure(std::vector<std::string> arguments)
{
    arguments.insert(arguments.begin(), "camera");
    arguments.push_back("--json");
    Program program;
    const Outcome outcome = program.run(arguments);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(line_count(outcome.out), 1u);
    return nlohmann::json::parse(outcome.out);
}

TEST(CameraCommand, MeasuresACamera)
{
    const nlohmann::json json = measure({"--fov", "90", "--size", "600x300", "--points", "5"});
    EXPECT_NEAR(json.at("fov_degrees").at("vertical").get<double>(), 90.0, 0.01);
    EXPECT_NEAR(json.at("fov_degrees").at("horizontal").get<double>(), 2 * std::atan(2.0) * 180 / 3.14159265, 0.01);
    EXPECT_LT(json.at("round_trip").at("worst_pixels").get<double>(), 1e-3);
    EXPECT_EQ(json.at("round_trip").at("lost"), 0);
    EXPECT_EQ(json.at("distortion").size(), 5u);
    EXPECT_EQ(measure({"cornell"}).at("camera"), "front");

    Program program;
    const Outcome table = program.run({"camera", "cornell"});
    EXPECT_EQ(table.code, 0);
    EXPECT_NE(table.out.find("field of view"), std::string::npos);
    EXPECT_GT(line_count(table.out), 15u);
}

TEST(CameraCommand, MeasuresLenses)
{
    const nlohmann::json json = measure({"--lens", "double-gauss", "--focus", "2000"});
    EXPECT_NEAR(json.at("focal_length_mm").get<double>(), 50.36, 0.05);
    EXPECT_GT(json.at("film_distance_mm").get<double>(), 37.0); // extended, against 36.1 at infinity
    EXPECT_NEAR(json.at("vignetting")[0].at("light").get<double>(), 1.0, 0.02);
    EXPECT_LT(json.at("vignetting").back().at("light").get<double>(), 0.7);

    Program program;
    const auto file = program.write("simple.txt", "0 1 1 10 # the stop\n100 2 1.5 30\n-100 95 1 30\n");
    const Outcome table = program.run({"camera", "--lens", file.string()});
    EXPECT_EQ(table.code, 0) << table.err;
    EXPECT_NE(table.out.find("focal length   100.3"), std::string::npos) << table.out; // the lensmaker's, 2 mm thick
}

TEST(CameraCommand, NonsenseIsOneLine)
{
    const std::tuple<std::vector<std::string>, int, const char*> cases[] = {
        {{"camera", "--points", "1"}, 2, "--points"},
        {{"camera", "--size", "0x5"}, 2, "--size"},
        {{"camera", "no-such-scene"}, 1, "no-such-scene"},
        {{"camera", "--lens", "no-such-lens"}, 1, "no-such-lens"},
        {{"camera", "--lens", "double-gauss", "--focus", "5"}, 1, "focus farther away"},
        {{"camera", "--lens", "double-gauss", "--film", "-3"}, 2, "--film"},
        {{"camera", "--lens", "broken.txt"}, 1, "broken.txt:2:"},
    };
    for (const auto& [arguments, code, words] : cases) {
        Program program;
        program.write("broken.txt", "100 2 1.5 30\n-100 95 glass 30\n");
        std::vector<std::string> there = arguments;
        if (there.back() == "broken.txt") there.back() = (program.folder() / "broken.txt").string();
        const Outcome outcome = program.run(there);
        SCOPED_TRACE(outcome.err);
        EXPECT_EQ(outcome.code, code);
        EXPECT_EQ(line_count(outcome.err), 1u);
        EXPECT_EQ(outcome.out, "");
        EXPECT_NE(outcome.err.find(words), std::string::npos) << words;
    }
}

} // namespace
} // namespace snell::test
