// What the tests of the mesh readers share.
#pragma once

#include "snell/core/error.h"
#include "snell/io/load.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <string>

namespace snell::test {

// A folder that is gone after the test.
class Folder
{
  public:
    Folder()
    {
        std::string pattern = (std::filesystem::temp_directory_path() / "snell-mesh-XXXXXX").string();
        path_ = ::mkdtemp(pattern.data());
    }
    ~Folder()
    {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;

    std::filesystem::path write(const std::string& name, std::string_view bytes) const
    {
        // Writing over a file makes some file systems wait for the disk.
        std::filesystem::remove(path_ / name);
        std::ofstream(path_ / name, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
        return path_ / name;
    }

    void write_folder(const std::string& name) const { std::filesystem::create_directory(path_ / name); }

  private:
    std::filesystem::path path_;
};

inline std::size_t triangle_count(const Scene& scene)
{
    std::size_t count = 0;
    for (const Mesh& mesh : scene.meshes) count += mesh.triangles.size();
    return count;
}

inline double mesh_area(const Mesh& mesh)
{
    double area = 0;
    for (const uvec3 t : mesh.triangles)
        area +=
            0.5 * length(cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]));
    return area;
}

inline vec3 triangle_normal(const Mesh& mesh, std::size_t i)
{
    const uvec3 t = mesh.triangles[i];
    return normalize(cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]));
}

inline bool has_note(const Scene& scene, std::string_view part)
{
    for (const Note& note : scene.notes)
        if (note.text.find(part) != std::string::npos) return true;
    return false;
}

inline const MaterialDesc* find_material(const Scene& scene, std::string_view name)
{
    for (const MaterialDesc& material : scene.materials)
        if (material.name == name) return &material;
    return nullptr;
}

// The message of the Error that loading gives; "" if there is none.
inline std::string load_error(const std::filesystem::path& file)
{
    try {
        load_scene(file);
    } catch (const Error& error) {
        return error.what();
    }
    return {};
}

// A file of the collection beside the checkout; empty, with a line that says so, if it is not there.
inline std::filesystem::path shared_mesh(const std::string& name)
{
    const std::filesystem::path file = std::filesystem::path(SNELL_SOURCE_DIR) / "../shared/scenes/mesh" / name;
    if (std::filesystem::exists(file)) return file;
    std::cout << "left out: " << name << " is not in ../shared/scenes/mesh\n";
    return {};
}

// Loads `bytes`, damaged in many ways that are the same on every run: cut short everywhere (or at 300 places), and with
// single bytes, pairs and runs replaced. Each time there must be a Scene whose indices are right, or an Error.
inline void damage(const std::string& file_name, const std::string& bytes)
{
    const Folder folder;
    std::size_t scenes = 0, errors = 0;
    const auto load = [&](const std::string& damaged) {
        const std::filesystem::path file = folder.write(file_name, damaged);
        try {
            const Scene scene = load_scene(file);
            ++scenes;
            for (const Mesh& mesh : scene.meshes)
                for (const uvec3 t : mesh.triangles) ASSERT_LT(max(t.x, max(t.y, t.z)), mesh.positions.size());
        } catch (const Error& error) {
            ++errors;
            ASSERT_NE(std::string(error.what()).find(file_name), std::string::npos) << error.what();
        }
    };

    const std::size_t step = bytes.size() / 300 + 1;
    for (std::size_t size = 0; size < bytes.size(); size += step) load(bytes.substr(0, size));

    std::uint32_t state = 1;
    const auto random = [&](std::size_t below) {
        state = state * 1664525u + 1013904223u;
        return static_cast<std::size_t>((static_cast<std::uint64_t>(state) * below) >> 32);
    };
    const std::string nasty = std::string("\0\xff\x7f\x80-+./\n\r\t #0919e\\", 19);
    for (int i = 0; i < 400; ++i) {
        std::string damaged = bytes;
        const std::size_t at = random(bytes.size());
        if (i % 4 == 0) damaged[at] = static_cast<char>(damaged[at] ^ (1 << random(8)));
        if (i % 4 == 1) damaged[at] = nasty[random(nasty.size())];
        if (i % 4 == 2) damaged.replace(at, 1 + random(8), random(12), nasty[random(nasty.size())]);
        if (i % 4 == 3) damaged.insert(at, damaged.substr(random(bytes.size()), random(40)));
        load(damaged);
    }
    EXPECT_GT(errors, 0u);
    EXPECT_GT(scenes, 0u);
}

} // namespace snell::test
