#include "snell/io/ply/write.h"

#include "snell/core/error.h"
#include "snell/io/file.h"

#include <initializer_list>

namespace snell {
namespace {

// One attribute: its names in the header, and its numbers.
struct Attribute
{
    std::initializer_list<const char*> names;
    const float* numbers; // null: the mesh has none
    std::size_t vertices;
};

template <class T>
const float* first(const std::vector<T>& list)
{
    return list.empty() ? nullptr : &list[0][0];
}

void put(char*& to, uint word)
{
    for (int shift = 0; shift < 32; shift += 8) *to++ = static_cast<char>(word >> shift & 0xffu);
}

} // namespace

void write_ply(const std::filesystem::path& file, const Mesh& mesh)
{
    const Attribute all[] = {{{"x", "y", "z"}, first(mesh.positions), mesh.positions.size()},
                             {{"nx", "ny", "nz"}, first(mesh.normals), mesh.normals.size()},
                             {{"u", "v"}, first(mesh.uvs), mesh.uvs.size()},
                             {{"u1", "v1"}, first(mesh.uvs_1), mesh.uvs_1.size()},
                             {{"tx", "ty", "tz", "tw"}, first(mesh.tangents), mesh.tangents.size()},
                             {{"red", "green", "blue", "alpha"}, first(mesh.colors), mesh.colors.size()}};
    const std::size_t vertices = mesh.positions.size();
    std::string bytes = fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\n", vertices);
    std::size_t columns = 0;
    for (const Attribute& attribute : all) {
        if (attribute.numbers == nullptr) continue;
        SNELL_CHECK_EQ(attribute.vertices, vertices);
        columns += attribute.names.size();
        for (const char* name : attribute.names) bytes += fmt::format("property float {}\n", name);
    }
    bytes +=
        fmt::format("element face {}\nproperty list uchar uint vertex_indices\nend_header\n", mesh.triangles.size());

    const std::size_t header = bytes.size();
    bytes.resize(header + vertices * columns * 4 + mesh.triangles.size() * 13);
    char* to = bytes.data() + header;
    for (std::size_t i = 0; i < vertices; ++i)
        for (const Attribute& attribute : all)
            if (attribute.numbers != nullptr)
                for (std::size_t k = 0; k < attribute.names.size(); ++k)
                    put(to, floatBitsToUint(attribute.numbers[i * attribute.names.size() + k]));
    for (const uvec3 t : mesh.triangles) {
        *to++ = 3;
        for (int k = 0; k < 3; ++k) put(to, t[k]);
    }
    write_atomically(file, bytes);
}

} // namespace snell
