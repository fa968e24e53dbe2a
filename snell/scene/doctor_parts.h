// What the parts of examine() share: one file a theme.
#pragma once

#include "snell/scene/bounds.h"
#include "snell/scene/doctor.h"
#include "snell/scene/packed.h"

#include <fmt/format.h>

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace snell::doctor {

// Collects findings. Keeps the first ones of each kind and counts the others.
class Findings
{
  public:
    void add(std::string_view kind, Finding::Severity severity, std::string text, std::size_t count = 1);
    // Moves them into the report, the gravest first, and counts them there.
    void close(SceneReport& report);

  private:
    struct Kind
    {
        std::vector<Finding> listed;
        std::size_t unlisted = 0, unlisted_count = 0;
        std::size_t found[4] = {}; // by severity
    };
    std::map<std::string, Kind, std::less<>> kinds_;
};

// "1 triangle", "3 triangles", "1,000,000 edges".
std::string amount(std::size_t count, std::string_view one);
// "mesh 'floor'", "mesh 3".
std::string mesh_label(const Scene& scene, uint mesh);

// ---- shape ----

// How the edges of a set of triangles meet, once vertices at equal positions are taken as one.
struct Topology
{
    std::size_t triangles = 0;  // that have three different corners
    std::size_t open_edges = 0; // of an odd number of triangles
    std::size_t odd_edges = 0;  // of as many triangles in one direction as in the other: not so
    double volume = 0.0;        // signed; > 0 if a closed mesh faces outwards. In object space

    bool is_closed() const { return triangles > 0 && open_edges == 0; }
    // Only then does `volume` mean anything.
    bool is_oriented() const { return triangles > 0 && odd_edges == 0; }
};

// Time O(n log n), memory O(n).
Topology find_topology(const Mesh& mesh, std::span<const uvec3> triangles);

// What is found out about each mesh once, for all checks.
struct MeshFacts
{
    bool is_placed = false;
    Bounds bounds;                         // of the vertices in triangles
    Topology topology;                     // of the whole
    bool has_solid_glass = false;          // some of its triangles are of a material that light refracts into
    bool is_all_glass = false;             // all of them
    Topology glass;                        // of these; where all are, `topology`
    std::size_t against_normals = 0;       // triangles whose vertex normals point to the back
    double least_edge = 0.0;               // the smallest longest edge of a triangle
    std::vector<uint> emissive, two_sided; // materials of its triangles that shine, on one side and on both
};
std::vector<MeshFacts> find_mesh_facts(const Scene& scene);

// The material of one triangle.
inline uint material_of(const Mesh& mesh, std::size_t triangle)
{
    return (mesh.triangle_materials.empty() ? mesh.material : mesh.triangle_materials[triangle]).value;
}
// Whether a closed and oriented part of a mesh is inside out. Vertex normals, where there are any, say which side is
// outside.
bool faces_inwards(const Mesh& mesh, const MeshFacts& facts, const Topology& part);
// Whether light is refracted into what the surface encloses.
bool is_solid_glass(const MaterialDesc& material);
bool is_emissive(const MaterialDesc& material);

// ---- the themes ----

void count(const Scene& scene, const PackedScene* packed, SceneReport& report);
void take_notes(const Scene& scene, Findings& findings);
void check_shapes(const Scene& scene, const std::vector<MeshFacts>& facts, Findings& findings);
void check_double_faces(const Scene& scene, Findings& findings);
void check_solids(const Scene& scene, const std::vector<MeshFacts>& facts, Findings& findings);
void check_lamps(const Scene& scene, const std::vector<MeshFacts>& facts, Findings& findings);
void check_extents(const Scene& scene, const std::vector<MeshFacts>& facts, const Bounds& bounds, Findings& findings);
void check_placement(const Scene& scene, const std::vector<MeshFacts>& facts, const SceneReport& report,
                     Findings& findings);
void check_materials(const Scene& scene, const std::vector<MeshFacts>& facts, Findings& findings);

} // namespace snell::doctor
