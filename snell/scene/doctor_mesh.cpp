// What the scene report finds out about each mesh once: how its edges meet, which way it faces, what it is made of.
#include "snell/core/parallel.h"
#include "snell/scene/doctor_parts.h"
#include "snell/scene/validate_mesh.h"

#include <algorithm>
#include <atomic>

namespace snell::doctor {

static constexpr std::size_t grain = 1 << 15;

bool is_solid_glass(const MaterialDesc& material)
{
    if (material.kind == material_dielectric) return true;
    return material.kind == material_principled && material.principled.transmission > 0.0f &&
           !material.principled.thin_walled;
}

bool is_emissive(const MaterialDesc& material)
{
    return !is_black(material.emission);
}

// ---- edges ----

static std::uint64_t mix_bits(std::uint64_t x)
{
    x = (x ^ (x >> 33)) * 0xff51afd7ed558ccdull;
    x = (x ^ (x >> 33)) * 0xc4ceb9fe1a85ec53ull;
    return x ^ (x >> 33);
}

static std::uint64_t hash_position(vec3 p)
{
    p += vec3(0.0f); // -0 is 0
    const std::uint64_t xy = std::uint64_t{floatBitsToUint(p.x)} << 32 | floatBitsToUint(p.y);
    return mix_bits(mix_bits(xy) ^ floatBitsToUint(p.z));
}

// For each vertex the first one at the same position.
static std::vector<uint> weld(const std::vector<vec3>& positions)
{
    struct Key
    {
        std::uint64_t hash;
        uint vertex;
    };
    std::vector<Key> keys(positions.size());
    parallel_ranges(keys.size(), grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) keys[i] = {hash_position(positions[i]), static_cast<uint>(i)};
    });
    std::sort(keys.begin(), keys.end(),
              [](const Key& a, const Key& b) { return a.hash != b.hash ? a.hash < b.hash : a.vertex < b.vertex; });
    std::vector<uint> first(positions.size());
    for (std::size_t i = 0, leader = 0; i < keys.size(); ++i) {
        if (keys[i].hash != keys[leader].hash) leader = i;
        const uint vertex = keys[i].vertex, candidate = keys[leader].vertex;
        first[vertex] = positions[vertex] == positions[candidate] ? candidate : vertex;
    }
    return first;
}

// The edges of all triangles, those of one smaller vertex together: larger vertex times 2, plus 1 if the triangle runs
// from the larger to the smaller.
struct Edges
{
    std::vector<std::size_t> begin; // by smaller vertex, and one more
    std::vector<std::uint64_t> ends;
};

static Edges gather_edges(const std::vector<uint>& welded, std::span<const uvec3> triangles)
{
    Edges edges;
    edges.begin.assign(welded.size() + 1, 0);
    const auto each = [&](const auto& use) {
        for (const uvec3 t : triangles) {
            const uint v[3] = {welded[t.x], welded[t.y], welded[t.z]};
            if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) continue; // its other two edges are one
            for (int k = 0; k < 3; ++k) use(v[k], v[(k + 1) % 3]);
        }
    };
    each([&](uint a, uint b) { ++edges.begin[std::min(a, b) + 1]; });
    for (std::size_t i = 1; i < edges.begin.size(); ++i) edges.begin[i] += edges.begin[i - 1];
    edges.ends.resize(edges.begin.back());
    std::vector<std::size_t> next(edges.begin.begin(), edges.begin.end() - 1);
    each([&](uint a, uint b) {
        edges.ends[next[std::min(a, b)]++] = std::uint64_t{std::max(a, b)} << 1 | (a > b ? 1u : 0u);
    });
    return edges;
}

Topology find_topology(const Mesh& mesh, std::span<const uvec3> triangles)
{
    Topology topology;
    if (triangles.empty()) return topology;
    const std::vector<uint> welded = weld(mesh.positions);
    Edges edges = gather_edges(welded, triangles);
    topology.triangles = edges.ends.size() / 3;

    std::atomic<std::size_t> open = 0, odd = 0;
    parallel_ranges(welded.size(), grain, [&](std::size_t first, std::size_t last) {
        std::size_t open_here = 0, odd_here = 0;
        for (std::size_t v = first; v < last; ++v) {
            const std::size_t end = edges.begin[v + 1];
            std::sort(edges.ends.begin() + static_cast<std::ptrdiff_t>(edges.begin[v]),
                      edges.ends.begin() + static_cast<std::ptrdiff_t>(end));
            for (std::size_t i = edges.begin[v]; i < end;) {
                std::size_t uses = 0, backward = 0;
                for (const std::uint64_t other = edges.ends[i] >> 1; i < end && edges.ends[i] >> 1 == other; ++i) {
                    ++uses;
                    backward += edges.ends[i] & 1u;
                }
                open_here += uses % 2;
                odd_here += 2 * backward == uses ? 0 : 1;
            }
        }
        open += open_here;
        odd += odd_here;
    });
    topology.open_edges = open;
    topology.odd_edges = odd;

    const glm::dvec3 origin(mesh.positions[triangles[0].x]); // near, so that little cancels
    for (const uvec3 t : triangles) {
        const glm::dvec3 a = glm::dvec3(mesh.positions[t.x]) - origin, b = glm::dvec3(mesh.positions[t.y]) - origin,
                         c = glm::dvec3(mesh.positions[t.z]) - origin;
        topology.volume += glm::dot(a, glm::cross(b, c)) / 6.0;
    }
    return topology;
}

// ---- a whole mesh ----

static std::vector<uint> materials_of(const Mesh& mesh)
{
    std::vector<uint> used;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const uint material = material_of(mesh, i);
        if (used.empty() || used.back() != material) used.push_back(material);
        if (mesh.triangle_materials.empty()) break;
    }
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    return used;
}

static MeshFacts examine_mesh(const Scene& scene, const Mesh& mesh)
{
    MeshFacts facts;
    bool all_glass = true;
    for (const uint index : materials_of(mesh)) {
        const MaterialDesc& material = scene.materials[index];
        const bool is_glass = is_solid_glass(material);
        facts.has_solid_glass = facts.has_solid_glass || is_glass;
        all_glass = all_glass && is_glass;
        if (is_emissive(material) && material.kind != material_unlit)
            (material.two_sided_emission ? facts.two_sided : facts.emissive).push_back(index);
    }
    facts.is_all_glass = facts.has_solid_glass && all_glass;

    double least2 = -1.0;
    for (const uvec3 t : mesh.triangles) {
        const vec3 a = mesh.positions[t.x], b = mesh.positions[t.y], c = mesh.positions[t.z];
        for (const vec3 p : {a, b, c}) facts.bounds.extend(p);
        const glm::dvec3 ab = glm::dvec3(b) - glm::dvec3(a), ac = glm::dvec3(c) - glm::dvec3(a), bc = ac - ab;
        const double longest2 = std::max({glm::dot(ab, ab), glm::dot(ac, ac), glm::dot(bc, bc)});
        if (least2 < 0.0 || longest2 < least2) least2 = longest2;
        if (mesh.normals.empty()) continue;
        const glm::dvec3 sum =
            glm::dvec3(mesh.normals[t.x]) + glm::dvec3(mesh.normals[t.y]) + glm::dvec3(mesh.normals[t.z]);
        if (glm::dot(glm::cross(ab, ac), sum) < 0.0) ++facts.against_normals;
    }
    facts.least_edge = std::sqrt(std::max(least2, 0.0));

    facts.topology = find_topology(mesh, mesh.triangles);
    if (facts.is_all_glass) facts.glass = facts.topology;
    if (facts.has_solid_glass && !facts.is_all_glass) {
        std::vector<uvec3> glass;
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
            if (is_solid_glass(scene.materials[material_of(mesh, i)])) glass.push_back(mesh.triangles[i]);
        facts.glass = find_topology(mesh, glass);
    }
    return facts;
}

std::vector<MeshFacts> find_mesh_facts(const Scene& scene)
{
    std::vector<MeshFacts> facts(scene.meshes.size());
    parallel_for(facts.size(), [&](std::size_t i) { facts[i] = examine_mesh(scene, scene.meshes[i]); });
    for (const InstanceDesc& instance : scene.instances)
        for (const Index<Mesh> mesh : scene.groups[instance.group.value].meshes) facts[mesh.value].is_placed = true;
    return facts;
}

} // namespace snell::doctor
