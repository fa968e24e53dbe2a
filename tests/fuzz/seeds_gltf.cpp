#include "seeds.h"

#include <fstream>
#include <sstream>

namespace snell::hostile {

namespace {

std::string glb(std::string json, std::string binary)
{
    json.resize((json.size() + 3) / 4 * 4, ' ');
    binary.resize((binary.size() + 3) / 4 * 4, '\0');
    Bytes out;
    const std::size_t size = 12 + 8 + json.size() + (binary.empty() ? 0 : 8 + binary.size());
    out.add("glTF").put<std::uint32_t>(2).put(static_cast<std::uint32_t>(size));
    out.put(static_cast<std::uint32_t>(json.size())).add("JSON").add(json);
    if (!binary.empty()) out.put(static_cast<std::uint32_t>(binary.size())).add({"BIN\0", 4}).add(binary);
    return out.text;
}

std::string triangle()
{
    Bytes binary;
    for (const int i : {0, 1, 2, 0}) binary.put(static_cast<std::uint16_t>(i));
    for (const float x : {0.0f, 0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 0.0f, 1.0f, 0.0f}) binary.put(x);
    for (const float x : {0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 1.0f}) binary.put(x);
    binary.add(small_png());
    const std::string image = std::to_string(small_png().size());
    return glb(R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"scale":[1,2,3]}],
"meshes":[{"primitives":[{"attributes":{"POSITION":1,"TEXCOORD_0":2},"indices":0,"material":0}]}],
"materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0},"metallicFactor":0.5},"alphaMode":"MASK"}],
"textures":[{"source":0}],"images":[{"bufferView":3,"mimeType":"image/png"}],
"accessors":[{"bufferView":0,"componentType":5123,"count":3,"type":"SCALAR"},
{"bufferView":1,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
{"bufferView":2,"componentType":5126,"count":3,"type":"VEC2"}],
"bufferViews":[{"buffer":0,"byteLength":6},{"buffer":0,"byteOffset":8,"byteLength":36},
{"buffer":0,"byteOffset":44,"byteLength":24},{"buffer":0,"byteOffset":68,"byteLength":)" +
                   image + "}],\"buffers\":[{\"byteLength\":" + std::to_string(binary.text.size()) + "}]}",
               binary.text);
}

} // namespace

std::vector<Seed> made_gltf_seeds(const std::string& format)
{
    if (format == "glb") return {{"triangle", triangle()}};
    return {};
}

} // namespace snell::hostile
