// Measures how fast meshes load, and how much memory that takes.
//
//     load [FOLDER] [--threads N] [--triangles N] [--obj-megabytes N]
//
// Makes a wavy square of 1 million triangles as binary PLY, ASCII PLY, binary STL, GLB (with normals and texture
// coordinates), and as OBJ (with them too, 100 MB) in the folder (a temporary one by default), unless they are there
// already. For each it prints, as the median of 5 rounds that go through all files:
//
//     MB/s a core   bytes of the file over the processor time of load_scene()
//     ratio         time of load_scene(), validation included, over that of reading the bytes into memory and building
//                   the mesh's vectors once from what is in memory, by one thread; and the same of processor time,
//                   which says more on a busy machine
//     peak          what the process's resident memory grew by while loading, over the bytes of the finished meshes;
//     each
//                   in a process of its own
#include "snell/io/load.h"
#include "snell/core/parallel.h"
#include "snell/io/file.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace fs = std::filesystem;
using namespace snell;

namespace {

double now()
{
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double processor_time()
{
    rusage usage = {};
    ::getrusage(RUSAGE_SELF, &usage);
    const auto seconds = [](const timeval& t) { return double(t.tv_sec) + 1e-6 * double(t.tv_usec); };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

double median(std::vector<double> values)
{
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

template <class T>
std::size_t bytes_of(const std::vector<T>& v)
{
    return v.size() * sizeof(T);
}

std::size_t mesh_bytes(const Scene& scene)
{
    std::size_t bytes = 0;
    for (const Mesh& m : scene.meshes)
        bytes += bytes_of(m.positions) + bytes_of(m.normals) + bytes_of(m.uvs) + bytes_of(m.colors) +
                 bytes_of(m.triangles) + bytes_of(m.triangle_materials);
    return bytes;
}

// ---- the files ----

// A square of 2 * size^2 triangles, made anew for each file.
Mesh wavy_square(uint size)
{
    Mesh mesh;
    const float scale = 1.0f / float(size);
    for (uint y = 0; y <= size; ++y)
        for (uint x = 0; x <= size; ++x) {
            const float u = float(x) * scale, v = float(y) * scale;
            const float slope = 0.6f * std::cos(20.0f * u);
            mesh.positions.push_back(vec3(u, v, 0.03f * std::sin(20.0f * u)));
            mesh.normals.push_back(normalize(vec3(-slope, 0.0f, 1.0f)));
            mesh.uvs.push_back(vec2(u, v));
        }
    for (uint y = 0; y < size; ++y)
        for (uint x = 0; x < size; ++x) {
            const uint a = y * (size + 1) + x, d = a + size + 1;
            mesh.triangles.push_back(uvec3(a, a + 1, d + 1));
            mesh.triangles.push_back(uvec3(a, d + 1, d));
        }
    return mesh;
}

void append(std::string& bytes, const void* data, std::size_t size)
{
    bytes.append(static_cast<const char*>(data), size);
}

std::string ply_bytes(const Mesh& mesh, bool is_ascii)
{
    std::string bytes =
        fmt::format("ply\nformat {} 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
                    "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
                    is_ascii ? "ascii" : "binary_little_endian", mesh.positions.size(), mesh.triangles.size());
    for (const vec3 p : mesh.positions)
        is_ascii ? void(fmt::format_to(std::back_inserter(bytes), "{} {} {}\n", p.x, p.y, p.z))
                 : append(bytes, &p, sizeof p);
    for (const uvec3 t : mesh.triangles) {
        if (is_ascii) {
            fmt::format_to(std::back_inserter(bytes), "3 {} {} {}\n", t.x, t.y, t.z);
            continue;
        }
        bytes += '\3';
        append(bytes, &t, sizeof t);
    }
    return bytes;
}

std::string stl_bytes(const Mesh& mesh)
{
    std::string bytes(80, ' ');
    const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
    append(bytes, &count, 4);
    for (const uvec3 t : mesh.triangles) {
        const vec3 facet[4] = {vec3(0, 0, 1), mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]};
        append(bytes, facet, sizeof facet);
        bytes.append(2, '\0');
    }
    return bytes;
}

std::string glb_bytes(const Mesh& mesh)
{
    const std::size_t n = mesh.positions.size(), corners = 3 * mesh.triangles.size();
    const std::size_t views[4] = {12 * n, 12 * n, 8 * n, 4 * corners};
    std::string json = fmt::format(
        R"({{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{)"
        R"("attributes":{{"POSITION":0,"NORMAL":1,"TEXCOORD_0":2}},"indices":3}}]}}],"buffers":[{{"byteLength":{}}}],)"
        R"("accessors":[{{"bufferView":0,"componentType":5126,"count":{},"type":"VEC3","min":[0,0,-1],"max":[1,1,1]}},)"
        R"({{"bufferView":1,"componentType":5126,"count":{},"type":"VEC3"}},)"
        R"({{"bufferView":2,"componentType":5126,"count":{},"type":"VEC2"}},)"
        R"({{"bufferView":3,"componentType":5125,"count":{},"type":"SCALAR"}}],"bufferViews":[)",
        views[0] + views[1] + views[2] + views[3], n, n, n, corners);
    std::size_t offset = 0;
    for (int i = 0; i < 4; ++i) {
        json += fmt::format(R"({}{{"buffer":0,"byteOffset":{},"byteLength":{}}})", i > 0 ? "," : "", offset, views[i]);
        offset += views[i];
    }
    json += "]}";
    json.resize((json.size() + 3) / 4 * 4, ' ');
    std::string bytes = "glTF";
    const auto word = [&](std::size_t value) {
        const auto w = static_cast<std::uint32_t>(value);
        append(bytes, &w, 4);
    };
    word(2);
    word(12 + 8 + json.size() + 8 + offset);
    word(json.size());
    bytes += "JSON" + json;
    word(offset);
    bytes += std::string("BIN\0", 4);
    append(bytes, mesh.positions.data(), views[0]);
    append(bytes, mesh.normals.data(), views[1]);
    append(bytes, mesh.uvs.data(), views[2]);
    append(bytes, mesh.triangles.data(), views[3]);
    return bytes;
}

std::string obj_bytes(std::size_t wanted)
{
    // Some 210 bytes a vertex with its two triangles.
    const Mesh mesh = wavy_square(static_cast<uint>(std::sqrt(double(wanted) / 206.0)));
    std::string bytes = "o square\n";
    const auto out = std::back_inserter(bytes);
    for (const vec3 p : mesh.positions) fmt::format_to(out, "v {:.6f} {:.6f} {:.6f}\n", p.x, p.y, p.z);
    for (const vec2 t : mesh.uvs) fmt::format_to(out, "vt {:.6f} {:.6f}\n", t.x, t.y);
    for (const vec3 n : mesh.normals) fmt::format_to(out, "vn {:.4f} {:.4f} {:.4f}\n", n.x, n.y, n.z);
    for (const uvec3 t : mesh.triangles)
        fmt::format_to(out, "f {0}/{0}/{0} {1}/{1}/{1} {2}/{2}/{2}\n", t.x + 1, t.y + 1, t.z + 1);
    return bytes;
}

// ---- what is measured ----

// Reads the bytes and builds the vectors of `like` from memory that holds their content already.
void read_and_build(const fs::path& file, const Mesh& like)
{
    const std::string bytes = read_file(file);
    Mesh mesh;
    mesh.positions.reserve(like.positions.size());
    for (const vec3 p : like.positions) mesh.positions.push_back(p);
    mesh.normals.reserve(like.normals.size());
    for (const vec3 n : like.normals) mesh.normals.push_back(n);
    mesh.uvs.reserve(like.uvs.size());
    for (const vec2 t : like.uvs) mesh.uvs.push_back(t);
    mesh.triangles.reserve(like.triangles.size());
    for (const uvec3 t : like.triangles) mesh.triangles.push_back(t);
    if (mesh.triangles.size() + bytes.size() == 0) fmt::print("nothing\n"); // so that it is not optimised away
}

long resident_peak()
{
    rusage usage = {};
    ::getrusage(RUSAGE_SELF, &usage);
    return usage.ru_maxrss * 1024;
}

// In a process of its own, for a peak never sinks.
double memory_ratio(const std::string& program, const fs::path& file, const std::string& threads)
{
    const std::string command = fmt::format("'{}' --peak '{}' --threads {}", program, file.string(), threads);
    FILE* pipe = ::popen(command.c_str(), "r");
    double ratio = 0;
    if (pipe == nullptr || std::fscanf(pipe, "%lf", &ratio) != 1) fmt::print(stderr, "could not measure memory\n");
    if (pipe != nullptr) ::pclose(pipe);
    return ratio;
}

} // namespace

int main(int argc, char** argv)
try {
    fs::path folder, peak_of;
    std::size_t triangles = 1000000, megabytes = 100;
    std::string threads = "0";
    for (int i = 1; i < argc; ++i) {
        const std::string argument = argv[i];
        const bool has_value = i + 1 < argc;
        if (argument == "--threads" && has_value)
            threads = argv[++i];
        else if (argument == "--triangles" && has_value)
            triangles = std::stoul(argv[++i]);
        else if (argument == "--obj-megabytes" && has_value)
            megabytes = std::stoul(argv[++i]);
        else if (argument == "--peak" && has_value)
            peak_of = argv[++i];
        else if (!argument.starts_with("-"))
            folder = argument;
        else {
            fmt::print(stderr, "usage: load [FOLDER] [--threads N] [--triangles N] [--obj-megabytes N]\n");
            return 2;
        }
    }
    set_thread_count(std::stoi(threads));
    if (!peak_of.empty()) {
        const long before = resident_peak();
        const Scene scene = load_scene(peak_of);
        fmt::print("{}\n", double(resident_peak() - before) / double(mesh_bytes(scene)));
        return 0;
    }

    bool is_temporary = false;
    if (folder.empty()) {
        std::string pattern = (fs::temp_directory_path() / "snell-load-XXXXXX").string();
        folder = ::mkdtemp(pattern.data());
        is_temporary = true;
    }
    const auto size = static_cast<uint>(std::sqrt(double(triangles) / 2.0));
    const fs::path files[] = {folder / "binary.ply", folder / "ascii.ply", folder / "binary.stl", folder / "mesh.glb",
                              folder / "mesh.obj"};
    constexpr int count = 5;
    if (!fs::exists(files[4])) {
        const Mesh mesh = wavy_square(size);
        write_atomically(files[0], ply_bytes(mesh, false));
        write_atomically(files[1], ply_bytes(mesh, true));
        write_atomically(files[2], stl_bytes(mesh));
        write_atomically(files[3], glb_bytes(mesh));
        write_atomically(files[4], obj_bytes(megabytes * 1000000));
    }

    constexpr int rounds = 5;
    std::vector<double> wall[count], processor[count], base[count], base_processor[count];
    std::size_t counts[count] = {};
    for (int round = 0; round <= rounds; ++round)
        for (int i = 0; i < count; ++i) {
            const double start = now(), start_processor = processor_time();
            Scene scene = load_scene(files[i]);
            const double end = now(), end_processor = processor_time();
            counts[i] = 0;
            for (const Mesh& mesh : scene.meshes) counts[i] += mesh.triangles.size();
            read_and_build(files[i], scene.meshes.at(0));
            const double built = now(), built_processor = processor_time();
            if (round == 0) continue; // brings the files and the threads in
            wall[i].push_back(end - start);
            processor[i].push_back(end_processor - start_processor);
            base[i].push_back(built - end);
            base_processor[i].push_back(built_processor - end_processor);
        }

    fmt::print("{:12} {:>10} {:>6} {:>7} {:>8} {:>11} {:>12} {:>6} {:>9} {:>5}\n", "file", "triangles", "MB", "ms",
               "MB/s", "MB/s a core", "read+build", "ratio", "processor", "peak");
    for (int i = 0; i < count; ++i) {
        const double bytes = 1e-6 * double(fs::file_size(files[i]));
        const double time = median(wall[i]);
        fmt::print("{:12} {:>10} {:6.1f} {:7.1f} {:8.0f} {:11.0f} {:9.1f} ms {:6.2f} {:9.2f} {:5.2f}\n",
                   files[i].filename().string(), counts[i], bytes, 1e3 * time, bytes / time,
                   bytes / median(processor[i]), 1e3 * median(base[i]), time / median(base[i]),
                   median(processor[i]) / median(base_processor[i]), memory_ratio(argv[0], files[i], threads));
    }
    if (is_temporary) fs::remove_all(folder);
    return 0;
} catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
}
