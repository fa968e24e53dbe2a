#include "scene_files.h"

#include <cstdint>
#include <cstring>

namespace snell::test {

static void append(std::string& bytes, std::initializer_list<float> values)
{
    for (const float value : values) {
        char four[4];
        std::memcpy(four, &value, 4); // both sides are little-endian
        bytes.append(four, 4);
    }
}

std::string moving_lamp_data()
{
    std::string bytes;
    // Two triangles, seen from +Z.
    append(bytes, {-0.5f, -0.5f, 0, 0.5f, -0.5f, 0, 0.5f, 0.5f, 0, -0.5f, -0.5f, 0, 0.5f, 0.5f, 0, -0.5f, 0.5f, 0});
    append(bytes, {0, 2});              // 72: times
    append(bytes, {-1, 0, 0, 1, 0, 0}); // 80: there
    append(bytes, {1, 0, 0, -1, 0, 0}); // 104: and back
    append(bytes, {-1, 0, 4, 1, 0, 4}); // 128: the camera beside it
    return bytes;
}

static std::string base64(const std::string& bytes)
{
    static const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t bits = 0;
        for (std::size_t k = 0; k < 3; ++k)
            bits = bits << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
        for (std::size_t k = 0; k < 4; ++k) text += i + k > bytes.size() ? '=' : digits[bits >> (18 - 6 * k) & 63];
    }
    return text;
}

static std::string lamp(const std::string& buffer, const std::string& more, const std::string& extension = {})
{
    const std::string uri =
        buffer.empty() ? "data:application/octet-stream;base64," + base64(moving_lamp_data()) : buffer;
    // Brighter than 1: else it would be a label that glows, and the studio would come.
    return R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
"extensionsUsed": ["KHR_materials_emissive_strength", "KHR_materials_variants"],
"nodes": [{"mesh": 0, "translation": [-1, 0, 0]}, {"camera": 0, "translation": [0, 0, 4]}],
"cameras": [{"name": "front", "type": "perspective", "perspective": {"yfov": 0.9, "znear": 0.1}}],
"meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0)" +
           extension + R"(}]}],
"materials": [{"name": "r", "emissiveFactor": [1, 0, 0],
"extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 2}}, "pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1]}},
{"name": "g", "emissiveFactor": [0, 1, 0],
"extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 2}}, "pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1]}}],
"buffers": [{"byteLength": 152, "uri": ")" +
           uri + R"("}],
"bufferViews": [{"buffer": 0, "byteLength": 72}, {"buffer": 0, "byteOffset": 72, "byteLength": 8},
{"buffer": 0, "byteOffset": 80, "byteLength": 24}, {"buffer": 0, "byteOffset": 104, "byteLength": 24},
{"buffer": 0, "byteOffset": 128, "byteLength": 24}],
"accessors": [{"bufferView": 0, "componentType": 5126, "count": 6, "type": "VEC3", "min": [-0.5, -0.5, 0],
"max": [0.5, 0.5, 0]},
{"bufferView": 1, "componentType": 5126, "count": 2, "type": "SCALAR", "min": [0], "max": [2]},
{"bufferView": 2, "componentType": 5126, "count": 2, "type": "VEC3"},
{"bufferView": 3, "componentType": 5126, "count": 2, "type": "VEC3"},
{"bufferView": 4, "componentType": 5126, "count": 2, "type": "VEC3"}])" +
           more + "}\n";
}

std::string moving_lamp(const std::string& buffer)
{
    return lamp(buffer, R"(,
"animations": [{"name": "there", "samplers": [{"input": 1, "output": 2}],
"channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}]},
{"name": "back", "samplers": [{"input": 1, "output": 3}],
"channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}]},
{"name": "tracking", "samplers": [{"input": 1, "output": 2}, {"input": 1, "output": 4}],
"channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}},
{"sampler": 1, "target": {"node": 1, "path": "translation"}}]}])");
}

std::string still_lamp()
{
    return lamp("", "");
}

std::string coloured_lamp()
{
    return lamp("", R"(,
"extensions": {"KHR_materials_variants": {"variants": [{"name": "red"}, {"name": "green"}]}})",
                R"(, "extensions": {"KHR_materials_variants": {"mappings": [{"material": 0, "variants": [0]},
{"material": 1, "variants": [1]}]}})");
}

} // namespace snell::test
