#include "tests/io/mesh_files.h"

#include <cstring>

namespace snell {
namespace {

using namespace test;

void append(std::string& bytes, const void* data, std::size_t size)
{
    bytes.append(static_cast<const char*>(data), size);
}

const vec3 tetrahedron[4][3] = {{vec3(0), vec3(0, 1, 0), vec3(1, 0, 0)},
                                {vec3(0), vec3(1, 0, 0), vec3(0, 0, 1)},
                                {vec3(0), vec3(0, 0, 1), vec3(0, 1, 0)},
                                {vec3(1, 0, 0), vec3(0, 1, 0), vec3(0, 0, 1)}};

std::string binary_stl(const char* title = "solid but binary", float normal_sign = 1.0f)
{
    std::string bytes(80, '\0');
    std::memcpy(bytes.data(), title, std::strlen(title));
    const std::uint32_t count = 4;
    append(bytes, &count, 4);
    for (const auto& facet : tetrahedron) {
        const vec3 normal = normal_sign * cross(facet[1] - facet[0], facet[2] - facet[0]);
        append(bytes, &normal, 12);
        for (const vec3& corner : facet) append(bytes, &corner, 12);
        bytes.append(2, '\0');
    }
    return bytes;
}

std::string ascii_stl()
{
    std::string text = "solid a name with spaces\n";
    for (const auto& facet : tetrahedron) {
        text += "  facet normal 0 0 0\r\n    OUTER loop\n";
        for (const vec3& corner : facet)
            text += fmt::format("      vertex {} {:e} {:+}\n", corner.x, corner.y, corner.z);
        text += "    endloop\n  endfacet\n";
    }
    return text + "endsolid a name with spaces\n";
}

void expect_tetrahedron(const Scene& scene)
{
    ASSERT_EQ(scene.meshes.size(), 1u);
    const Mesh& mesh = scene.meshes[0];
    EXPECT_EQ(mesh.triangles.size(), 4u);
    EXPECT_EQ(mesh.positions.size(), 4u); // shared: the surface is closed
    EXPECT_NEAR(mesh_area(mesh), 1.5 + std::sqrt(3.0) / 2, 1e-6);
}

TEST(Stl, BinaryThatSaysSolid)
{
    const Folder folder;
    const Scene scene = load_scene(folder.write("a.stl", binary_stl()));
    expect_tetrahedron(scene);
    EXPECT_TRUE(scene.notes.empty());
    EXPECT_EQ(scene.name, "a");
}

TEST(Stl, AsciiInAnyLetterCaseAndLineEnd)
{
    const Folder folder;
    expect_tetrahedron(load_scene(folder.write("a.STL", ascii_stl())));
    // Several solids are one mesh.
    EXPECT_EQ(triangle_count(load_scene(folder.write("b.stl", ascii_stl() + ascii_stl()))), 8u);
}

TEST(Stl, Utf16)
{
    const Folder folder;
    std::string wide = "\xfe\xff";
    for (const char c : ascii_stl()) wide += '\0', wide += c;
    expect_tetrahedron(load_scene(folder.write("a.stl", wide)));
}

// Several windows of each kind; a grid whose vertices must be found again.
TEST(Stl, LargeFiles)
{
    constexpr int size = 250;
    std::string binary(84, ' '), text = "solid\n";
    const std::uint32_t count = 2 * size * size;
    std::memcpy(binary.data() + 80, &count, 4);
    const auto add = [&](const vec3(&facet)[4]) {
        append(binary, facet, sizeof facet);
        binary.append(2, '\0');
        text += "facet normal 0 0 1\n outer loop\n";
        for (int i = 1; i < 4; ++i) text += fmt::format("  vertex {} {} {}\n", facet[i].x, facet[i].y, facet[i].z);
        text += " endloop\nendfacet\n";
    };
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            const auto at = [&](int i, int k) { return vec3(float(x + i), float(y + k), 0.125f); };
            add({vec3(0, 0, 1), at(0, 0), at(1, 0), at(1, 1)});
            add({vec3(0, 0, 1), at(0, 0), at(1, 1), at(0, 1)});
        }
    const Folder folder;
    for (const auto& file : {folder.write("b.stl", binary), folder.write("t.stl", text + "endsolid\n")}) {
        const Scene scene = load_scene(file);
        EXPECT_TRUE(scene.notes.empty());
        const Mesh& mesh = scene.meshes[0];
        EXPECT_EQ(mesh.triangles.size(), count);
        EXPECT_EQ(mesh.positions.size(), std::size_t{size + 1} * (size + 1));
        EXPECT_NEAR(mesh_area(mesh), size * size, 1e-3);
    }
    // The line of an error behind several windows.
    const std::string bad = text + "facet normal 0 0 one\n";
    EXPECT_NE(load_error(folder.write("bad.stl", bad))
                  .find(fmt::format("bad.stl:{}:18: a normal's coordinate", 2 + 7 * count)),
              std::string::npos);
}

TEST(Stl, NegativeZeroIsTheSamePlace)
{
    const Folder folder;
    std::string text = ascii_stl();
    for (std::size_t at = text.find("vertex 0 "); at != std::string::npos; at = text.find("vertex 0 ", at + 9))
        if (at % 2 == 0) text.replace(at, 9, "vertex -0 ");
    expect_tetrahedron(load_scene(folder.write("a.stl", text)));
}

TEST(Stl, SaysWhenNormalsDisagreeOrBytesAreLeft)
{
    const Folder folder;
    const Scene scene = load_scene(folder.write("a.stl", binary_stl("x", -1.0f) + "more"));
    expect_tetrahedron(scene);
    EXPECT_TRUE(has_note(scene, "4 of 4 facet normals point against the winding"));
    EXPECT_TRUE(has_note(scene, "4 bytes after the last facet"));
}

TEST(Stl, ErrorsSayWhereAndWhat)
{
    const Folder folder;
    const auto error = [&](const std::string& bytes) { return load_error(folder.write("a.stl", bytes)); };
    EXPECT_NE(error(binary_stl().substr(0, 200)).find("4 facets, 284 bytes in all, but the file has only 200"),
              std::string::npos);
    EXPECT_NE(error("").find("0 bytes are too few"), std::string::npos);
    EXPECT_NE(error("solid empty\nendsolid empty\n").find("no facets"), std::string::npos);
    EXPECT_NE(error("solid a\n facet normal 0 0 1\n  outer loop\n   vertex 0 zero 0\n").find("a.stl:4:13: a vertex's"),
              std::string::npos);
    std::string text = ascii_stl();
    EXPECT_NE(error(text.substr(0, text.find("endsolid"))).find("ends without 'endsolid'"), std::string::npos);
    EXPECT_NE(error(text.substr(0, text.find("loop"))).find("the file ends where"), std::string::npos);
    std::string huge = binary_stl();
    std::memset(huge.data() + 80, 0xff, 4);
    EXPECT_NE(error(huge).find("4294967295 facets"), std::string::npos);
}

TEST(Stl, DamagedFilesEndInASceneOrAnError)
{
    damage("damaged.stl", binary_stl());
    damage("damaged.stl", ascii_stl());
}

TEST(Stl, FilesOfTheWorld)
{
    struct Expected
    {
        const char* file;
        std::size_t triangles;
    };
    for (const Expected& e :
         {Expected{"stl/bunny_binary.stl", 69451}, Expected{"stl/gears.stl", 19426},
          Expected{"stl/sphere_ascii.stl", 224}, Expected{"stl/sphere_binary.stl", 224},
          Expected{"stl/stl_ascii/HalfDonut.stl", 288}, Expected{"stl/stl_binary/HalfDonut.stl", 288}})
        if (const auto file = shared_mesh(e.file); !file.empty()) {
            EXPECT_EQ(triangle_count(load_scene(file)), e.triangles) << e.file;
        }
    const auto ascii = shared_mesh("stl/sphere_ascii.stl"), binary = shared_mesh("stl/sphere_binary.stl");
    if (ascii.empty() || binary.empty()) return;
    const Mesh a = load_scene(ascii).meshes[0], b = load_scene(binary).meshes[0];
    // A closed surface of genus 0 has 2 + triangles / 2 vertices (Euler).
    EXPECT_EQ(b.positions.size(), 114u);
    EXPECT_EQ(a.positions.size(), b.positions.size());
    EXPECT_NEAR(mesh_area(a), mesh_area(b), 1e-4);
}

} // namespace
} // namespace snell
