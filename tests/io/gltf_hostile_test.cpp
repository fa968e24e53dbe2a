// Files that are cut off, broken or made to do harm: an Error that says where, never a crash, a hang or a flood.
#include "tests/io/gltf_files.h"

#include <sys/resource.h>

namespace snell {
namespace {

using namespace test;

bool says(const std::string& error, const char* what)
{
    return error.find(what) != std::string::npos;
}

TEST(GltfHostile, WhereTheJsonIsBroken)
{
    EXPECT_TRUE(says(error_of("{\n  \"asset\": {\"version\": \"2.0\"},\n  \"nodes\": [1, }\n"), "a.gltf:3:16: "))
        << error_of("{\n  \"asset\": {\"version\": \"2.0\"},\n  \"nodes\": [1, }\n");
    EXPECT_TRUE(says(error_of(""), "not good JSON"));
    EXPECT_TRUE(says(error_of("[]"), "no object"));
    EXPECT_TRUE(says(error_of("{}"), "asset.version"));
    EXPECT_TRUE(says(error_of(R"({"asset":{"version":"1.0"}})"), "only 2.0"));
    EXPECT_TRUE(says(error_of(R"({"asset":{"version":"2.0","minVersion":"2.1"}})"), "glTF 2.1"));
    EXPECT_TRUE(says(error_of(R"({"asset":{"version":"2.0"},"extras":)" + std::string(100000, '[')), "levels deep"));
    EXPECT_TRUE(
        says(error_of(R"({"asset":{"version":"2.0"},"extensions":)" + std::string(100000, '{')), "levels deep"));
}

TEST(GltfHostile, Extensions)
{
    Gltf file = Gltf::triangle();
    file.root["extensionsUsed"] = {"EXT_unheard_of", "KHR_xmp_json_ld"};
    EXPECT_TRUE(says(notes_of(load(file)), "ignored: EXT_unheard_of\n")) << notes_of(load(file));
    file.root["extensionsRequired"] = {"EXT_unheard_of"};
    EXPECT_TRUE(says(error_of(file), "needs the extension 'EXT_unheard_of'"));
}

TEST(GltfHostile, CutOffAnywhere)
{
    const Gltf file = Gltf::triangle();
    const std::string text = file.text(), binary = file.glb();
    for (std::size_t size = 0; size < text.size() - 1; ++size) EXPECT_NE(error_of(text.substr(0, size)), "") << size;
    for (std::size_t size = 0; size < binary.size(); ++size)
        EXPECT_NE(error_of(binary.substr(0, size), {}, "a.glb"), "") << size;
    EXPECT_TRUE(says(error_of(binary.substr(0, binary.size() - 1), {}, "a.glb"), "cut off"));
    std::string old = binary;
    old[4] = 1;
    EXPECT_TRUE(says(error_of(old, {}, "a.glb"), "version 1"));
    std::string long_chunk = binary;
    long_chunk[14] = '\x7f';
    EXPECT_TRUE(says(error_of(long_chunk, {}, "a.glb"), "ends after its end"));
}

// Each of these numbers put in the place of each number of a file.
TEST(GltfHostile, AbsurdNumbersEverywhere)
{
    Gltf file = Gltf::triangle();
    file.primitive()["indices"] = file.accessor<std::uint16_t>({0, 1, 2}, "SCALAR");
    file.accessor_at(0)["sparse"] = {
        {"count", 1},
        {"indices",
         {{"bufferView", file.view(bytes_of<std::uint16_t>({1}))}, {"byteOffset", 0}, {"componentType", 5123}}},
        {"values", {{"bufferView", file.view(bytes_of<float>({1, 2, 3}))}, {"byteOffset", 0}}}};
    file.primitive()["targets"] = {{{"POSITION", 0}}};
    file.node({{"camera", 0}, {"children", json::array()}, {"skin", 0}, {"mesh", 0}});
    file.append("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 1}, {"aspectRatio", 1}}}});
    file.append("skins", {{"joints", {0}}, {"skeleton", 0}});
    file.append("animations", {{"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "scale"}}}}}},
                               {"samplers", {{{"input", file.accessor<float>({0}, "SCALAR")}, {"output", 0}}}}});
    file.append(
        "materials",
        {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}, {"texCoord", 0}}}, {"metallicFactor", 1}}},
         {"extensions", {{"KHR_materials_volume", {{"thicknessFactor", 1}, {"attenuationDistance", 1}}}}}});
    file.append("textures", {{"source", 0}, {"sampler", 0}});
    file.append("samplers", {{"magFilter", 1}, {"wrapS", 2}});
    file.append("images", {{"bufferView", 0}});
    file.primitive()["material"] = 0;
    file.root["scene"] = 0;
    const json whole = json::parse(file.text()), flat = whole.flatten();
    int refused = 0, tried = 0;
    for (const auto& [path, value] : flat.items()) {
        if (!value.is_number()) continue;
        for (const json& number : {json(-1), json(-2147483649.0), json(1), json(7), json(0.5), json(65536),
                                   json(2147483647), json(4294967295u), json(4294967296u), json(18446744073709551615u),
                                   json(1e300), json(-1e300), json("text"), json(nullptr), json::object()}) {
            json bad = whole;
            bad[json::json_pointer(path)] = number;
            ++tried;
            refused += error_of(bad.dump()).empty() ? 0 : 1;
        }
    }
    EXPECT_GT(tried, 400);
    EXPECT_GT(refused, tried / 4);
}

// Types of everything exchanged.
TEST(GltfHostile, WrongTypesEverywhere)
{
    const json good = json::parse(Gltf::triangle().text());
    for (const char* key : {"accessors", "animations", "buffers", "bufferViews", "cameras", "images", "materials",
                            "meshes", "nodes", "samplers", "scenes", "skins", "textures", "extensions",
                            "extensionsUsed", "extensionsRequired", "scene", "asset"})
        for (const json& value :
             {json(1), json("x"), json::array({1}), json::array({json::object()}), json::array({json::array()}),
              json::object(), json::object({{"a", 1}}), json(nullptr), json(true), json::array({nullptr, nullptr})}) {
            json bad = good;
            bad[key] = value;
            error_of(bad.dump()); // anything but a crash
        }
}

// What asks for far more than it brings.
TEST(GltfHostile, SmallFilesCannotAskForMuch)
{
    Gltf zeros = Gltf::triangle();
    zeros.accessor_at(0) = {{"componentType", 5126}, {"count", 3000000000u}, {"type", "VEC3"}};
    EXPECT_TRUE(says(error_of(zeros), "out of proportion")) << error_of(zeros);
    zeros.primitive()["indices"] = zeros.accessor<std::uint8_t>({0, 1, 2}, "SCALAR");
    EXPECT_TRUE(says(error_of(zeros), "has no buffer view and 3000000000 elements")) << error_of(zeros);

    // One array, copied for each of very many skinned nodes.
    Gltf file;
    std::vector<float> positions(3 * 60000, 1.0f);
    const std::vector<std::uint8_t> joints(4 * 60000, 0);
    const int position = file.accessor(positions, "VEC3"), joint = file.accessor(joints, "VEC4");
    file.mesh({{"POSITION", position}, {"JOINTS_0", joint}, {"WEIGHTS_0", joint}});
    file.append("skins", {{"joints", {0}}});
    json nodes = json::array(), all = json::array();
    for (int i = 0; i < 20000; ++i) {
        nodes.push_back({{"mesh", 0}, {"skin", 0}});
        all.push_back(i);
    }
    file.root["nodes"] = nodes;
    file.root["scenes"] = {{{"nodes", all}}};
    EXPECT_TRUE(says(error_of(file.glb(), {}, "a.glb"), "out of proportion to its size"));
    rusage usage = {};
    getrusage(RUSAGE_SELF, &usage);
    EXPECT_LT(usage.ru_maxrss / 1024, 5000) << "MB";
}

} // namespace
} // namespace snell
