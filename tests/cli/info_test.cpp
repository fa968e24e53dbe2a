// snell info: the scene report as people and programs read it.
#include "program.h"
#include "scene_files.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <set>

namespace snell::test {
namespace {

using nlohmann::json;

// A closed tetrahedron of glass, or without its last face an open one.
void write_glass(Program& program, const std::string& name, bool open)
{
    program.write("glass.mtl", "newmtl glass\nillum 7\nNi 1.5\nTf 1 1 1\nd 0.0\nKd 0 0 0\nKs 0 0 0\n");
    program.write(name, std::string("mtllib glass.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nusemtl glass\n"
                                    "f 1 3 2\nf 1 2 4\nf 1 4 3\n") +
                            (open ? "" : "f 2 3 4\n"));
}

json info_of(Program& program, const std::vector<std::string>& arguments)
{
    std::vector<std::string> all = {"info", "--json"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const Outcome outcome = program.run(all);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(line_count(outcome.out), 1u);
    return json::parse(outcome.out, nullptr, false);
}

std::set<std::string> kinds_of(const json& info, const std::string& severity)
{
    std::set<std::string> kinds;
    for (const json& finding : info.at("findings"))
        if (finding.at("severity") == severity) kinds.insert(finding.at("kind").get<std::string>());
    return kinds;
}

TEST(Info, JsonHasAllItsKeysForAnyScene)
{
    Program program;
    const json info = info_of(program, {"cornell"});
    for (const char* key : {"scene",
                            "meshes",
                            "triangles",
                            "spheres",
                            "planes",
                            "groups",
                            "instances",
                            "mirrored_instances",
                            "placed_triangles",
                            "placed_spheres",
                            "materials",
                            "materials_by_kind",
                            "textures",
                            "lights",
                            "lights_by_kind",
                            "environment",
                            "environment_image",
                            "nodes",
                            "skins",
                            "deforming_meshes",
                            "morph_targets",
                            "bounds",
                            "bytes",
                            "seconds",
                            "counts",
                            "cameras",
                            "texture_list",
                            "animations",
                            "variants",
                            "hints",
                            "notes",
                            "findings"})
        EXPECT_TRUE(info.contains(key)) << key;
    EXPECT_EQ(info.size(), 32u) << "document new keys in docs/info.md and name them here";
    for (const char* key : {"scene", "textures", "packed", "accel_forecast", "peak_forecast"})
        EXPECT_TRUE(info.at("bytes").at(key).is_number_unsigned()) << key;
    for (const char* key : {"info", "repaired", "doubtful", "error"})
        EXPECT_TRUE(info.at("counts").at(key).is_number_unsigned()) << key;
    EXPECT_EQ(info.at("lights_by_kind").at("triangle"), info.at("lights"));
    EXPECT_EQ(info.at("cameras").at(0).size(), 6u);
}

TEST(Info, FindingsAreThereInJsonAndText)
{
    Program program;
    write_glass(program, "open.obj", true);
    write_glass(program, "closed.obj", false);
    const json open = info_of(program, {"open.obj"});
    EXPECT_EQ(kinds_of(open, "doubtful"), std::set<std::string>{"open-glass"}) << open;
    EXPECT_EQ(open.at("counts").at("doubtful"), 1);
    for (const json& finding : open.at("findings")) {
        if (finding.at("kind") != "open-glass") continue;
        EXPECT_EQ(finding.at("count"), 3);
    }
    EXPECT_EQ(kinds_of(info_of(program, {"closed.obj"}), "doubtful"), std::set<std::string>{});

    const Outcome text = program.run({"info", "open.obj"});
    EXPECT_EQ(text.code, 0);
    EXPECT_NE(text.out.find("\ndoubtful  mesh"), std::string::npos) << text.out;
    EXPECT_NE(text.out.find("3 edges open"), std::string::npos) << text.out;
    EXPECT_TRUE(text.out.ends_with("\n0 repaired, 1 doubtful\n")) << text.out;
    // The doubts come last, after what is only worth knowing.
    EXPECT_LT(text.out.find("\ninfo "), text.out.find("\ndoubtful "));

    const Outcome quiet = program.run({"info", "open.obj", "-q"});
    EXPECT_EQ(quiet.code, 0);
    EXPECT_EQ(quiet.out.find("doubtful"), std::string::npos);
}

TEST(Info, StrictFailsOnDoubtsOnly)
{
    Program program;
    write_glass(program, "open.obj", true);
    write_glass(program, "closed.obj", false);
    program.write("flat.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 2\n");
    EXPECT_EQ(program.run({"info", "open.obj", "--strict"}).code, 1);
    EXPECT_EQ(program.run({"info", "open.obj", "--strict", "--json"}).code, 1);
    EXPECT_EQ(program.run({"info", "closed.obj", "--strict"}).code, 0);
    const Outcome repaired = program.run({"info", "flat.obj", "--strict"});
    EXPECT_EQ(repaired.code, 0) << repaired.out;
    EXPECT_TRUE(repaired.out.ends_with("\n1 repaired, 0 doubtful\n")) << repaired.out;
}

TEST(Info, OfManyFindingsOfAKindSomeAreShown)
{
    Program program;
    write_glass(program, "unused.obj", true);
    std::string text = "mtllib glass.mtl\n";
    for (int i = 0; i < 30; ++i) {
        for (const char* corner : {"0 0", "1 0", "0 1"}) text += "v " + std::to_string(3 * i) + " " + corner + "\n";
        text += "o pane" + std::to_string(i) + "\nusemtl glass\nf -1 -2 -3\n";
    }
    program.write("panes.obj", text);
    const auto shown = [&](const std::vector<std::string>& arguments) {
        const Outcome outcome = program.run(arguments);
        std::size_t count = 0;
        for (std::size_t at = 0; (at = outcome.out.find("edges open", at)) != std::string::npos; ++at) ++count;
        EXPECT_NE(outcome.out.find(" 30 doubtful"), std::string::npos) << outcome.out;
        return count;
    };
    EXPECT_EQ(shown({"info", "panes.obj"}), 5u);
    EXPECT_EQ(shown({"info", "panes.obj", "-v"}), 20u);
    const json info = info_of(program, {"panes.obj"});
    EXPECT_EQ(info.at("counts").at("doubtful"), 30);
    std::size_t edges = 0; // those that are not listed have a finding together
    for (const json& finding : info.at("findings"))
        if (finding.at("kind") == "open-glass") edges += finding.at("count").get<std::size_t>();
    EXPECT_EQ(edges, 90u);
}

TEST(Info, ListsAnimationsAndCameras)
{
    Program program;
    program.write("moving.gltf", moving_lamp());
    const json info = info_of(program, {"moving.gltf"});
    ASSERT_EQ(info.at("animations").size(), 3u);
    EXPECT_EQ(info.at("animations").at(1).at("name"), "back");
    EXPECT_EQ(info.at("animations").at(0).at("seconds"), 2.0);
    const Outcome text = program.run({"info", "moving.gltf"});
    EXPECT_NE(text.out.find("--animation 1"), std::string::npos) << text.out;
    EXPECT_NE(text.out.find("--eye "), std::string::npos) << text.out;
}

TEST(Info, ListsVariantsAndTakesOne)
{
    Program program;
    program.write("lamp.gltf", coloured_lamp());
    EXPECT_EQ(info_of(program, {"lamp.gltf"}).at("variants"), json::array({"red", "green"}));
    EXPECT_EQ(info_of(program, {"lamp.gltf", "--variant", "green"}).at("variants").size(), 2u);
    const Outcome text = program.run({"info", "lamp.gltf"});
    EXPECT_NE(text.out.find("--variant green\n"), std::string::npos) << text.out;
    const Outcome wrong = program.run({"info", "lamp.gltf", "--variant", "blue"});
    EXPECT_EQ(wrong.code, 1);
    EXPECT_NE(wrong.err.find("red, green"), std::string::npos) << wrong.err;
}

TEST(Info, NamesFromFilesCannotDriveTheTerminal)
{
    Program program;
    program.write("odd.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\no \x1b[31mred\nf 1 2 2\nf 1 2 3\n");
    const Outcome outcome = program.run({"info", "odd.obj"});
    EXPECT_EQ(outcome.code, 0);
    EXPECT_EQ(outcome.out.find('\x1b'), std::string::npos);
    EXPECT_NE(outcome.out.find("1 repaired"), std::string::npos) << outcome.out;
}

} // namespace
} // namespace snell::test
