// Which way meshes face, and whether glass encloses something.
#include "snell/scene/doctor_parts.h"
#include "snell/scene/validate_mesh.h"

#include <algorithm>

namespace snell::doctor {

using Severity = Finding::Severity;

// Of the solid glass of a mesh, the first one's name.
static std::string glass_label(const Scene& scene, const Mesh& mesh)
{
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const uint material = material_of(mesh, i);
        if (is_solid_glass(scene.materials[material])) return label(scene.materials[material].name, material);
    }
    return "?";
}

bool faces_inwards(const Mesh& mesh, const MeshFacts& facts, const Topology& part)
{
    const double size = static_cast<double>(length(facts.bounds.extent()));
    const double least = 1e-7 * size * size * size; // what is flatter encloses nothing
    const bool normals_decide = facts.against_normals * 2 > mesh.triangles.size();
    const double volume = normals_decide ? -part.volume : part.volume;
    return volume < -least;
}

// The solid glass of all meshes of a group as one mesh.
static Mesh join_glass(const Scene& scene, const Group& group, const std::vector<MeshFacts>& facts)
{
    Mesh joined;
    for (const Index<Mesh> index : group.meshes) {
        if (!facts[index.value].has_solid_glass) continue;
        const Mesh& mesh = scene.meshes[index.value];
        const uint first = static_cast<uint>(joined.positions.size());
        joined.positions.insert(joined.positions.end(), mesh.positions.begin(), mesh.positions.end());
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
            if (is_solid_glass(scene.materials[material_of(mesh, i)]))
                joined.triangles.push_back(mesh.triangles[i] + uvec3(first));
    }
    return joined;
}

// Meshes of open glass that others of their group close: exporters cut one body into pieces.
static std::vector<bool> find_closed_by_others(const Scene& scene, const std::vector<MeshFacts>& facts)
{
    std::vector<bool> closed(scene.meshes.size(), false), seen(scene.meshes.size(), false);
    for (const Group& group : scene.groups) {
        std::size_t open = 0;
        bool is_new = false;
        for (const Index<Mesh> mesh : group.meshes) {
            if (!facts[mesh.value].has_solid_glass || facts[mesh.value].glass.is_closed()) continue;
            ++open;
            is_new = is_new || !seen[mesh.value]; // so that the work stays linear however often a mesh is grouped
            seen[mesh.value] = true;
        }
        if (open < 2 || !is_new) continue;
        const Mesh joined = join_glass(scene, group, facts);
        if (!find_topology(joined, joined.triangles).is_closed()) continue;
        for (const Index<Mesh> mesh : group.meshes) closed[mesh.value] = true;
    }
    return closed;
}

static void check_glass(const Scene& scene, uint index, const MeshFacts& facts, bool closed_by_others,
                        Findings& findings)
{
    const Mesh& mesh = scene.meshes[index];
    const Topology& glass = facts.glass;
    if (!glass.is_closed()) {
        if (closed_by_others) return;
        findings.add("open-glass", Severity::doubtful,
                     fmt::format("{}: its glass (material {}) is not closed, {}: light that goes in does not come out "
                                 "as it should; close the mesh, or make the material thin-walled",
                                 mesh_label(scene, index), glass_label(scene, mesh),
                                 glass.triangles == 0 ? std::string("its triangles are all lines")
                                                      : amount(glass.open_edges, "edge") + " open"),
                     glass.open_edges);
    } else if (!glass.is_oriented()) {
        findings.add("mixed-winding-glass", Severity::doubtful,
                     fmt::format("{}: neighbouring triangles of its glass (material {}) disagree about which side is "
                                 "outside, at {}; recalculate the normals towards the outside",
                                 mesh_label(scene, index), glass_label(scene, mesh), amount(glass.odd_edges, "edge")),
                     glass.odd_edges);
    } else if (faces_inwards(mesh, facts, glass)) {
        findings.add("inside-out-glass", Severity::doubtful,
                     fmt::format("{}: its glass (material {}) is inside out: its triangles face inwards, so light is "
                                 "refracted the wrong way; flip them",
                                 mesh_label(scene, index), glass_label(scene, mesh)),
                     glass.triangles);
    }
}

void check_shapes(const Scene& scene, const std::vector<MeshFacts>& facts, Findings& findings)
{
    const std::vector<bool> closed_by_others = find_closed_by_others(scene, facts);
    for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
        const MeshFacts& of_mesh = facts[i];
        const Mesh& mesh = scene.meshes[i];
        const uint index = static_cast<uint>(i);
        if (!of_mesh.is_placed || mesh.triangles.empty()) continue;
        if (of_mesh.against_normals * 2 > mesh.triangles.size())
            findings.add("normals-against-winding", Severity::doubtful,
                         fmt::format("{}: the vertex normals of {} of {} point to the back of their triangles: the "
                                     "normals are taken to point outwards; flip them or the triangles",
                                     mesh_label(scene, index), of_mesh.against_normals,
                                     amount(mesh.triangles.size(), "triangle")),
                         of_mesh.against_normals);
        if (of_mesh.has_solid_glass)
            check_glass(scene, index, of_mesh, closed_by_others[i], findings);
        else if (of_mesh.emissive.empty() && of_mesh.topology.is_closed() && of_mesh.topology.is_oriented() &&
                 faces_inwards(mesh, of_mesh, of_mesh.topology))
            findings.add("inside-out", Severity::info,
                         fmt::format("{}: is closed and faces inwards, as a room does; {}", mesh_label(scene, index),
                                     scene.materials[material_of(mesh, 0)].single_sided
                                         ? "from outside the camera looks through its near sides"
                                         : "it looks the same from both sides unless it becomes glass or a lamp"),
                         mesh.triangles.size());
    }
}

} // namespace snell::doctor
