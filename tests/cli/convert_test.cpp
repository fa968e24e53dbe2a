// snell convert: what it writes renders the same, and what it does not touch.
#include "program.h"
#include "scene_files.h"

#include "snell/io/image/read.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

namespace snell::test {
namespace {

#define EXPECT_SAYS(text, part) EXPECT_NE(std::string(text).find(part), std::string::npos) << (text)

class Convert : public ::testing::Test
{
  protected:
    Outcome convert(std::vector<std::string> arguments)
    {
        arguments.insert(arguments.begin(), "convert");
        return program.run(arguments);
    }

    std::vector<vec3> pixels(std::vector<std::string> arguments)
    {
        arguments.insert(arguments.begin(), "render");
        for (const char* word : {"--size", "24x16", "--spp", "2", "-o", "picture.pfm"}) arguments.emplace_back(word);
        const Outcome outcome = program.run(arguments);
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        return outcome.code == 0 ? read_picture(program.folder() / "picture.pfm").pixels : std::vector<vec3>{};
    }

    std::string text(const std::string& name) const
    {
        std::ifstream in(program.folder() / name, std::ios::binary);
        return {std::istreambuf_iterator<char>(in), {}};
    }

    Program program;
};

TEST_F(Convert, ABuiltInSceneRendersTheSame)
{
    const Outcome outcome = convert({"spheres", "spheres.pbrt"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_SAYS(outcome.err, "wrote spheres.pbrt");
    EXPECT_EQ(program.files(), (std::vector<std::string>{"spheres.pbrt", "spheres_meshes", "spheres_textures"}));
    EXPECT_EQ(pixels({"spheres"}), pixels({"spheres.pbrt"}));
    // Once more over the first: it is ours.
    EXPECT_EQ(convert({"spheres", "spheres.pbrt"}).code, 0);
}

TEST_F(Convert, TakesAMomentAndAVariant)
{
    program.write("lamp.gltf", moving_lamp());
    const Outcome outcome = convert({"lamp.gltf", "late.pbrt", "--time", "1.5"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_SAYS(outcome.err, "as it stands at this moment");
    const std::vector<vec3> late = pixels({"late.pbrt"});
    EXPECT_EQ(late, pixels({"lamp.gltf", "--time", "1.5"}));
    EXPECT_NE(late, pixels({"lamp.gltf"}));

    program.write("colour.gltf", coloured_lamp());
    ASSERT_EQ(convert({"colour.gltf", "green.pbrt", "--variant", "green"}).code, 0);
    EXPECT_EQ(pixels({"green.pbrt"}), pixels({"colour.gltf", "--variant", "green"}));
    EXPECT_NE(pixels({"green.pbrt"}), pixels({"colour.gltf"}));
}

TEST_F(Convert, RefusesWhatItShouldNotWrite)
{
    const auto refused = [&](const std::vector<std::string>& arguments, int code, const std::string& word) {
        const std::vector<std::string> before = program.files();
        const Outcome outcome = convert(arguments);
        EXPECT_EQ(outcome.code, code) << outcome.err;
        EXPECT_EQ(line_count(outcome.err), 1u) << outcome.err;
        EXPECT_SAYS(outcome.err, word);
        EXPECT_EQ(program.files(), before);
    };
    program.write("mine.pbrt", "WorldBegin Shape \"sphere\"");
    refused({"cornell", "mine.pbrt"}, 1, "has written");
    EXPECT_EQ(text("mine.pbrt"), "WorldBegin Shape \"sphere\"");
    refused({"mine.pbrt", "mine.pbrt"}, 2, "while it is read");
    refused({"cornell", "cornell.obj"}, 2, ".pbrt");
    refused({"cornell", "nowhere/cornell.pbrt"}, 1, "nowhere");
    refused({"cornell"}, 2, "OUTPUT");
    program.write("a_textures", "no folder");
    refused({"cornell", "a.pbrt"}, 1, "a_textures");
    refused({"missing.obj", "b.pbrt"}, 1, "missing.obj");
    EXPECT_EQ(convert({"cornell", "mine.pbrt", "--overwrite"}).code, 0);
    EXPECT_EQ(pixels({"cornell"}), pixels({"mine.pbrt"}));
}

} // namespace
} // namespace snell::test
