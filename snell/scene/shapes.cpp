#include "snell/scene/shapes.h"

#include "snell/core/error.h"

#include <cmath>

namespace snell {

Mesh make_quad(std::string name, vec3 a, vec3 b, vec3 c, vec3 d, Index<MaterialDesc> material)
{
    Mesh mesh;
    mesh.name = std::move(name);
    mesh.positions = {a, b, c, d};
    mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    mesh.material = material;
    return mesh;
}

Mesh make_box(std::string name, vec3 lower, vec3 upper, Index<MaterialDesc> material)
{
    Mesh mesh;
    mesh.name = std::move(name);
    for (uint i = 0; i < 8; ++i)
        mesh.positions.emplace_back(i & 1u ? upper.x : lower.x, i & 2u ? upper.y : lower.y, i & 4u ? upper.z : lower.z);
    mesh.triangles = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
                      {2, 6, 7}, {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
    mesh.material = material;
    return mesh;
}

Mesh make_checkerboard(std::string name, uint columns, uint rows, float square, Index<MaterialDesc> even,
                       Index<MaterialDesc> odd)
{
    Mesh mesh;
    mesh.name = std::move(name);
    mesh.material = even;
    for (uint j = 0; j <= rows; ++j)
        for (uint i = 0; i <= columns; ++i)
            mesh.positions.emplace_back((static_cast<float>(i) - 0.5f * static_cast<float>(columns)) * square, 0.0f,
                                        (static_cast<float>(j) - 0.5f * static_cast<float>(rows)) * square);
    for (uint j = 0; j < rows; ++j) {
        for (uint i = 0; i < columns; ++i) {
            const uint a = j * (columns + 1) + i, b = a + columns + 1;
            mesh.triangles.emplace_back(a, b, b + 1);
            mesh.triangles.emplace_back(a, b + 1, a + 1);
            mesh.triangle_materials.insert(mesh.triangle_materials.end(), 2, (i + j) % 2 == 0 ? even : odd);
        }
    }
    return mesh;
}

Mesh make_torus(std::string name, float ring, float tube, uint ring_steps, uint tube_steps,
                Index<MaterialDesc> material)
{
    SNELL_CHECK_LE(3u, ring_steps);
    SNELL_CHECK_LE(3u, tube_steps);
    Mesh mesh;
    mesh.name = std::move(name);
    mesh.material = material;
    // The seams are closed by vertices of their own: there the texture coordinates jump. The last of them take the
    // angle 0 again, so that both sides of a seam have the same position to the bit.
    for (uint i = 0; i <= ring_steps; ++i) {
        const float u = static_cast<float>(i) / static_cast<float>(ring_steps);
        const float phi = i == ring_steps ? 0.0f : 2.0f * pi * u;
        const vec3 out(std::cos(phi), 0.0f, -std::sin(phi));
        for (uint j = 0; j <= tube_steps; ++j) {
            const float v = static_cast<float>(j) / static_cast<float>(tube_steps);
            const float theta = j == tube_steps ? 0.0f : 2.0f * pi * v;
            const vec3 normal = std::cos(theta) * out + std::sin(theta) * vec3(0, 1, 0);
            mesh.positions.push_back(ring * out + tube * normal);
            mesh.normals.push_back(normal);
            mesh.uvs.emplace_back(u, v);
        }
    }
    for (uint i = 0; i < ring_steps; ++i) {
        for (uint j = 0; j < tube_steps; ++j) {
            const uint a = i * (tube_steps + 1) + j, b = a + tube_steps + 1;
            mesh.triangles.emplace_back(a, b, b + 1);
            mesh.triangles.emplace_back(a, b + 1, a + 1);
        }
    }
    return mesh;
}

Image make_checker_image(std::string name, vec3 even_srgb, vec3 odd_srgb)
{
    constexpr uint size = 512; // the bilinear blur between two squares is 1/256 of a square wide
    Image image;
    image.name = std::move(name);
    image.width = image.height = size;
    image.bytes.reserve(std::size_t{4} * size * size);
    for (uint y = 0; y < size; ++y) {
        for (uint x = 0; x < size; ++x) {
            const vec3 color = (x < size / 2) == (y < size / 2) ? even_srgb : odd_srgb;
            for (int k = 0; k < 3; ++k)
                image.bytes.push_back(static_cast<std::uint8_t>(std::lround(255.0f * color[k])));
            image.bytes.push_back(255);
        }
    }
    return image;
}

} // namespace snell
