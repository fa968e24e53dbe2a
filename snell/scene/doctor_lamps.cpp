// Lamps that shine on one side only, and on the wrong one: the usual reason of a black picture.
#include "snell/scene/doctor_parts.h"
#include "snell/scene/validate_mesh.h"

#include <algorithm>
#include <cmath>

namespace snell::doctor {

using Severity = Finding::Severity;

static constexpr std::size_t most_lamps = 1024;
static constexpr std::size_t points_of_a_lamp = 16;
static constexpr std::size_t points_of_the_scene = 512;

namespace {
// A point of a surface in the world.
struct SurfacePoint
{
    vec3 position, normal; // unit length, on the side that a lamp shines to
    float area;
    uint instance, mesh, material;
};

// The triangles of one material of a mesh.
struct Shining
{
    std::size_t count = 0;
    std::vector<std::size_t> sampled; // some of them
};
} // namespace

// Whether the vertex normals say that outside is on the other side than the winding does.
static bool is_turned(const Mesh& mesh, uvec3 t)
{
    if (mesh.normals.empty()) return false;
    const vec3 n = cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]);
    return dot(n, mesh.normals[t.x] + mesh.normals[t.y] + mesh.normals[t.z]) < 0.0f;
}

// The middle of a triangle where it stands in the world. A map that mirrors keeps the side of the normal.
static SurfacePoint middle_of(const Scene& scene, uint mesh_index, uint instance, std::size_t triangle)
{
    const Mesh& mesh = scene.meshes[mesh_index];
    const Transform& m = scene.instances[instance].transform;
    const uvec3 t = mesh.triangles[triangle];
    const glm::dvec3 a(transform_point(m, mesh.positions[t.x])), b(transform_point(m, mesh.positions[t.y])),
        c(transform_point(m, mesh.positions[t.z]));
    const glm::dvec3 n = glm::cross(b - a, c - a);
    const double size = glm::length(n);
    const bool is_seen = size > 0.0 && std::isfinite(size);
    SurfacePoint point;
    point.position = vec3((a + b + c) / 3.0);
    const float side = (determinant(m) < 0.0f) != is_turned(mesh, t) ? -1.0f : 1.0f;
    point.normal = is_seen ? side * vec3(n / size) : vec3(0.0f);
    point.area = is_seen ? static_cast<float>(0.5 * size) : 0.0f;
    point.instance = instance;
    point.mesh = mesh_index;
    point.material = material_of(mesh, triangle);
    return point;
}

// Points all over the scene, more where there is more surface: of each placed mesh some triangles, and of these those
// that stand for equal shares of the area.
static std::vector<SurfacePoint> sample_scene(const Scene& scene)
{
    constexpr std::size_t most_candidates = std::size_t{1} << 17, of_a_mesh = 64;
    std::vector<SurfacePoint> candidates;
    const std::size_t instance_step = scene.instances.size() / (most_candidates / of_a_mesh) + 1;
    for (std::size_t i = 0; i < scene.instances.size(); i += instance_step) {
        for (const Index<Mesh> mesh : scene.groups[scene.instances[i].group.value].meshes) {
            if (candidates.size() >= most_candidates) break;
            const std::size_t count = scene.meshes[mesh.value].triangles.size();
            const std::size_t step = count / of_a_mesh + 1, first = candidates.size();
            for (std::size_t t = step / 2; t < count; t += step)
                candidates.push_back(middle_of(scene, mesh.value, static_cast<uint>(i), t));
            for (std::size_t k = first; k < candidates.size(); ++k) candidates[k].area *= static_cast<float>(step);
        }
    }
    double total = 0.0;
    for (const SurfacePoint& point : candidates) total += static_cast<double>(point.area);
    std::vector<SurfacePoint> chosen;
    double sum = 0.0;
    const double share = total / static_cast<double>(points_of_the_scene);
    for (const SurfacePoint& point : candidates) {
        const double before = std::floor(sum / share);
        sum += static_cast<double>(point.area);
        if (std::floor(sum / share) > before) chosen.push_back(point);
    }
    // A big floor must not hide the small thing that stands on it.
    const std::size_t step = candidates.size() / points_of_the_scene + 1;
    for (std::size_t i = 0; i < candidates.size(); i += step) chosen.push_back(candidates[i]);
    return chosen;
}

// Parts of what else there is that lie well in front of and behind a lamp.
struct Sides
{
    double front = 0.0, back = 0.0, all = 0.0;
};

static Sides look_around(const std::vector<SurfacePoint>& lamp, const std::vector<SurfacePoint>& scene)
{
    constexpr float grazing = 0.05f; // the ceiling that a lamp hangs from is not what it lights
    Sides sides;
    for (const SurfacePoint& from : lamp) {
        for (const SurfacePoint& to : scene) {
            if (to.instance == from.instance && to.mesh == from.mesh && to.material == from.material) continue;
            const vec3 d = to.position - from.position;
            const float cosine = dot(d, from.normal) / std::max(length(d), 1e-30f);
            const double weight = static_cast<double>(from.area);
            sides.all += weight;
            if (cosine > grazing) sides.front += weight;
            if (cosine < -grazing) sides.back += weight;
        }
    }
    return sides;
}

static Shining find_shining(const Mesh& mesh, uint material)
{
    std::vector<std::size_t> all;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
        if (material_of(mesh, i) == material) all.push_back(i);
    Shining shining;
    shining.count = all.size();
    const std::size_t step = all.size() / points_of_a_lamp + 1;
    for (std::size_t i = step / 2; i < all.size(); i += step) shining.sampled.push_back(all[i]);
    return shining;
}

static void check_lamp(const Scene& scene, uint mesh_index, uint instance, uint material, const MeshFacts& facts,
                       const Shining& shining, const std::vector<SurfacePoint>& surroundings, Findings& findings)
{
    const Mesh& mesh = scene.meshes[mesh_index];
    const std::string who =
        fmt::format("{} (material {})", mesh_label(scene, mesh_index), label(scene.materials[material].name, material));
    const Topology& shape = facts.topology;
    const bool is_solid = shape.is_closed() && shape.is_oriented();
    if (is_solid && faces_inwards(mesh, facts, shape)) {
        findings.add("hidden-lamp", Severity::doubtful,
                     fmt::format("{} is a closed lamp that is inside out: it shines into itself; flip its triangles, "
                                 "or let it shine on both sides",
                                 who),
                     shining.count);
        return;
    }
    if ((is_solid && shining.count == mesh.triangles.size()) || surroundings.empty()) return;
    std::vector<SurfacePoint> lamp;
    for (const std::size_t triangle : shining.sampled) lamp.push_back(middle_of(scene, mesh_index, instance, triangle));
    const Sides sides = look_around(lamp, surroundings);
    constexpr double nothing = 0.01, much = 0.3;
    if (sides.all > 0.0 && sides.front < nothing * sides.all && sides.back > much * sides.all)
        findings.add("lamp-faces-away", Severity::doubtful,
                     fmt::format("{} shines on one side only, and the scene is on the other: flip its triangles, or "
                                 "let it shine on both sides",
                                 who),
                     shining.count);
}

void check_lamps(const Scene& scene, const std::vector<MeshFacts>& facts, Findings& findings)
{
    if (std::none_of(facts.begin(), facts.end(), [](const MeshFacts& f) { return !f.emissive.empty(); })) return;
    const std::vector<SurfacePoint> surroundings = sample_scene(scene);
    std::vector<std::vector<uint>> lamps(scene.groups.size()); // meshes
    for (std::size_t g = 0; g < lamps.size(); ++g)
        for (const Index<Mesh> mesh : scene.groups[g].meshes)
            if (!facts[mesh.value].emissive.empty()) lamps[g].push_back(mesh.value);
    std::map<std::pair<uint, uint>, Shining> shining; // by mesh and material
    std::size_t looked_at = 0;
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        for (const uint mesh : lamps[scene.instances[i].group.value]) {
            for (const uint material : facts[mesh].emissive) {
                if (++looked_at > most_lamps) {
                    findings.add("partly-examined", Severity::info,
                                 fmt::format("there are many lamps: only the first {} were looked at for shining the "
                                             "wrong way",
                                             most_lamps));
                    return;
                }
                const auto [found, is_new] = shining.try_emplace({mesh, material});
                if (is_new) found->second = find_shining(scene.meshes[mesh], material);
                check_lamp(scene, mesh, static_cast<uint>(i), material, facts[mesh], found->second, surroundings,
                           findings);
            }
        }
    }
}

} // namespace snell::doctor
