#include "snell/scene/builtin.h"
#include "tests/io/mesh_files.h"

namespace snell {
namespace {

using namespace test;

std::string open_error(const std::string& name)
{
    try {
        open_scene(name);
    } catch (const Error& error) {
        return error.what();
    }
    return {};
}

TEST(Load, ByEndingInAnyLetterCase)
{
    const Folder folder;
    const auto file = folder.write("a.ObJ", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    EXPECT_EQ(triangle_count(load_scene(file)), 1u);
    EXPECT_EQ(triangle_count(open_scene(file.string())), 1u);
    EXPECT_EQ(open_scene(file.string()).name, "a");
}

TEST(Load, BuiltInScenesComeFirst)
{
    const std::string name(builtin_scenes()[0].name);
    const Scene scene = open_scene(name);
    EXPECT_FALSE(scene.groups.empty() && scene.planes.empty());
}

TEST(Load, ErrorsSayWhatToDo)
{
    const Folder folder;
    const auto file = folder.write("a.blend", "BLENDER");
    EXPECT_NE(load_error(file).find(
                  "'.blend' cannot be read; give a file that ends in .gltf, .glb, .pbrt, .obj, .ply or .stl"),
              std::string::npos);
    EXPECT_NE(load_error(file.parent_path()).find("is a folder"), std::string::npos);
    for (const char* missing : {"none.obj", "none.ply", "none.stl", "none.xyz", "none"})
        EXPECT_NE(load_error(file.parent_path() / missing).find("no such file"), std::string::npos) << missing;
    EXPECT_NE(open_error("cornel").find("did you mean 'cornell'?"), std::string::npos);
    EXPECT_NE(open_error("xyzzy").find("the built-in scenes are: "), std::string::npos);
    EXPECT_NE(open_error("nowhere/dragon.ply").find("nowhere/dragon.ply: no such file"), std::string::npos);
}

} // namespace
} // namespace snell
