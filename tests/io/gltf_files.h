// Small glTF files for tests, made piece by piece.
#pragma once

#include "snell/io/gltf/gltf.h"
#include "tests/io/mesh_files.h"

#include <nlohmann/json.hpp>

#include <cstring>
#include <vector>

namespace snell::test {

using nlohmann::json;

inline std::string base64(std::string_view bytes)
{
    constexpr const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string out;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        unsigned word = 0;
        for (std::size_t k = 0; k < 3; ++k)
            word = word << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
        for (std::size_t k = 0; k < 4; ++k) out += i + k <= bytes.size() ? digits[word >> (18 - 6 * k) & 63] : '=';
    }
    return out;
}

template <class T>
std::string bytes_of(const std::vector<T>& numbers)
{
    std::string bytes(numbers.size() * sizeof(T), '\0');
    std::memcpy(bytes.data(), numbers.data(), bytes.size());
    return bytes;
}

template <class T>
int component_type()
{
    if (std::is_same_v<T, std::int8_t>) return 5120;
    if (std::is_same_v<T, std::uint8_t>) return 5121;
    if (std::is_same_v<T, std::int16_t>) return 5122;
    if (std::is_same_v<T, std::uint16_t>) return 5123;
    if (std::is_same_v<T, std::int32_t>) return 5124;
    if (std::is_same_v<T, std::uint32_t>) return 5125;
    return std::is_same_v<T, double> ? 5130 : 5126;
}

struct Gltf
{
    json root = {{"asset", {{"version", "2.0"}}}};
    std::string binary;

    int append(const char* array, json item)
    {
        root[array].push_back(std::move(item));
        return static_cast<int>(root[array].size()) - 1;
    }

    int view(std::string_view bytes, json more = json::object())
    {
        while (binary.size() % 4 != 0) binary += '\0';
        more["buffer"] = 0;
        more["byteOffset"] = binary.size();
        more["byteLength"] = bytes.size();
        binary += bytes;
        return append("bufferViews", std::move(more));
    }

    // type: "VEC3" and so on.
    template <class T>
    int accessor(const std::vector<T>& numbers, const std::string& type, bool is_normalized = false)
    {
        const std::size_t width = type == "SCALAR" ? 1 : type == "MAT4" ? 16 : static_cast<std::size_t>(type[3] - '0');
        json item = {{"bufferView", view(bytes_of(numbers))},
                     {"componentType", component_type<T>()},
                     {"count", numbers.size() / width},
                     {"type", type}};
        if (is_normalized) item["normalized"] = true;
        return append("accessors", std::move(item));
    }

    // A mesh of one primitive with these attributes.
    int mesh(json attributes, json more = json::object())
    {
        more["attributes"] = std::move(attributes);
        return append("meshes", {{"primitives", json::array({std::move(more)})}});
    }
    json& primitive(int mesh = 0) { return root["meshes"][static_cast<std::size_t>(mesh)]["primitives"][0]; }
    json& accessor_at(int index) { return root["accessors"][static_cast<std::size_t>(index)]; }

    // A node in the first scene.
    int node(json node)
    {
        const int index = append("nodes", std::move(node));
        if (!root.contains("scenes")) root["scenes"] = json::array({{{"nodes", json::array()}}});
        root["scenes"][0]["nodes"].push_back(index);
        return index;
    }

    // The unit triangle in the plane z = 0, as mesh 0 on node 0.
    static Gltf triangle()
    {
        Gltf file;
        file.mesh({{"POSITION", file.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3")}});
        file.node({{"mesh", 0}});
        return file;
    }

    // The triangle with a material.
    static Gltf with_material(json material)
    {
        Gltf file = triangle();
        file.append("materials", std::move(material));
        file.primitive()["material"] = 0;
        return file;
    }

    std::string text() const
    {
        json whole = root;
        if (!binary.empty())
            whole["buffers"] = json::array(
                {{{"byteLength", binary.size()}, {"uri", "data:application/octet-stream;base64," + base64(binary)}}});
        return whole.dump(1);
    }

    std::string glb() const
    {
        json whole = root;
        if (!binary.empty()) whole["buffers"] = json::array({{{"byteLength", binary.size()}}});
        return container(whole.dump(), binary);
    }

    static std::string container(std::string json_chunk, std::string binary_chunk)
    {
        while (json_chunk.size() % 4 != 0) json_chunk += ' ';
        while (binary_chunk.size() % 4 != 0) binary_chunk += '\0';
        const auto word = [](std::size_t value) {
            return bytes_of<std::uint32_t>({static_cast<std::uint32_t>(value)});
        };
        std::string chunks = word(json_chunk.size()) + "JSON" + json_chunk;
        if (!binary_chunk.empty()) chunks += word(binary_chunk.size()) + std::string("BIN\0", 4) + binary_chunk;
        return "glTF" + word(2) + word(12 + chunks.size()) + chunks;
    }
};

inline Scene load_gltf_text(const std::string& bytes, const LoadOptions& options = {}, const char* name = "a.gltf")
{
    // One folder for all: making and removing one takes longer than most loads.
    static const Folder folder;
    return load_scene(folder.write(name, bytes), options);
}
inline Scene load(const Gltf& file, const LoadOptions& options = {})
{
    return load_gltf_text(file.text(), options);
}

// What the Error says; "" if there is none.
inline std::string error_of(const std::string& bytes, const LoadOptions& options = {}, const char* name = "a.gltf")
{
    try {
        load_gltf_text(bytes, options, name);
        return "";
    } catch (const Error& error) {
        return error.what();
    }
}
inline std::string error_of(const Gltf& file, const LoadOptions& options = {})
{
    return error_of(file.text(), options);
}

// All notes, one a line.
inline std::string notes_of(const Scene& scene)
{
    std::string all;
    for (const Note& note : scene.notes) all += note.text + "\n";
    return all;
}

} // namespace snell::test
