// Draco and meshopt: what their encoders have packed comes out again, what is damaged is refused.
#include "tests/io/gltf_files.h"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#include <draco/compression/encode.h>
#pragma GCC diagnostic pop
#include <meshoptimizer.h>

namespace snell {
namespace {

using namespace test;

// A grid of (n + 1)^2 vertices in the plane z = 0.
struct Grid
{
    explicit Grid(unsigned n)
    {
        for (unsigned y = 0; y <= n; ++y)
            for (unsigned x = 0; x <= n; ++x)
                positions.insert(positions.end(), {static_cast<float>(x), static_cast<float>(y), 0.0f});
        for (unsigned y = 0; y < n; ++y)
            for (unsigned x = 0; x < n; ++x) {
                const unsigned a = y * (n + 1) + x, b = a + 1, c = a + n + 1, d = c + 1;
                indices.insert(indices.end(), {a, b, d, a, d, c});
            }
    }
    std::vector<float> positions;
    std::vector<unsigned> indices;
};

std::string draco_bytes(const Grid& grid)
{
    draco::Mesh mesh;
    const auto vertices = static_cast<std::uint32_t>(grid.positions.size() / 3);
    mesh.set_num_points(vertices);
    draco::GeometryAttribute attribute;
    attribute.Init(draco::GeometryAttribute::POSITION, nullptr, 3, draco::DT_FLOAT32, false, 12, 0);
    const int id = mesh.AddAttribute(attribute, true, vertices);
    for (std::uint32_t i = 0; i < vertices; ++i)
        mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(i), &grid.positions[3 * i]);
    for (std::size_t i = 0; i < grid.indices.size(); i += 3)
        mesh.AddFace({draco::PointIndex(grid.indices[i]), draco::PointIndex(grid.indices[i + 1]),
                      draco::PointIndex(grid.indices[i + 2])});
    draco::Encoder encoder;
    draco::EncoderBuffer out;
    EXPECT_TRUE(encoder.EncodeMeshToBuffer(mesh, &out).ok());
    return std::string(out.data(), out.size());
}

Gltf draco_file(const Grid& grid, const std::string& packed)
{
    Gltf file;
    file.append("accessors", {{"componentType", 5126}, {"count", grid.positions.size() / 3}, {"type", "VEC3"}});
    file.append("accessors", {{"componentType", 5125}, {"count", grid.indices.size()}, {"type", "SCALAR"}});
    const json extension = {{"bufferView", file.view(packed)}, {"attributes", {{"POSITION", 0}}}};
    file.mesh({{"POSITION", 0}}, {{"indices", 1}, {"extensions", {{"KHR_draco_mesh_compression", extension}}}});
    file.root["extensionsRequired"] = file.root["extensionsUsed"] = {"KHR_draco_mesh_compression"};
    file.node({{"mesh", 0}});
    return file;
}

TEST(GltfPacked, Draco)
{
    const Grid grid(20);
    const Scene scene = load(draco_file(grid, draco_bytes(grid)));
    EXPECT_EQ(notes_of(scene), "");
    ASSERT_EQ(triangle_count(scene), 800u);
    EXPECT_NEAR(mesh_area(scene.meshes[0]), 400.0, 1e-3);
}

TEST(GltfPacked, DamagedDraco)
{
    const Grid grid(8);
    const std::string good = draco_bytes(grid);
    for (std::size_t size = 0; size + 1 < good.size(); ++size)
        EXPECT_NE(error_of(draco_file(grid, good.substr(0, size))), "") << size;
    unsigned state = 1;
    for (int i = 0; i < 300; ++i) {
        std::string bad = good;
        for (int k = 0; k < 3; ++k) {
            state = state * 1664525u + 1013904223u;
            bad[(state >> 8) % bad.size()] = static_cast<char>(state >> 24);
        }
        error_of(draco_file(grid, bad)); // an Error or some mesh, but nothing else
    }
    // A header that claims a thousand million triangles: edgebreaker, 1 vertex.
    std::string liar("DRACO\x02\x02\x01\x01\0\0\0\x01\xff\xff\xff\xff\x0f", 18);
    EXPECT_NE(error_of(draco_file(grid, liar)).find("cannot hold"), std::string::npos);
}

Gltf meshopt_file(const Grid& grid, const char* mode = "TRIANGLES")
{
    const std::size_t vertices = grid.positions.size() / 3;
    std::string packed(meshopt_encodeVertexBufferBound(vertices, 12), '\0');
    packed.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(packed.data()), packed.size(),
                                             grid.positions.data(), vertices, 12));
    std::string indices(meshopt_encodeIndexBufferBound(grid.indices.size(), vertices), '\0');
    auto* const out = reinterpret_cast<unsigned char*>(indices.data());
    indices.resize(std::string(mode) == "TRIANGLES"
                       ? meshopt_encodeIndexBuffer(out, indices.size(), grid.indices.data(), grid.indices.size())
                       : meshopt_encodeIndexSequence(out, indices.size(), grid.indices.data(), grid.indices.size()));
    Gltf file;
    const auto add_view = [&](const std::string& bytes, std::size_t stride, std::size_t count, const char* how) {
        const int place = file.view(bytes);
        json& view = file.root["bufferViews"][static_cast<std::size_t>(place)];
        json extension = view;
        extension.update({{"byteStride", stride}, {"count", count}, {"mode", how}});
        view = {{"buffer", 1},
                {"byteLength", stride * count},
                {"extensions", {{"EXT_meshopt_compression", std::move(extension)}}}};
        return place;
    };
    file.append("accessors", {{"bufferView", add_view(packed, 12, vertices, "ATTRIBUTES")},
                              {"componentType", 5126},
                              {"count", vertices},
                              {"type", "VEC3"}});
    file.append("accessors", {{"bufferView", add_view(indices, 4, grid.indices.size(), mode)},
                              {"componentType", 5125},
                              {"count", grid.indices.size()},
                              {"type", "SCALAR"}});
    file.mesh({{"POSITION", 0}}, {{"indices", 1}});
    file.root["extensionsRequired"] = file.root["extensionsUsed"] = {"EXT_meshopt_compression"};
    file.node({{"mesh", 0}});
    return file;
}

// With the stand-in buffer that the extension describes.
std::string meshopt_text(const Gltf& file)
{
    json root = json::parse(file.text());
    root["buffers"].push_back({{"byteLength", 1 << 20}});
    return root.dump();
}

TEST(GltfPacked, Meshopt)
{
    const Grid grid(20);
    for (const char* mode : {"TRIANGLES", "INDICES"}) {
        const Scene scene = load_gltf_text(meshopt_text(meshopt_file(grid, mode)));
        EXPECT_EQ(notes_of(scene), "");
        ASSERT_EQ(triangle_count(scene), 800u) << mode;
        EXPECT_NEAR(mesh_area(scene.meshes[0]), 400.0, 1e-9);
    }
}

TEST(GltfPacked, DamagedMeshopt)
{
    const Gltf good = meshopt_file(Grid(8));
    const auto extension = [](Gltf& file, std::size_t view) -> json& {
        return file.root["bufferViews"][view]["extensions"]["EXT_meshopt_compression"];
    };
    Gltf bad = good;
    extension(bad, 0)["count"] = 4000000000u;
    EXPECT_NE(error_of(meshopt_text(bad)).find("cannot hold 4000000000"), std::string::npos);
    for (const json& stride : {json(0), json(10), json(300), json(-4), json(1e300)}) {
        bad = good;
        extension(bad, 0)["byteStride"] = stride;
        EXPECT_NE(error_of(meshopt_text(bad)), "") << stride;
    }
    for (const char* filter : {"OCTAHEDRAL", "QUATERNION", "SOMETHING"}) {
        bad = good;
        extension(bad, 0)["filter"] = filter; // wrong for elements of 12 bytes
        EXPECT_NE(error_of(meshopt_text(bad)).find("filter"), std::string::npos);
    }
    bad = good;
    extension(bad, 1)["byteLength"] = 10;
    EXPECT_NE(error_of(meshopt_text(bad)).find("damaged"), std::string::npos);
    bad = good;
    extension(bad, 1)["mode"] = "WHATEVER";
    EXPECT_NE(error_of(meshopt_text(bad)).find("WHATEVER"), std::string::npos);
    // The stand-in itself has no data.
    bad = good;
    bad.root["bufferViews"][0].erase("extensions");
    EXPECT_NE(error_of(meshopt_text(bad)).find("which has no data"), std::string::npos);
}

} // namespace
} // namespace snell
