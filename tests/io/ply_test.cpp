#include "tests/io/mesh_files.h"

#include <algorithm>
#include <cstring>
#include <initializer_list>

namespace snell {
namespace {

using namespace test;

// Bytes of a binary body.
class Bytes
{
  public:
    explicit Bytes(bool is_big) : is_big_(is_big) {}

    template <class T>
    Bytes& add(T value)
    {
        char raw[sizeof(T)];
        std::memcpy(raw, &value, sizeof(T));
        if (is_big_) std::reverse(raw, raw + sizeof(T));
        bytes.append(raw, sizeof(T));
        return *this;
    }

    std::string bytes;

  private:
    bool is_big_;
};

const char* const square_header = "ply\nformat {} 1.0\ncomment made by a test\nelement vertex 4\nproperty float x\n"
                                  "property double y\nproperty short z\nproperty float confidence\n"
                                  "property uchar red\nproperty uchar green\nproperty uchar blue\n"
                                  "property float nx\nproperty float ny\nproperty float nz\n"
                                  "property float s\nproperty float t\n"
                                  "element edge 1\nproperty int a\nproperty list uchar double b\n"
                                  "element face 2\nproperty uchar flags\nproperty list uint ushort vertex_index\n"
                                  "property list uchar float texcoord\nend_header\n";

// A unit square as a quad and, once more, as a triangle, with all that may be around it.
std::string square(const std::string& format)
{
    const float corners[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    std::string header = fmt::format(fmt::runtime(square_header), format);
    if (format == "ascii") {
        for (const auto& c : corners)
            header += fmt::format("{} {} 3 0.5 255 128 0 0 0 1 {} {}\n", c[0], c[1], c[0], c[1]);
        return header + "7 2 0.5 0.25\n1 4 0 1 2 3 0\n0 3 0 1 2 2 0.5 0.5\n";
    }
    Bytes body(format == "binary_big_endian");
    for (const auto& c : corners) {
        body.add(c[0]).add(static_cast<double>(c[1])).add(std::int16_t{3}).add(0.5f);
        body.add(std::uint8_t{255}).add(std::uint8_t{128}).add(std::uint8_t{0});
        body.add(0.0f).add(0.0f).add(1.0f).add(c[0]).add(c[1]);
    }
    body.add(7).add(std::uint8_t{2}).add(0.5).add(0.25);
    body.add(std::uint8_t{1}).add(4u);
    for (std::uint16_t i = 0; i < 4; ++i) body.add(i);
    body.add(std::uint8_t{0}).add(std::uint8_t{0}).add(3u);
    for (std::uint16_t i = 0; i < 3; ++i) body.add(i);
    body.add(std::uint8_t{2}).add(0.5f).add(0.5f);
    return header + body.bytes;
}

const std::string triangle =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

std::string replaced(std::string text, const std::string& from, const std::string& to)
{
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
}

TEST(Ply, AllFormatsWithEverythingInThem)
{
    const Folder folder;
    for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
        SCOPED_TRACE(format);
        const Scene scene = load_scene(folder.write("square.ply", square(format)));
        ASSERT_EQ(scene.meshes.size(), 1u);
        const Mesh& mesh = scene.meshes[0];
        ASSERT_EQ(mesh.positions.size(), 4u);
        EXPECT_EQ(mesh.positions[2], vec3(1, 1, 3));
        EXPECT_EQ(mesh.triangles.size(), 3u);
        EXPECT_NEAR(mesh_area(mesh), 1.5, 1e-6);
        ASSERT_EQ(mesh.normals.size(), 4u);
        EXPECT_EQ(mesh.normals[1], vec3(0, 0, 1));
        ASSERT_EQ(mesh.uvs.size(), 4u);
        EXPECT_EQ(mesh.uvs[2], vec2(1, 1));
        ASSERT_EQ(mesh.colors.size(), 4u);
        EXPECT_FLOAT_EQ(mesh.colors[0].x, 1.0f);
        EXPECT_NEAR(mesh.colors[0].y, 0.2158605f, 1e-5f); // byte 128 by the sRGB curve
        EXPECT_EQ(mesh.colors[0].z, 0.0f);
        EXPECT_EQ(scene.materials.at(0).base_color, vec3(1.0f));
        EXPECT_TRUE(has_note(scene, "not used: confidence, edge, face's flags"));
    }
}

TEST(Ply, Dialects)
{
    const Folder folder;
    const auto load = [&](const std::string& text) { return load_scene(folder.write("a.ply", text)); };
    EXPECT_EQ(load(triangle).materials.at(0).base_color, vec3(0.8f));

    std::string windows;
    for (const char c : triangle) windows += c == '\n' ? std::string("\r\n") : std::string(1, c);
    EXPECT_EQ(triangle_count(load(windows)), 1u);
    std::string mac = triangle;
    std::replace(mac.begin(), mac.end(), '\n', '\r');
    EXPECT_EQ(triangle_count(load(mac)), 1u);
    // A binary body that begins with a line feed after a header with Windows' line ends.
    std::string header = replaced(replaced(windows.substr(0, windows.find("0 0 0")), "ascii", "binary_little_endian"),
                                  "property list uchar int", "property list uchar uchar");
    const float numbers[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    std::string body(reinterpret_cast<const char*>(numbers), sizeof numbers);
    body[0] = '\n'; // a tiny x
    EXPECT_EQ(triangle_count(load(header + body + std::string("\3\0\1\2", 4))), 1u);

    // Numbers as people and programs write them.
    const Scene scene = load(replaced(triangle, "1 0 0\n", "+1.0e0   -0. .0\n"));
    EXPECT_EQ(scene.meshes[0].positions[1], vec3(1, 0, 0));
    // Float colours are linear; names of other exporters.
    const Scene colored =
        load("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
             "property float red\nproperty float green\nproperty float blue\n"
             "property float texture_u\nproperty float texture_v\n"
             "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
             "0 0 0 .5 .25 1 .1 .2\n1 0 0 0 0 0 0 0\n0 1 0 0 0 0 0 0\n3 0 1 2\n");
    EXPECT_EQ(colored.meshes[0].colors.at(0), vec4(0.5f, 0.25f, 1.0f, 1.0f));
    EXPECT_EQ(colored.meshes[0].uvs.at(0), vec2(0.1f, 0.2f));
}

TEST(Ply, PolygonsAndFacesBeforeVertices)
{
    const Folder folder;
    const Scene scene = load_scene(
        folder.write("a.ply", "ply\nformat ascii 1.0\nelement face 3\nproperty list uchar int vertex_indices\n"
                              "element vertex 6\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
                              "6 0 1 2 3 4 5\n2 0 1\n0\n"
                              "0 0 0\n3 0 0\n3 1 0\n1 1 0\n1 3 0\n0 3 0\n"));
    EXPECT_EQ(scene.meshes[0].triangles.size(), 4u);
    EXPECT_NEAR(mesh_area(scene.meshes[0]), 5.0, 1e-6); // an L: a fan would have more
    EXPECT_TRUE(has_note(scene, "2 faces have less than three vertices"));
}

std::string wedge_file(const std::string& comments, const std::string& faces, const char* texnumber = "")
{
    return "ply\nformat ascii 1.0\n" + comments +
           "element vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 2\n"
           "property list uchar int vertex_indices\nproperty list uchar float texcoord\n" +
           texnumber + "end_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n" + faces;
}

TEST(Ply, TextureCoordinatesByCorner)
{
    const Folder folder;
    // The triangles agree about vertex 0, not about vertex 2.
    const Mesh mesh = load_scene(folder.write("a.ply", wedge_file("", "3 0 1 2 6 .5 .5 1 0 1 1\n"
                                                                      "3 0 2 3 6 .5 .5 .25 1 0 1\n")))
                          .meshes[0];
    ASSERT_EQ(mesh.positions.size(), 5u);
    ASSERT_EQ(mesh.uvs.size(), 5u);
    EXPECT_EQ(mesh.triangles[0].x, mesh.triangles[1].x);
    EXPECT_EQ(mesh.uvs[mesh.triangles[0].z], vec2(1, 1));
    EXPECT_EQ(mesh.uvs[mesh.triangles[1].y], vec2(0.25f, 1));
    EXPECT_EQ(mesh.positions[mesh.triangles[0].z], mesh.positions[mesh.triangles[1].y]);
    // A quad, and a face without coordinates.
    const Mesh mixed =
        load_scene(folder.write("a.ply", wedge_file("", "4 0 1 2 3 8 0 0 1 0 1 1 0 1\n3 0 1 2 0\n"))).meshes[0];
    EXPECT_EQ(mixed.triangles.size(), 3u);
    EXPECT_EQ(mixed.positions.size(), 7u);
    // None at all: vertices stay as they were.
    const Mesh none_given = load_scene(folder.write("a.ply", wedge_file("", "4 0 1 2 3 0\n3 0 1 2 0\n"))).meshes[0];
    EXPECT_EQ(none_given.positions.size(), 4u);
    EXPECT_TRUE(none_given.uvs.empty());
}

TEST(Ply, TexturesNamedByComments)
{
    const Folder folder;
    const std::string tga("\0\0\2\0\0\0\0\0\0\0\0\0\1\0\1\0\x18\0\0\0\xff", 21);
    folder.write("red one.tga", tga);
    const std::string comments = "comment TextureFile red one.tga\ncomment TextureFile lost.png\n";
    const Scene scene = load_scene(
        folder.write("a.ply", wedge_file(comments, "3 0 1 2 6 0 0 1 0 1 1 1\n4 0 1 2 3 8 0 0 1 0 1 1 0 1 0\n",
                                         "property int texnumber\n")));
    ASSERT_EQ(scene.materials.size(), 2u);
    const Mesh& mesh = scene.meshes[0];
    ASSERT_EQ(mesh.triangle_materials.size(), 3u);
    EXPECT_EQ(scene.materials[mesh.triangle_materials[0].value].name, "lost.png");
    EXPECT_EQ(scene.materials[mesh.triangle_materials[2].value].name, "red one.tga");
    EXPECT_EQ(scene.images[scene.materials[0].base_texture.image.value].width, 1u);
    EXPECT_EQ(scene.images[scene.materials[1].base_texture.image.value].width, 8u);
    EXPECT_TRUE(has_note(scene, "lost.png: no such file; check the path; a magenta checkerboard"));
}

TEST(Ply, HeaderInAnyOrderAndUtf16)
{
    const Folder folder;
    const std::string odd = "ply\nobj_info made in a hurry\nelement vertex 3\nproperty float z\nproperty uchar alpha\n"
                            "comment y comes before x\nproperty double y\nproperty uchar blue\nproperty uchar green\n"
                            "property uchar red\nproperty int x\nelement face 1\n"
                            "property list int int vertex_index\nformat ascii 1.0\nend_header\n"
                            "7 51 0 0 0 255 0\n7 51 0 0 0 255 1\n7 51 1 0 0 255 0 3 0 1 2";
    const Mesh mesh = load_scene(folder.write("a.ply", odd)).meshes[0];
    EXPECT_EQ(mesh.positions[1], vec3(1, 0, 7));
    ASSERT_EQ(mesh.colors.size(), 3u);
    EXPECT_NEAR(mesh.colors[0].w, 0.2f, 1e-6f);
    EXPECT_EQ(mesh.colors[0].x, 1.0f);
    std::string wide = "\xff\xfe";
    for (const char c : odd) wide += c, wide += '\0';
    EXPECT_EQ(triangle_count(load_scene(folder.write("a.ply", wide))), 1u);
}

// Large files come in several windows, and faces of several sizes in several batches.
TEST(Ply, LargeFilesOfMixedFaces)
{
    constexpr int width = 300;
    const Folder folder;
    for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
        SCOPED_TRACE(format);
        const bool is_ascii = std::string(format) == "ascii";
        std::size_t faces = 0;
        Bytes body(std::string(format) == "binary_big_endian");
        std::string text;
        for (int y = 0; y <= width; ++y)
            for (int x = 0; x <= width; ++x) {
                if (is_ascii)
                    text += fmt::format("{} {} 0 0.125\n", x, y);
                else
                    body.add(static_cast<float>(x)).add(static_cast<float>(y)).add(0.0f).add(0.125);
            }
        for (int y = 0; y < width; ++y)
            for (int x = 0; x < width; ++x) {
                const int a = y * (width + 1) + x, b = a + 1, c = b + width + 1, d = c - 1;
                const auto add = [&](std::initializer_list<int> corners) {
                    ++faces;
                    if (is_ascii) {
                        text += fmt::format("{} {}\n", corners.size(), fmt::join(corners, " "));
                        return;
                    }
                    body.add(static_cast<std::uint8_t>(corners.size()));
                    for (const int corner : corners) body.add(corner);
                };
                // Rows of quads, rows of triangles, and rows where they alternate.
                if (y % 3 == 0 || (y % 3 == 1 && x % 2 == 0))
                    add({a, b, c, d});
                else
                    add({a, b, c}), add({a, c, d});
            }
        const std::string header =
            fmt::format("ply\nformat {} 1.0\nelement vertex {}\nproperty float x\nproperty float y\n"
                        "property float z\nproperty double w\nelement face {}\n"
                        "property list uchar int vertex_indices\nend_header\n",
                        format, (width + 1) * (width + 1), faces);
        const std::string bytes = header + (is_ascii ? text : body.bytes);
        const Mesh mesh = load_scene(folder.write("a.ply", bytes)).meshes[0];
        EXPECT_EQ(mesh.triangles.size(), std::size_t{2} * width * width);
        EXPECT_NEAR(mesh_area(mesh), width * width, 1e-3);
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i) ASSERT_EQ(triangle_normal(mesh, i), vec3(0, 0, 1));
        EXPECT_NE(load_error(folder.write("b.ply", bytes.substr(0, bytes.size() - 14))), "");
    }
}

TEST(Ply, WrongIndexInALargeBinaryFileIsFoundWhereItIs)
{
    const Folder folder;
    Bytes body(false);
    for (int i = 0; i < 9; ++i) body.add(static_cast<float>(i % 4));
    constexpr int count = 20000, wrong = 15000;
    for (int i = 0; i < count; ++i) body.add(std::uint8_t{3}).add(0).add(1).add(i == wrong ? 3 : 2);
    const std::string header = fmt::format(
        "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        count);
    const std::size_t at = header.size() + 36 + 13 * (wrong + 1);
    EXPECT_NE(load_error(folder.write("a.ply", header + body.bytes))
                  .find(fmt::format("vertex 3 is referred to, but there are 3, counted from 0, at byte {}", at)),
              std::string::npos);
}

TEST(Ply, TriangleStrips)
{
    const Folder folder;
    const Scene scene = load_scene(folder.write(
        "a.ply", "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
                 "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
                 "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n9 0 1 2 3 4 -1 0 1 2\n"));
    const Mesh& mesh = scene.meshes[0];
    ASSERT_EQ(mesh.triangles.size(), 4u);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(triangle_normal(mesh, i), vec3(0, 0, 1)) << i;
}

TEST(Ply, NumbersThatAreNotFiniteDropTheirTriangles)
{
    const Folder folder;
    const std::string text = replaced(replaced(triangle, "vertex 3", "vertex 4"), "face 1", "face 2");
    const Scene scene =
        load_scene(folder.write("a.ply", replaced(text, "3 0 1 2", "nan 1e999 -inf\n3 0 1 2\n3 0 1 3")));
    EXPECT_EQ(triangle_count(scene), 1u);
    EXPECT_FALSE(scene.notes.empty());
}

TEST(Ply, ErrorsSayWhereAndWhat)
{
    const Folder folder;
    const auto error = [&](const std::string& bytes) { return load_error(folder.write("a.ply", bytes)); };
    const auto expect = [&](const std::string& bytes, std::string_view part) {
        const std::string text = error(bytes);
        EXPECT_NE(text.find(part), std::string::npos) << "got: " << text << "\nwanted: " << part;
    };
    expect("", "a.ply:1:1: does not begin with 'ply'");
    expect("plywood\n", "does not begin with 'ply'");
    expect("ply\nformat ascii 1.0\n", "no 'end_header'");
    expect(replaced(triangle, "ascii", "utf8"), "a.ply:2: unknown format 'utf8'");
    expect(replaced(triangle, "1.0", "2.0"), "a.ply:2: unknown version");
    expect(replaced(triangle, "format ascii 1.0\n", ""), "no 'format' line");
    expect(replaced(triangle, "vertex 3", "vertex three"), "a.ply:3: an element's line");
    expect(replaced(triangle, "float y", "half y"), "a.ply:5: 'half' is not a type");
    expect(replaced(triangle, "float y", "float x"), "a.ply:5: a second property 'x'");
    expect(replaced(triangle, "element face", "element vertex"), "a.ply:7: a second element");
    expect(replaced(triangle, "uchar int", "float int"), "length is of no integer type");
    expect(replaced(triangle, "uchar int", "uchar float"), "vertex_indices are of no integer type");
    expect(replaced(triangle, "float z", "float zz"), "no x, y and z");
    expect(replaced(triangle, "vertex_indices", "indices"), "no list vertex_indices");
    expect(replaced(triangle, "vertex 3", "vertex 3000000000"), "announces 3000000000 rows of 'vertex'");
    expect(replaced(triangle, "vertex 3", "vertex 99999999999999999999"), "the count is '99999999999999999999'");
    expect(replaced(triangle, "vertex 3", "vertex 4"), "a list of 2 values, which"); // a row of numbers too few
    expect(replaced(triangle, "1 0 0\n", "1 zero 0\n"), "a.ply:11:3: a number should be here, but there is 'zero'");
    expect(replaced(triangle, "3 0 1 2", "3 0 1 3"), "vertex 3 is referred to, but there are 3");
    expect(replaced(triangle, "3 0 1 2", "3 0 1 -1"), "vertex -1 is referred to");
    expect(replaced(triangle, "3 0 1 2", "-3 0 1 2"), "a list of -3 values");
    expect(replaced(triangle, "3 0 1 2", "300000000 0 1 2"), "a list of 300000000 values");
    expect(replaced(replaced(triangle, "face 1", "face 0"), "3 0 1 2\n", ""), "3 points, but no faces");
    const std::string binary = square("binary_little_endian");
    expect(binary.substr(0, binary.size() - 1),
           fmt::format("a list of 2 values, which the rest of the file cannot hold, at byte {}", binary.size() - 8));
    expect(binary.substr(0, binary.size() - 60), "rows of");
}

TEST(Ply, ElementsWithoutPropertiesTakeNoTime)
{
    const Folder folder;
    const Scene scene = load_scene(
        folder.write("a.ply", replaced(triangle, "element face", "element ghost 18446744073709551615\nelement face")));
    EXPECT_EQ(triangle_count(scene), 1u);
}

TEST(Ply, DamagedFilesEndInASceneOrAnError)
{
    for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"})
        damage("damaged.ply", square(format));
}

TEST(Ply, FilesOfTheWorld)
{
    struct Expected
    {
        const char* file;
        std::size_t triangles;
        float width;
    };
    for (const Expected& e :
         {Expected{"stanford_bunny/bun_zipper.ply", 69451, 0.1557f},
          Expected{"stanford_dragon/dragon_vrip_res2.ply", 202520, 0.2046f},
          Expected{"stanford_lucy/lucy.ply", 99970, 930.5f}, Expected{"utah_teapot/teapot.ply", 6320, 4.0f},
          Expected{"ply/icosahedron.ply", 20, 1.7888f}, Expected{"ply/icosahedron_ascii.ply", 20, 1.7888f},
          Expected{"ply/sofa.ply", 24104, 2076.0f}})
        if (const auto file = shared_mesh(e.file); !file.empty()) {
            const Scene scene = load_scene(file);
            EXPECT_EQ(triangle_count(scene), e.triangles) << e.file;
            EXPECT_NEAR(scene_bounds(scene).extent().x, e.width, 1e-3f * e.width) << e.file;
        }
}

TEST(Ply, OneMeshInThreeFormats)
{
    const auto ascii = shared_mesh("ply/platonic_shelf/platonic_shelf_ascii.ply");
    if (ascii.empty()) return;
    const Mesh mesh = load_scene(ascii).meshes[0];
    EXPECT_EQ(mesh.triangles.size(), 80u); // 4 + 6 * 2 + 8 + 12 * 3 + 20: the five solids
    for (const char* name :
         {"ply/platonic_shelf/platonic_shelf.ply", "ply/platonic_shelf/platonic_shelf_big_endian.ply"}) {
        const Mesh other = load_scene(shared_mesh(name)).meshes[0];
        EXPECT_EQ(other.triangles, mesh.triangles) << name;
        ASSERT_EQ(other.positions.size(), mesh.positions.size());
        // The ASCII file has six digits.
        for (std::size_t i = 0; i < mesh.positions.size(); ++i)
            EXPECT_LT(length(other.positions[i] - mesh.positions[i]), 1e-4f) << name << " vertex " << i;
    }
}

} // namespace
} // namespace snell
