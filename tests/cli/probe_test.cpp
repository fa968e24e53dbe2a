// snell probe: text for people, JSON for programs.
#include "program.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace snell::test {
namespace {

using Json = nlohmann::json;

Json probe(std::vector<std::string> arguments)
{
    Program program;
    arguments.insert(arguments.begin(), "probe");
    arguments.emplace_back("--json");
    const Outcome outcome = program.run(arguments);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_TRUE(program.files().empty());
    return Json::parse(outcome.out);
}

TEST(Probe, JsonAddsUp)
{
    for (const char* integrator : {"path", "whitted"}) {
        const Json json = probe({"whitted", "--size", "64x48", "--pixel", "32,28", "--sample", "5", "--spp", "4",
                                 "--integrator", integrator});
        EXPECT_EQ(json["pixel"], Json::array({32, 28}));
        EXPECT_EQ(json["spp"], 4);
        EXPECT_EQ(json["first_hit"]["object_name"], "bubble, outside");
        const Json& sample = json["sample"];
        EXPECT_EQ(sample["number"], 5);
        EXPECT_EQ(sample["is_exact"], true);
        ASSERT_GE(sample["vertices"].size(), 2u);
        double sum = 0, radiance = 0;
        for (const Json& vertex : sample["vertices"]) {
            sum += vertex["emitted"][0].get<double>();
            for (const Json& light : vertex["lights"])
                if (light["was_traced"] && !light["is_blocked"]) sum += light["value"][0].get<double>();
        }
        radiance = sample["radiance"][0].get<double>();
        EXPECT_GT(radiance, 0.0);
        EXPECT_NEAR(sum, radiance, 1e-5 * radiance);
        for (std::size_t i = 1; i < sample["vertices"].size(); ++i)
            EXPECT_LT(sample["vertices"][i]["parent"].get<std::size_t>(), i);
    }
}

TEST(Probe, TheValueIsThePicturesPixel)
{
    const Json one = probe({"cornell", "--size", "32x32", "--pixel", "10,20", "--spp", "1", "--sample", "0"});
    EXPECT_EQ(one["value"], one["sample"]["radiance"]);
    const Json other = probe({"cornell", "--size", "32x32", "--pixel", "10,20", "--spp", "1", "--seed", "9"});
    EXPECT_NE(one["value"], other["value"]);
}

TEST(Probe, Text)
{
    Program program;
    const Outcome outcome = program.run({"probe", "cornell", "--size", "64x64", "--pixel", "32,40"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    for (const char* word : {"back wall", "'white'", "MIS weight", "diffuse reflection", "throughput", "to the bit"})
        EXPECT_NE(outcome.out.find(word), std::string::npos) << word << "\n" << outcome.out;
    // Of a ray that meets nothing, and of a view.
    const Outcome sky =
        program.run({"probe", "spheres", "--size", "64x64", "--pixel", "32,32", "--eye", "0,1,5", "--target", "0,9,4"});
    EXPECT_EQ(sky.code, 0) << sky.err;
    EXPECT_NE(sky.out.find("escaped from the camera"), std::string::npos) << sky.out;
    const Outcome view = program.run({"probe", "cornell", "--pixel", "3,4", "--integrator", "steps"});
    EXPECT_EQ(view.code, 0) << view.err;
}

TEST(Probe, Usage)
{
    Program program;
    for (const auto& [arguments, word] : std::vector<std::pair<std::vector<std::string>, std::string>>{
             {{"probe", "cornell"}, "--pixel"},
             {{"probe", "cornell", "--pixel", "512,0"}, "X is from 0 to 511"},
             {{"probe", "cornell", "--pixel", "1"}, "--pixel"},
             {{"probe", "cornell", "--pixel", "1,1", "--sample", "-1"}, "--sample"},
             {{"probe", "cornell", "--pixel", "1,1", "--integrator", "pth"}, "did you mean 'path'"}}) {
        const Outcome outcome = program.run(arguments);
        EXPECT_EQ(outcome.code, 2) << outcome.err;
        EXPECT_EQ(line_count(outcome.err), 1u);
        EXPECT_NE(outcome.err.find(word), std::string::npos) << outcome.err;
    }
    EXPECT_EQ(program.run({"probe", "missing.ply", "--pixel", "1,1"}).code, 1);
    const Outcome help = program.run({"probe", "--help"});
    EXPECT_EQ(help.code, 0);
    EXPECT_NE(help.out.find("Examples"), std::string::npos);
}

} // namespace
} // namespace snell::test
