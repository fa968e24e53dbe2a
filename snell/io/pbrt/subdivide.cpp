#include "snell/io/pbrt/subdivide.h"

#include <algorithm>
#include <cmath>

namespace snell::pbrt {
namespace {

constexpr float pi = 3.14159265f;

struct Edge
{
    uint a, b;                 // a < b
    uint faces = 0;            // how many triangles have it
    uint opposite[2] = {0, 0}; // their third corners
};

// The edges of a mesh, each with a number, and for each triangle those of its three sides (v0 v1, v1 v2, v2 v0).
struct Edges
{
    std::vector<Edge> all;
    std::vector<uvec3> of_triangle;
};

Edges find_edges(std::span<const uvec3> triangles)
{
    struct Side
    {
        std::uint64_t key;
        uint triangle, side;
    };
    std::vector<Side> sides;
    sides.reserve(3 * triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t)
        for (int s = 0; s < 3; ++s) {
            const uint a = triangles[t][s], b = triangles[t][(s + 1) % 3];
            const std::uint64_t key = (std::uint64_t{std::min(a, b)} << 32) | std::max(a, b);
            sides.push_back({key, static_cast<uint>(t), static_cast<uint>(s)});
        }
    std::sort(sides.begin(), sides.end(), [](const Side& x, const Side& y) {
        return x.key != y.key ? x.key < y.key : x.triangle != y.triangle ? x.triangle < y.triangle : x.side < y.side;
    });
    Edges edges;
    edges.of_triangle.resize(triangles.size());
    for (std::size_t i = 0; i < sides.size(); ++i) {
        if (i == 0 || sides[i].key != sides[i - 1].key)
            edges.all.push_back({static_cast<uint>(sides[i].key >> 32), static_cast<uint>(sides[i].key), 0, {0, 0}});
        Edge& edge = edges.all.back();
        const int side = static_cast<int>(sides[i].side);
        if (edge.faces < 2) edge.opposite[edge.faces] = triangles[sides[i].triangle][(side + 2) % 3];
        ++edge.faces;
        edges.of_triangle[sides[i].triangle][side] = static_cast<uint>(edges.all.size() - 1);
    }
    return edges;
}

// The sums around each vertex that the rules need.
struct Ring
{
    vec3 neighbours{0.0f}; // sum of all
    vec3 boundary{0.0f};   // sum of those along boundary edges
    uint count = 0, boundary_count = 0;

    bool is_boundary() const { return boundary_count > 0; }
};

std::vector<Ring> find_rings(std::span<const vec3> points, const Edges& edges)
{
    std::vector<Ring> rings(points.size());
    for (const Edge& edge : edges.all) {
        for (const auto& [v, other] : {std::pair(edge.a, edge.b), std::pair(edge.b, edge.a)}) {
            Ring& ring = rings[v];
            ring.neighbours += points[other];
            ++ring.count;
            if (edge.faces != 2) ring.boundary += points[other], ++ring.boundary_count;
        }
    }
    return rings;
}

float beta(uint valence)
{
    return valence == 3 ? 3.0f / 16.0f : 3.0f / (8.0f * static_cast<float>(valence));
}

void refine(std::vector<vec3>& points, std::vector<uvec3>& triangles)
{
    const Edges edges = find_edges(triangles);
    const std::vector<Ring> rings = find_rings(points, edges);
    const uint old_count = static_cast<uint>(points.size());
    std::vector<vec3> fresh(points.size() + edges.all.size());
    for (uint v = 0; v < old_count; ++v) {
        const Ring& ring = rings[v];
        if (ring.boundary_count == 2)
            fresh[v] = 0.75f * points[v] + 0.125f * ring.boundary;
        else if (ring.is_boundary() || ring.count < 3)
            fresh[v] = points[v]; // a corner, or where several surfaces meet
        else
            fresh[v] = (1.0f - static_cast<float>(ring.count) * beta(ring.count)) * points[v] +
                       beta(ring.count) * ring.neighbours;
    }
    for (std::size_t e = 0; e < edges.all.size(); ++e) {
        const Edge& edge = edges.all[e];
        const vec3 ends = points[edge.a] + points[edge.b];
        fresh[old_count + e] = edge.faces == 2
                                   ? 0.375f * ends + 0.125f * (points[edge.opposite[0]] + points[edge.opposite[1]])
                                   : 0.5f * ends;
    }
    std::vector<uvec3> finer;
    finer.reserve(4 * triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        const uvec3 v = triangles[t], e = edges.of_triangle[t] + uvec3(old_count);
        finer.emplace_back(v.x, e.x, e.z);
        finer.emplace_back(e.x, v.y, e.y);
        finer.emplace_back(e.z, e.y, v.z);
        finer.emplace_back(e.x, e.y, e.z);
    }
    points = std::move(fresh);
    triangles = std::move(finer);
}

// Where the vertices end if refinement never does.
std::vector<vec3> limit_points(std::span<const vec3> points, std::span<const Ring> rings)
{
    std::vector<vec3> result(points.size());
    for (std::size_t v = 0; v < points.size(); ++v) {
        const Ring& ring = rings[v];
        if (ring.boundary_count == 2)
            result[v] = (4.0f * points[v] + ring.boundary) / 6.0f;
        else if (ring.is_boundary() || ring.count < 3)
            result[v] = points[v];
        else {
            const float n = static_cast<float>(ring.count), gamma = 1.0f / (n + 3.0f / (8.0f * beta(ring.count)));
            result[v] = (1.0f - n * gamma) * points[v] + gamma * ring.neighbours;
        }
    }
    return result;
}

// Normals of the limit surface. In the interior the tangents are sums over the ring, in order, with cosine and sine
// weights; along boundaries and at irregular vertices, means of the triangles around, by area.
std::vector<vec3> limit_normals(std::span<const vec3> points, std::span<const vec3> limits,
                                std::span<const uvec3> triangles, std::span<const Ring> rings)
{
    std::vector<uint> start(points.size() + 1, 0);
    for (const uvec3 t : triangles)
        for (int c = 0; c < 3; ++c) ++start[t[c] + 1];
    for (std::size_t v = 0; v < points.size(); ++v) start[v + 1] += start[v];
    struct Corner
    {
        uint next, last; // of the vertex's triangle, counter-clockwise
    };
    std::vector<Corner> corners(start.back());
    std::vector<uint> filled(start.begin(), start.end() - 1);
    std::vector<vec3> normals(points.size(), vec3(0.0f));
    for (const uvec3 t : triangles) {
        const vec3 flat = cross(limits[t.y] - limits[t.x], limits[t.z] - limits[t.x]);
        for (int c = 0; c < 3; ++c) {
            corners[filled[t[c]]++] = {t[(c + 1) % 3], t[(c + 2) % 3]};
            normals[t[c]] += flat;
        }
    }
    std::vector<Corner> ring;
    for (std::size_t v = 0; v < points.size(); ++v) {
        const uint count = start[v + 1] - start[v];
        // Rings of any length are put in order by sorting: next comes after next by its triangle's last corner.
        if (!rings[v].is_boundary() && count >= 3 && count == rings[v].count) {
            ring.assign(corners.begin() + start[v], corners.begin() + start[v + 1]);
            std::sort(ring.begin(), ring.end(), [](const Corner& a, const Corner& b) { return a.next < b.next; });
            vec3 s(0.0f), t(0.0f);
            std::size_t at = 0;
            uint i = 0;
            for (; i < count; ++i) {
                const float angle = 2.0f * pi * static_cast<float>(i) / static_cast<float>(count);
                s += std::cos(angle) * points[ring[at].next];
                t += std::sin(angle) * points[ring[at].next];
                const auto after = std::lower_bound(ring.begin(), ring.end(), ring[at].last,
                                                    [](const Corner& a, uint b) { return a.next < b; });
                if (after == ring.end() || after->next != ring[at].last) break; // not wound alike
                at = static_cast<std::size_t>(after - ring.begin());
            }
            const vec3 normal = cross(s, t);
            if (i == count && at == 0 && length(normal) > 0.0f) normals[v] = normal;
        }
        const float l = length(normals[v]);
        normals[v] = l > 0.0f ? normals[v] / l : vec3(0.0f, 0.0f, 1.0f);
    }
    return normals;
}

} // namespace

Mesh subdivide(std::span<const vec3> points, std::span<const uvec3> triangles, uint levels)
{
    Mesh mesh;
    mesh.positions.assign(points.begin(), points.end());
    mesh.triangles.assign(triangles.begin(), triangles.end());
    for (uint level = 0; level < levels; ++level) refine(mesh.positions, mesh.triangles);
    const std::vector<Ring> rings = find_rings(mesh.positions, find_edges(mesh.triangles));
    std::vector<vec3> limits = limit_points(mesh.positions, rings);
    mesh.normals = limit_normals(mesh.positions, limits, mesh.triangles, rings);
    mesh.positions = std::move(limits);
    return mesh;
}

} // namespace snell::pbrt
