// Small files that ask for much: sizes that a header only claims, bombs, loops and nesting.
#include "mutate.h"
#include "opened.h"
#include "seeds.h"

#include "snell/io/load.h"

#include <zlib.h>

#include <gtest/gtest.h>

#include <cmath>

namespace fs = std::filesystem;

namespace snell::hostile {

namespace {

std::string repeated(std::string_view part, std::size_t count)
{
    std::string all;
    all.reserve(part.size() * count);
    for (std::size_t i = 0; i < count; ++i) all += part;
    return all;
}

// Opens the bytes as that format, under the bounds; the message, or "".
std::string message(const char* format_name, std::string_view bytes, const std::string& about)
{
    const Format& format = *find_format(format_name);
    const Nest nest(format);
    const Opened opened = open_checked(format, nest, bytes, about);
    return opened.error ? opened.error->what() : "";
}

bool has(const std::string& text, const char* part)
{
    return text.find(part) != std::string::npos;
}

// The text, and `size` times c behind it.
std::string gzip_of(const std::string& text, std::size_t size, char c)
{
    z_stream stream = {};
    constexpr int gzip_format = 31;
    EXPECT_EQ(::deflateInit2(&stream, 9, Z_DEFLATED, gzip_format, 8, Z_DEFAULT_STRATEGY), Z_OK);
    std::string packed, out(1 << 16, '\0');
    const auto deflate = [&](std::string piece, int flush) {
        stream.next_in = reinterpret_cast<Bytef*>(piece.data());
        stream.avail_in = static_cast<uInt>(piece.size());
        do {
            stream.next_out = reinterpret_cast<Bytef*>(out.data());
            stream.avail_out = static_cast<uInt>(out.size());
            ::deflate(&stream, flush);
            packed.append(out.data(), out.size() - stream.avail_out);
        } while (stream.avail_out == 0);
    };
    deflate(text, Z_NO_FLUSH);
    constexpr std::size_t step = 1 << 20;
    for (std::size_t done = 0; done < size; done += step) deflate(std::string(step, c), Z_NO_FLUSH);
    deflate({}, Z_FINISH);
    ::deflateEnd(&stream);
    return packed;
}

const std::string ply_start = "ply\nformat binary_little_endian 1.0\nelement vertex ";
const std::string ply_rest = "\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list "
                             "uchar int vertex_indices\nend_header\n";

} // namespace

TEST(Amplification, ply_of_four_billion_vertices)
{
    for (const char* count : {"4000000000", "4294967295", "99999999999", "18446744073709551615"}) {
        const std::string text = message("ply", ply_start + count + ply_rest + "0123456789ab", count);
        EXPECT_FALSE(text.empty()) << count;
    }
    EXPECT_FALSE(message("ply",
                         "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
                         "float z\nelement face 1\nproperty list uint int vertex_indices\nend_header\n0 0 0\n1 0 "
                         "0\n0 1 0\n4294967295 0 1 2\n",
                         "a face of 4e9 corners")
                     .empty());
    // Elements that take no bytes at all.
    message("ply", "ply\nformat binary_little_endian 1.0\nelement nothing 4000000000\nend_header\n", "empty elements");
}

TEST(Amplification, stl_of_four_billion_triangles)
{
    EXPECT_FALSE(message("stl", std::string(80, ' ') + "\xff\xff\xff\xff" + std::string(50, '\0'), "4e9").empty());
}

TEST(Amplification, pictures_that_claim_to_be_huge)
{
    const auto with = [](std::string bytes, std::size_t at, std::string_view value) {
        return repair("png", bytes.replace(at, value.size(), value));
    };
    const std::string side("\0\0\xea\x60", 4); // 60000
    EXPECT_FALSE(message("png", with(small_png(), 16, side + side), "60000 x 60000").empty());
    EXPECT_FALSE(message("png", with(small_png(), 16, "\x7f\xff\xff\xff\x7f\xff\xff\xff"), "2^31 x 2^31").empty());
    std::string jpg = made_image_seeds("jpg")[0].bytes;
    const std::size_t frame = jpg.find("\xff\xc0");
    ASSERT_NE(frame, std::string::npos);
    EXPECT_FALSE(message("jpg", jpg.replace(frame + 5, 4, "\xea\x60\xea\x60"), "60000 x 60000").empty());
    for (Seed& seed : made_exr_seeds()) {
        const std::size_t window = seed.bytes.find(std::string("dataWindow\0box2i\0", 17));
        ASSERT_NE(window, std::string::npos);
        seed.bytes.replace(window + 17 + 4 + 8, 8, std::string("\x60\xea\0\0\x60\xea\0\0", 8));
        EXPECT_FALSE(message("exr", seed.bytes, seed.name + " of 60000 x 60000").empty()) << seed.name;
    }
    std::string webp = made_image_seeds("webp")[1].bytes; // lossless: 14 bits each behind the mark 0x2f
    webp.replace(21, 4, "\xff\xff\xff\x0f");
    EXPECT_FALSE(message("webp", webp, "16384 x 16384").empty());
    EXPECT_FALSE(message("hdr", "#?RADIANCE\n\n-Y 60000 +X 60000\n1234", "60000 x 60000").empty());
    EXPECT_FALSE(message("pfm", "PF\n60000 60000\n-1\n1234", "60000 x 60000").empty());
}

TEST(Amplification, gzip_bombs)
{
    // A good header in a member of its own, then 256 MiB of comment or of nothing.
    const std::string head = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty "
                             "float z\n";
    const std::string comment = gzip_of(head + "comment ", 0, ' ') + gzip_of({}, std::size_t(256) << 20, 'x');
    const std::string text = message("gz", comment, "256 MiB of comment");
    EXPECT_TRUE(has(text, "inflates to more than")) << text;
    const std::string body = gzip_of(head + "end_header\n", 0, ' ') + gzip_of({}, std::size_t(256) << 20, ' ');
    EXPECT_FALSE(message("gz", body, "256 MiB of spaces").empty());
    EXPECT_FALSE(message("gz", gzip_of({}, std::size_t(256) << 20, 'x'), "256 MiB in one line").empty());
}

TEST(Amplification, long_lines_and_huge_faces)
{
    constexpr std::size_t many = 300'000;
    message("obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf" + repeated(" 1 2 3", many / 3), "a face of many corners");
    std::string circle;
    for (std::size_t i = 0; i < 20'000; ++i) {
        const double angle = 2e-4 * 3.14159265 * static_cast<double>(i) / 2;
        circle += fmt::format("v {} {} 0\n", std::cos(angle), std::sin(angle * 1.001) + (i % 2 == 0 ? 0.001 : 0));
    }
    circle += "f";
    for (std::size_t i = 1; i <= 20'000; ++i) circle += " " + std::to_string(i);
    message("obj", circle + "\n", "a concave face of many corners");
    message("obj", "v " + repeated("1", 1 << 20), "a huge number");
    message("obj", "usemtl " + repeated("x", 1 << 20) + "\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "a huge name");
    message("obj", repeated("mtllib a.mtl\n", many / 3), "many missing libraries");
    message("obj", repeated("\\\n", many), "continued lines");
    message("obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n" + repeated("o a\nf 1 2 3\n", many / 3), "many objects");
    message("obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n" + repeated("s 1\nf 1 2 3\n", many / 3),
            "many smooth faces at a vertex");
    message("mtl", repeated("newmtl a\n", many / 3), "many materials");
    message("mtl", "newmtl red\n" + repeated("map_Kd gone.png\n", many / 3), "many missing pictures");
    message("ply", "ply\nformat ascii 1.0\n" + repeated("comment x\n", many / 3), "many comments");
    message("ply", "ply\nformat ascii 1.0\nelement vertex 1\n" + repeated("property float x\n", many / 3),
            "properties");
    message("ply", "ply\nformat ascii 1.0\n" + repeated("element vertex 0\n", many / 3) + "end_header\n", "elements");
    message("stl", "solid\n" + repeated("facet normal 0 0 1 ", many), "many facets");
    message("spd", repeated("400 1\n", many), "equal wavelengths");
    message("hdr", "#?RADIANCE\n" + repeated("EXPOSURE=1\n", many) + "\n-Y 1 +X 1\n1234", "exposures");
    message("pfm", "PF\n" + repeated(" ", 1 << 20) + "1 1 -1\n123456789012", "spaces");
}

TEST(Amplification, pbrt_nesting_and_loops)
{
    const std::string start = "Camera \"perspective\"\nWorldBegin\n";
    constexpr std::size_t deep = 1'000'000;
    EXPECT_FALSE(message("pbrt", start + repeated("AttributeBegin\n", deep), "deep attributes").empty());
    EXPECT_FALSE(message("pbrt", start + repeated("TransformBegin ", deep), "deep transforms").empty());
    message("pbrt", start + repeated("[", deep), "brackets");
    message("pbrt", start + repeated("ObjectBegin \"a\" ", 100'000), "deep objects");
    EXPECT_FALSE(message("pbrt", start + "Include \"scene.pbrt\"\n", "includes itself").empty());
    message("pbrt", start + repeated("Include \"scene.pbrt\"\n", 50), "includes itself often");
    message("pbrt", start + "Import \"scene.pbrt\"\n", "imports itself");
    message("pbrt", start + repeated("Include \"part.pbrt\"\n", 20'000), "many includes");
    message("pbrt",
            start + "Texture \"a\" \"spectrum\" \"scale\" \"texture tex\" \"a\"\nMaterial \"diffuse\" \"texture "
                    "reflectance\" \"a\"\nShape \"sphere\"\n",
            "a texture of itself");
    // Twice as much with each line.
    std::string doubling = "Texture \"t0\" \"spectrum\" \"imagemap\" \"string filename\" \"tex.png\"\n";
    for (int i = 1; i < 60; ++i)
        doubling += fmt::format("Texture \"t{0}\" \"spectrum\" \"mix\" \"texture tex1\" \"t{1}\" \"texture tex2\" "
                                "\"t{1}\"\n",
                                i, i - 1);
    message("pbrt", start + doubling + "Material \"diffuse\" \"texture reflectance\" \"t59\"\nShape \"sphere\"\n",
            "a tree of textures");
    std::string objects = "ObjectBegin \"o0\"\nShape \"sphere\"\nObjectEnd\n";
    for (int i = 1; i < 40; ++i)
        objects += fmt::format("ObjectBegin \"o{0}\"\nObjectInstance \"o{1}\"\nObjectInstance \"o{1}\"\nObjectEnd\n", i,
                               i - 1);
    message("pbrt", start + objects + "ObjectInstance \"o39\"\n", "a tree of objects");
    std::string mixes = "MakeNamedMaterial \"m0\" \"string type\" \"diffuse\"\n";
    for (int i = 1; i < 60; ++i)
        mixes += fmt::format("MakeNamedMaterial \"m{0}\" \"string type\" \"mix\" \"string materials\" [\"m{1}\" "
                             "\"m{1}\"]\n",
                             i, i - 1);
    message("pbrt", start + mixes + "NamedMaterial \"m59\"\nShape \"sphere\"\n", "a tree of mixed materials");
    message("pbrt",
            start + "MakeNamedMaterial \"m\" \"string type\" \"mix\" \"string materials\" [\"m\" \"m\"]\n"
                    "NamedMaterial \"m\"\nShape \"sphere\"\n",
            "a material mixed of itself");
    message("pbrt",
            start + "Shape \"loopsubdiv\" \"integer levels\" 30 \"integer indices\" [0 1 2] \"point3 P\" [0 0 0 "
                    "1 0 0 0 1 0]\n",
            "subdivided 30 times");
    message("pbrt", start + repeated("Shape \"sphere\" \"float radius\" 1e-30\n", 20'000), "many spheres");
    message("pbrt", start + repeated("Shape \"cylinder\" \"float radius\" 1\n", 2'000), "many cylinders");
    message("pbrt", start + "Shape \"curve\" \"integer splitdepth\" 30 \"point3 P\" [0 0 0 1 0 0 1 1 0 0 1 0]",
            "curve");
    message("pbrt",
            "Film \"rgb\" \"integer xresolution\" 2000000000 \"integer yresolution\" 2000000000\nWorldBegin\n"
            "Shape \"sphere\"\n",
            "a huge film");
    message("pbrt", start + repeated("Unknown \"a\" \"b\"\n", 50'000), "unknown directives");
    message("pbrt", start + "Shape \"sphere\" " + repeated("\"float x\" 1 ", 50'000), "unknown parameters");
    std::string names;
    for (int i = 0; i < 20'000; ++i) names += fmt::format("MakeNamedMaterial \"m{}\" \"string type\" \"diffuse\"\n", i);
    message("pbrt", start + names, "many materials");
}

TEST(Amplification, gltf_counts_and_nesting)
{
    const std::string start = R"({"asset":{"version":"2.0"},)";
    EXPECT_FALSE(message("gltf", repeated("[", 1'000'000), "nested").empty());
    EXPECT_FALSE(message("gltf", start + "\"extras\":" + repeated("{\"a\":", 1'000'000), "nested objects").empty());
    const auto accessor = [&](const std::string& body) {
        return start +
               R"("scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":)"
               R"({"POSITION":0}}]}],"buffers":[{"byteLength":36,"uri":"data:;base64,)" +
               repeated("AAAA", 12) + R"("}],"bufferViews":[{"buffer":0,"byteLength":36}],"accessors":[{)" + body +
               "}]}";
    };
    const auto usual = R"("componentType":5126,"type":"VEC3",)";
    EXPECT_FALSE(
        message("gltf", accessor(fmt::format(R"({}"bufferView":0,"count":4294967295)", usual)), "4e9").empty());
    EXPECT_FALSE(message("gltf", accessor(fmt::format(R"({}"bufferView":0,"count":1e300)", usual)), "1e300").empty());
    // Without a view an accessor is all zeros, of any length.
    message("gltf", accessor(fmt::format(R"({}"count":2000000000)", usual)), "zeros");
    message("gltf", accessor(fmt::format(R"({}"count":300000000)", usual)), "fewer zeros");
    message(
        "gltf",
        accessor(fmt::format(
            R"({}"count":100000000,"sparse":{{"count":1,"indices":{{"bufferView":0,"componentType":5121}},"values":{{"bufferView":0}}}})",
            usual)),
        "sparse zeros");
    message("gltf", start + R"("scenes":[{"nodes":[0]}],"nodes":[{"children":[0]}]})", "a node in itself");
    message("gltf", start + R"("scenes":[{"nodes":[0]}],"nodes":[{"children":[1]},{"children":[0]}]})",
            "a loop of nodes");
    std::string tree = start + R"("scenes":[{"nodes":[0]}],"nodes":[)";
    for (int i = 1; i < 60; ++i) tree += fmt::format(R"({{"children":[{0},{0}]}},)", i);
    message("gltf", tree + R"({"mesh":0}]})", "a tree of shared nodes");
    std::string chain = start + R"("scenes":[{"nodes":[0]}],"nodes":[)";
    for (int i = 1; i < 100'000; ++i) chain += fmt::format(R"({{"children":[{}]}},)", i);
    message("gltf", chain + "{}]}", "a long chain of nodes");
    // Everything shares one accessor.
    std::string meshes = start + R"("scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"meshes":[{"primitives":[)";
    for (int i = 0; i < 2000; ++i) meshes += R"({"attributes":{"POSITION":0}},)";
    meshes += R"({"attributes":{"POSITION":0}}]}],"buffers":[{"byteLength":36000,"uri":"data:;base64,)" +
              repeated("AAAA", 12000) +
              R"("}],"bufferViews":[{"buffer":0,"byteLength":36000}],"accessors":[{"componentType":5126,"type":"VEC3",)"
              R"("bufferView":0,"count":3000}]})";
    message("gltf", meshes, "many meshes of one accessor");
    message("gltf", start + R"("images":[{"uri":"scene.gltf"}],"buffers":[{"byteLength":10,"uri":"scene.gltf"}]})",
            "a buffer that is the scene");
    EXPECT_FALSE(
        message("glb", std::string("glTF\x02\0\0\0\xff\xff\xff\xff\xff\xff\xff\xffJSON{}", 22), "4 GiB").empty());
}

} // namespace snell::hostile
