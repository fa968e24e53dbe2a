#include "snell/io/pbrt/tessellate.h"

#include <algorithm>
#include <cmath>

namespace snell::pbrt {

constexpr float two_pi = 6.28318531f;

float equal_area_radius(uint segments)
{
    const float angle = two_pi / static_cast<float>(segments);
    return std::sqrt(angle / std::sin(angle));
}

Mesh revolve(std::span<const ProfilePoint> profile, float phi_max, uint segments)
{
    Mesh mesh;
    const float part = clamp(phi_max / 360.0f, 0.0f, 1.0f);
    const uint columns = std::max(1u, static_cast<uint>(std::ceil(static_cast<float>(segments) * part)));
    const uint rows = static_cast<uint>(profile.size());
    for (uint row = 0; row < rows; ++row) {
        const ProfilePoint& p = profile[row];
        for (uint column = 0; column <= columns; ++column) {
            const float u = static_cast<float>(column) / static_cast<float>(columns);
            // The seam's two columns are the same points.
            const float phi = part == 1.0f && column == columns ? 0.0f : two_pi * part * u;
            const float c = std::cos(phi), s = std::sin(phi);
            mesh.positions.emplace_back(p.r * c, p.r * s, p.z);
            mesh.normals.emplace_back(p.normal_r * c, p.normal_r * s, p.normal_z);
            mesh.uvs.emplace_back(u, static_cast<float>(row) / static_cast<float>(rows - 1));
        }
    }
    for (uint row = 0; row + 1 < rows; ++row)
        for (uint column = 0; column < columns; ++column) {
            const uint a = row * (columns + 1) + column, b = a + 1, c = a + columns + 1, d = c + 1;
            // No triangles without area where the profile touches the axis. The winding is that of phi and v.
            if (profile[row].r != 0.0f) mesh.triangles.emplace_back(a, b, d);
            if (profile[row + 1].r != 0.0f) mesh.triangles.emplace_back(a, d, c);
        }
    // phi before v is outward where the profile climbs; elsewhere the normals know better.
    for (uvec3& t : mesh.triangles) {
        const vec3 a = mesh.positions[t.x], n = cross(mesh.positions[t.y] - a, mesh.positions[t.z] - a);
        if (dot(n, mesh.normals[t.x] + mesh.normals[t.y] + mesh.normals[t.z]) < 0.0f) std::swap(t.y, t.z);
    }
    return mesh;
}

bool is_parallelogram(std::span<const vec3> points, uvec4 q)
{
    const vec3 a = points[q.x], u = points[q.y] - a, v = points[q.z] - a;
    return length(points[q.w] - (a + u + v)) <= 1e-5f * (length(u) + length(v));
}

Mesh tessellate_patches(std::span<const vec3> points, std::span<const vec3> normals, std::span<const vec2> uvs,
                        std::span<const uvec4> patches, uint cells)
{
    Mesh mesh;
    const vec2 square[4] = {{0, 0}, {1, 0}, {0, 1}, {1, 1}};
    for (const uvec4 q : patches) {
        const uint n = is_parallelogram(points, q) ? 1 : cells;
        const uint first = static_cast<uint>(mesh.positions.size());
        const auto blend = [&](auto a, auto b, auto c, auto d, float u, float v) {
            return (1 - v) * ((1 - u) * a + u * b) + v * ((1 - u) * c + u * d);
        };
        const vec3 p[4] = {points[q.x], points[q.y], points[q.z], points[q.w]};
        for (uint j = 0; j <= n; ++j)
            for (uint i = 0; i <= n; ++i) {
                const float u = static_cast<float>(i) / static_cast<float>(n);
                const float v = static_cast<float>(j) / static_cast<float>(n);
                mesh.positions.push_back(blend(p[0], p[1], p[2], p[3], u, v));
                if (!normals.empty()) {
                    const vec3 sum = blend(normals[q.x], normals[q.y], normals[q.z], normals[q.w], u, v);
                    mesh.normals.push_back(length(sum) > 0.0f ? normalize(sum) : sum);
                } else if (n > 1) {
                    const vec3 along_u = (1 - v) * (p[1] - p[0]) + v * (p[3] - p[2]);
                    const vec3 along_v = (1 - u) * (p[2] - p[0]) + u * (p[3] - p[1]);
                    const vec3 normal = cross(along_u, along_v);
                    mesh.normals.push_back(length(normal) > 0.0f ? normalize(normal) : vec3(0.0f));
                } else {
                    const vec3 normal = cross(p[1] - p[0], p[2] - p[0]);
                    mesh.normals.push_back(length(normal) > 0.0f ? normalize(normal) : vec3(0.0f));
                }
                if (uvs.empty())
                    mesh.uvs.push_back(blend(square[0], square[1], square[2], square[3], u, v));
                else
                    mesh.uvs.push_back(blend(uvs[q.x], uvs[q.y], uvs[q.z], uvs[q.w], u, v));
            }
        for (uint j = 0; j < n; ++j)
            for (uint i = 0; i < n; ++i) {
                const uint a = first + j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
                mesh.triangles.emplace_back(a, b, d);
                mesh.triangles.emplace_back(a, d, c);
            }
    }
    return mesh;
}

Mesh tessellate_heights(std::span<const float> heights, uint nx, uint ny)
{
    Mesh mesh;
    for (uint y = 0; y < ny; ++y)
        for (uint x = 0; x < nx; ++x) {
            const float u = static_cast<float>(x) / static_cast<float>(nx - 1);
            const float v = static_cast<float>(y) / static_cast<float>(ny - 1);
            mesh.positions.emplace_back(u, v, heights[std::size_t{y} * nx + x]);
            mesh.uvs.emplace_back(u, v);
        }
    for (uint y = 0; y + 1 < ny; ++y)
        for (uint x = 0; x + 1 < nx; ++x) {
            const uint a = y * nx + x, b = a + 1, c = a + nx, d = c + 1;
            mesh.triangles.emplace_back(a, b, d);
            mesh.triangles.emplace_back(a, d, c);
        }
    return mesh;
}

} // namespace snell::pbrt
