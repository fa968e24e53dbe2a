// Sizes and places at which the precision of floats runs out, and how things are placed.
#include "snell/core/parallel.h"
#include "snell/scene/doctor_parts.h"
#include "snell/scene/validate_mesh.h"

#include <algorithm>
#include <atomic>
#include <cmath>

namespace snell::doctor {

using Severity = Finding::Severity;

static constexpr std::size_t grain = 1 << 15;

static float largest_coordinate(const Bounds& bounds)
{
    return std::max(max3(abs(bounds.lower)), max3(abs(bounds.upper)));
}

// The distance between neighbouring floats of that size.
static double spacing(float value)
{
    return static_cast<double>(std::nextafter(value, infinity())) - static_cast<double>(value);
}

// ---- the whole ----

// Rays start some 256 units in the last place off a surface: that must be small against what the scene is made of.
static void check_whole(const Bounds& bounds, Findings& findings)
{
    if (bounds.empty()) return;
    const float radius = 0.5f * length(bounds.extent()), far = largest_coordinate(bounds);
    constexpr float smallest = 1e-3f, largest = 1e4f, farthest = 4e3f;
    if (radius < smallest)
        findings.add("tiny-scene", Severity::doubtful,
                     fmt::format("the whole scene has a radius of {:.3g}: light leaks at edges and contacts below "
                                 "0.001; scale it up",
                                 radius));
    if (radius > largest)
        findings.add("huge-scene", Severity::info,
                     fmt::format("the scene has a radius of {:.3g}: if its unit is the millimetre, distances in "
                                 "materials and the power of lights may be meant for another",
                                 radius));
    if (far > farthest * radius)
        findings.add("far-from-origin", Severity::doubtful,
                     fmt::format("the scene lies {:.3g} times its radius away from the origin, where floats are too "
                                 "coarse for it: light leaks at edges and contacts; move it to the origin",
                                 far / radius));
}

// ---- meshes where they stand ----

// The most that the map shrinks any length by is at most this.
static double least_scale(const Transform& to_object)
{
    double sum = 0.0;
    for (const vec4 row : {to_object.x, to_object.y, to_object.z})
        for (int k = 0; k < 3; ++k) sum += static_cast<double>(row[k]) * static_cast<double>(row[k]);
    return sum > 0.0 ? 1.0 / std::sqrt(sum) : 0.0;
}

static std::size_t count_tiny_triangles(const Mesh& mesh, const Transform& m)
{
    constexpr double units = 16.0; // below, the corners' rounding shows in the shape
    std::atomic<std::size_t> tiny = 0;
    parallel_ranges(mesh.triangles.size(), grain, [&](std::size_t begin, std::size_t end) {
        std::size_t here = 0;
        for (std::size_t i = begin; i < end; ++i) {
            const uvec3 t = mesh.triangles[i];
            const vec3 a = transform_point(m, mesh.positions[t.x]), b = transform_point(m, mesh.positions[t.y]),
                       c = transform_point(m, mesh.positions[t.z]);
            const double longest = static_cast<double>(std::max({length(b - a), length(c - a), length(c - b)}));
            const float at = std::max({max3(abs(a)), max3(abs(b)), max3(abs(c))});
            if (longest < units * spacing(at)) ++here;
        }
        if (here > 0) tiny += here;
    });
    return tiny;
}

static void check_tiny_triangles(const Scene& scene, const std::vector<MeshFacts>& facts, Findings& findings)
{
    std::size_t left = std::size_t{1} << 26; // triangles to look at
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        const InstanceDesc& instance = scene.instances[i];
        const double scale = least_scale(inverse(instance.transform).value());
        for (const Index<Mesh> index : scene.groups[instance.group.value].meshes) {
            const MeshFacts& mesh = facts[index.value];
            if (mesh.bounds.empty()) continue;
            const double coarse = spacing(largest_coordinate(transformed(mesh.bounds, instance.transform)));
            if (mesh.least_edge * scale > 32.0 * coarse) continue;
            const std::size_t count = scene.meshes[index.value].triangles.size();
            if (count > left) {
                findings.add("partly-examined", Severity::info,
                             "there are too many triangles near the precision of floats to look at each");
                return;
            }
            left -= count;
            const std::size_t tiny = count_tiny_triangles(scene.meshes[index.value], instance.transform);
            if (tiny == 0) continue;
            // A few slivers of a scan are no reason to doubt it.
            const bool many = tiny * 100 > count;
            findings.add("tiny-triangles", many ? Severity::doubtful : Severity::info,
                         fmt::format("{}: {} of {} are hardly larger than the distance between floats at their "
                                     "place; move the scene to the origin or drop them",
                                     mesh_label(scene, index.value), tiny, amount(count, "triangle")),
                         tiny);
        }
    }
}

// ---- single vertices ----

// Vertices far away from all others of their mesh, as a slip of an exporter leaves them.
static void check_stray_vertices(const Scene& scene, uint index, Findings& findings)
{
    const Mesh& mesh = scene.meshes[index];
    constexpr std::size_t sampled = 2048, fewest = 64;
    if (mesh.triangles.size() < fewest) return;
    std::vector<float> of_axis[3];
    const std::size_t step = mesh.triangles.size() / sampled + 1;
    for (std::size_t i = 0; i < mesh.triangles.size(); i += step)
        for (std::size_t k = 0; k < 3; ++k)
            of_axis[k].push_back(mesh.positions[mesh.triangles[i].x][static_cast<int>(k)]);
    vec3 center(0.0f);
    float reach = 0.0f; // that of nine in ten
    for (std::size_t k = 0; k < 3; ++k) {
        std::sort(of_axis[k].begin(), of_axis[k].end());
        const std::size_t count = of_axis[k].size();
        center[static_cast<int>(k)] = of_axis[k][count / 2];
        reach = std::max(reach, of_axis[k][count - 1 - count / 20] - of_axis[k][count / 20]);
    }
    constexpr float far = 1e3f;
    if (!(reach > 0.0f)) return;
    std::size_t stray = 0;
    for (const uvec3 t : mesh.triangles) {
        bool is_stray = false;
        for (int k = 0; k < 3; ++k) is_stray = is_stray || max3(abs(mesh.positions[t[k]] - center)) > far * reach;
        stray += is_stray ? 1 : 0;
    }
    if (stray > 0)
        findings.add("stray-vertices", Severity::doubtful,
                     fmt::format("{}: {} over {} times as far out as the rest of the mesh is wide; a slip of the "
                                 "exporter?",
                                 mesh_label(scene, index),
                                 amount(stray, "triangle") + (stray == 1 ? " reaches" : " reach"), far),
                     stray);
}

void check_extents(const Scene& scene, const std::vector<MeshFacts>& facts, const Bounds& bounds, Findings& findings)
{
    check_whole(bounds, findings);
    check_tiny_triangles(scene, facts, findings);
    for (std::size_t i = 0; i < scene.meshes.size(); ++i)
        if (facts[i].is_placed) check_stray_vertices(scene, static_cast<uint>(i), findings);
}

// ---- placement ----

void check_placement(const Scene& scene, const std::vector<MeshFacts>& facts, const SceneReport& report,
                     Findings& findings)
{
    if (report.mirrored_instances > 0)
        findings.add("mirrored-instances", Severity::info,
                     fmt::format("{} mirrored (a negative scale); what is outside stays outside",
                                 amount(report.mirrored_instances, "instance") +
                                     (report.mirrored_instances == 1 ? " is" : " are")),
                     report.mirrored_instances);
    for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
        if (facts[i].is_placed && scene.meshes[i].triangles.empty())
            findings.add("empty-mesh", Severity::info,
                         fmt::format("{} has no triangles", mesh_label(scene, static_cast<uint>(i))));
        if (!facts[i].is_placed)
            findings.add("unplaced-mesh", Severity::info,
                         fmt::format("{} is not placed anywhere", mesh_label(scene, static_cast<uint>(i))));
    }
    if (report.placed_triangles + report.placed_spheres + scene.planes.size() == 0)
        findings.add("empty-scene", Severity::doubtful, "the scene is empty: there is nothing to see");
    if (scene.cameras.empty())
        findings.add("no-camera", Severity::info, "the file has no camera: one that frames the scene is added");
    const EnvironmentDesc& environment = scene.environment;
    bool is_lit = !is_black(environment.radiance) || report.light_count > 0;
    for (const MaterialDesc& material : scene.materials) is_lit = is_lit || material.kind == material_unlit;
    for (const PlaneDesc& plane : scene.planes) is_lit = is_lit || is_emissive(scene.materials[plane.material.value]);
    if (!is_lit) findings.add("no-light", Severity::info, "the file has no light: a neutral one is added");
}

} // namespace snell::doctor
