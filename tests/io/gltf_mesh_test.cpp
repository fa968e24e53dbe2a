// Geometry: containers, accessors, primitives.
#include "tests/io/gltf_files.h"

namespace snell {
namespace {

using namespace test;

TEST(GltfMesh, TextBinaryAndExternalBuffersAreTheSame)
{
    const Gltf file = Gltf::triangle();
    const Folder folder;
    json external = file.root;
    external["buffers"] = json::array({{{"byteLength", file.binary.size()}, {"uri", "b%20\xc3\xa4.bin"}}});
    folder.write("b \xc3\xa4.bin", file.binary);
    for (const auto& path : {folder.write("a.gltf", file.text()), folder.write("a.glb", file.glb()),
                             folder.write("b.gltf", external.dump()), folder.write("wrong.gltf", file.glb())}) {
        const Scene scene = load_scene(path);
        EXPECT_EQ(notes_of(scene), "") << path;
        ASSERT_EQ(scene.meshes.size(), 1u);
        EXPECT_EQ(scene.meshes[0].triangles, (std::vector<uvec3>{{0, 1, 2}}));
        EXPECT_EQ(scene.meshes[0].positions, (std::vector<vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
        EXPECT_TRUE(scene.meshes[0].normals.empty());
    }
}

TEST(GltfMesh, StridesAndOffsets)
{
    Gltf file = Gltf::triangle();
    // A number, then x y z, then another number.
    const std::vector<float> data = {9, 9, 1, 2, 3, 9, 9, 4, 5, 6, 9, 9, 7, 8, 10};
    const int view = file.view(bytes_of(data), {{"byteStride", 20}});
    file.accessor_at(0) = {
        {"bufferView", view}, {"byteOffset", 8}, {"componentType", 5126}, {"count", 3}, {"type", "VEC3"}};
    EXPECT_EQ(load(file).meshes.at(0).positions, (std::vector<vec3>{{1, 2, 3}, {4, 5, 6}, {7, 8, 10}}));
    file.accessor_at(0)["byteOffset"] = 12;
    EXPECT_NE(error_of(file).find("more than its buffer view has"), std::string::npos) << error_of(file);
}

template <class T>
void check_normalised(const std::vector<T>& numbers, const std::vector<float>& wanted)
{
    Gltf file = Gltf::triangle();
    const int index = file.accessor<T>(numbers, "VEC2", true);
    file.primitive()["attributes"]["TEXCOORD_0"] = index;
    const Scene scene = load(file);
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_FLOAT_EQ(scene.meshes[0].uvs.at(i).x, wanted[2 * i]);
        EXPECT_FLOAT_EQ(scene.meshes[0].uvs.at(i).y, 1.0f - wanted[2 * i + 1]); // ours points up
    }
    file.accessor_at(index)["normalized"] = false;
    EXPECT_FLOAT_EQ(load(file).meshes[0].uvs.at(1).x, static_cast<float>(numbers[2]));
}

TEST(GltfMesh, IntegersNormalisedAndNot)
{
    check_normalised<std::int8_t>({0, 127, 64, -127, -128, 1}, {0, 1, 64 / 127.0f, -1, -1, 1 / 127.0f});
    check_normalised<std::uint8_t>({0, 255, 128, 1, 2, 3}, {0, 1, 128 / 255.0f, 1 / 255.0f, 2 / 255.0f, 3 / 255.0f});
    check_normalised<std::int16_t>({0, 32767, 1000, -32767, -32768, 1}, {0, 1, 1000 / 32767.0f, -1, -1, 1 / 32767.0f});
    check_normalised<std::uint16_t>({0, 65535, 1000, 1, 2, 3},
                                    {0, 1, 1000 / 65535.0f, 1 / 65535.0f, 2 / 65535.0f, 3 / 65535.0f});
}

TEST(GltfMesh, IndicesOfAllWidths)
{
    const auto check = [](auto zero) {
        using T = decltype(zero);
        Gltf file = Gltf::triangle();
        file.primitive()["indices"] = file.accessor<T>({2, 0, 1, 1, 0, 2}, "SCALAR");
        EXPECT_EQ(load(file).meshes.at(0).triangles, (std::vector<uvec3>{{2, 0, 1}, {1, 0, 2}}));
        file.primitive()["indices"] = file.accessor<T>({2, 0, 3}, "SCALAR");
        EXPECT_NE(error_of(file).find("mesh 0, primitive 0: a triangle refers to vertex 3 of 3"), std::string::npos);
    };
    check(std::uint8_t{});
    check(std::uint16_t{});
    check(std::uint32_t{});
}

TEST(GltfMesh, StripsAndFans)
{
    Gltf file;
    file.mesh({{"POSITION", file.accessor<float>({0, 0, 0, 0, 1, 0, 1, 0, 0, 1, 1, 0, 2, 0, 0}, "VEC3")}},
              {{"mode", 5}});
    file.node({{"mesh", 0}});
    EXPECT_EQ(load(file).meshes.at(0).triangles, (std::vector<uvec3>{{0, 1, 2}, {1, 3, 2}, {2, 3, 4}}));
    file.primitive()["mode"] = 6;
    EXPECT_EQ(load(file).meshes.at(0).triangles, (std::vector<uvec3>{{1, 2, 0}, {2, 3, 0}, {3, 4, 0}}));
    file.primitive()["mode"] = 4;
    const Scene cut = load(file);
    EXPECT_EQ(cut.meshes.at(0).triangles, (std::vector<uvec3>{{0, 1, 2}}));
    EXPECT_NE(notes_of(cut).find("5 corners"), std::string::npos);
}

TEST(GltfMesh, PointsAndLinesAreSaid)
{
    Gltf file = Gltf::triangle();
    for (const int mode : {0, 1, 2, 3})
        file.root["meshes"][0]["primitives"].push_back({{"mode", mode}, {"attributes", {{"POSITION", 0}}}});
    const Scene scene = load(file);
    EXPECT_EQ(triangle_count(scene), 1u);
    EXPECT_NE(notes_of(scene).find("points and lines are not drawn (and 3 more"), std::string::npos) << notes_of(scene);
    file.primitive()["mode"] = 7;
    EXPECT_NE(error_of(file).find("mode 7"), std::string::npos);
}

TEST(GltfMesh, SparseWithAndWithoutAView)
{
    Gltf file = Gltf::triangle();
    const int indices = file.view(bytes_of<std::uint16_t>({1, 2}));
    const int values = file.view(bytes_of<float>({5, 6, 7, 8, 9, 9}));
    const json sparse = {{"count", 2},
                         {"indices", {{"bufferView", indices}, {"componentType", 5123}}},
                         {"values", {{"bufferView", values}}}};
    file.accessor_at(0)["sparse"] = sparse;
    EXPECT_EQ(load(file).meshes.at(0).positions, (std::vector<vec3>{{0, 0, 0}, {5, 6, 7}, {8, 9, 9}}));
    file.accessor_at(0).erase("bufferView");
    EXPECT_EQ(load(file).meshes.at(0).positions, (std::vector<vec3>{{0, 0, 0}, {5, 6, 7}, {8, 9, 9}}));
    file.accessor_at(0)["sparse"]["indices"]["bufferView"] = file.view(bytes_of<std::uint16_t>({1, 3}));
    EXPECT_NE(error_of(file).find("element 3 of 3"), std::string::npos) << error_of(file);
    file.accessor_at(0)["sparse"]["count"] = 4;
    EXPECT_NE(error_of(file).find("4 elements of 3"), std::string::npos) << error_of(file);
}

TEST(GltfMesh, ColoursOfThreeAndFour)
{
    Gltf file = Gltf::triangle();
    json& attributes = file.primitive()["attributes"];
    attributes["COLOR_0"] = file.accessor<float>({1, 0, 0, 0, 0.5f, 0, 0, 0, 1}, "VEC3");
    EXPECT_EQ(load(file).meshes.at(0).colors, (std::vector<vec4>{{1, 0, 0, 1}, {0, 0.5f, 0, 1}, {0, 0, 1, 1}}));
    attributes["COLOR_0"] = file.accessor<std::uint8_t>({255, 0, 0, 51, 0, 255, 0, 255, 0, 0, 255, 0}, "VEC4", true);
    EXPECT_EQ(load(file).meshes.at(0).colors, (std::vector<vec4>{{1, 0, 0, 0.2f}, {0, 1, 0, 1}, {0, 0, 1, 0}}));
}

// A small primitive of a large shared array keeps its own vertices only, in all attributes.
TEST(GltfMesh, SharedVerticesAreNotCopiedWhole)
{
    Gltf file;
    std::vector<float> positions, uvs;
    constexpr int count = 5000;
    for (int i = 0; i < count; ++i) {
        const float x = static_cast<float>(i);
        positions.insert(positions.end(), {x, x * x, 1.0f});
        uvs.insert(uvs.end(), {x, 0.0f});
    }
    const int position = file.accessor(positions, "VEC3"), uv = file.accessor(uvs, "VEC2");
    file.mesh({{"POSITION", position}, {"TEXCOORD_0", uv}},
              {{"indices", file.accessor<std::uint16_t>({4000, 10, 3000, 10, 4000, 20}, "SCALAR")}});
    file.node({{"mesh", 0}});
    const Scene scene = load(file);
    const Mesh& mesh = scene.meshes.at(0);
    EXPECT_EQ(mesh.triangles, (std::vector<uvec3>{{3, 0, 2}, {0, 3, 1}}));
    ASSERT_EQ(mesh.positions.size(), 4u);
    const float kept[] = {10, 20, 3000, 4000};
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(mesh.positions[i].x, kept[i]);
        EXPECT_EQ(mesh.uvs.at(i).x, kept[i]);
    }
}

TEST(GltfMesh, SecondCoordinatesAreKeptAndThirdSaid)
{
    Gltf file = Gltf::triangle();
    json& attributes = file.primitive()["attributes"];
    attributes["TEXCOORD_1"] = attributes["TEXCOORD_2"] = file.accessor<float>({0, 0.25f, 1, 0.5f, 2, 1}, "VEC2");
    attributes["TEXCOORD_0"] = attributes["TEXCOORD_1"];
    const Scene scene = load(file);
    EXPECT_EQ(scene.meshes[0].uvs_1, (std::vector<vec2>{{0, 0.75f}, {1, 0.5f}, {2, 0}}));
    EXPECT_NE(notes_of(scene).find("TEXCOORD_2, which is not used"), std::string::npos);
}

TEST(GltfMesh, AttributesMustFit)
{
    Gltf file = Gltf::triangle();
    file.primitive()["attributes"]["NORMAL"] = file.accessor<float>({0, 0, 1, 0, 0, 1}, "VEC3");
    EXPECT_NE(error_of(file).find("NORMAL has 2 elements for 3 vertices"), std::string::npos);
    file.primitive()["attributes"]["NORMAL"] = file.accessor<float>({0, 0, 0, 1, 0, 1}, "VEC2");
    EXPECT_NE(error_of(file).find("has 2 numbers an element, not 3"), std::string::npos);
    file.primitive()["attributes"].erase("NORMAL");
    file.primitive()["attributes"].erase("POSITION");
    EXPECT_NE(notes_of(load(file)).find("has no positions"), std::string::npos);
}

} // namespace
} // namespace snell
