// Triangles and instances that are there twice.
#include "snell/core/parallel.h"
#include "snell/scene/doctor_parts.h"
#include "snell/scene/validate_mesh.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace snell::doctor {

using Severity = Finding::Severity;

static constexpr std::size_t most_compared = std::size_t{1} << 22;
static constexpr std::size_t most_visited = std::size_t{1} << 26;
static constexpr std::size_t grain = 1 << 14;

static std::uint64_t mix_bits(std::uint64_t h, std::uint32_t word)
{
    h = (h ^ word) * 0xff51afd7ed558ccdull;
    return h ^ (h >> 32);
}

using Corners = std::array<vec3, 3>;

static bool is_less(vec3 a, vec3 b)
{
    return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
}

// Puts the corners in an order that does not depend on where the triangle begins or how it is wound. Returns whether
// that turned it over.
static bool sort_corners(Corners& c)
{
    bool turned = false;
    const auto order = [&](std::size_t i, std::size_t j) {
        if (!is_less(c[j], c[i])) return;
        std::swap(c[i], c[j]);
        turned = !turned;
    };
    order(0, 1);
    order(1, 2);
    order(0, 1);
    return turned;
}

// One mesh where it stands.
struct Placed
{
    uint mesh;
    const Transform* to_world;
};

// Every mesh in the first place of each of its groups.
static std::vector<Placed> first_places(const Scene& scene)
{
    std::vector<Placed> result;
    std::vector<bool> seen(scene.groups.size(), false);
    std::size_t visited = 0;
    for (const InstanceDesc& instance : scene.instances) {
        if (seen[instance.group.value]) continue;
        seen[instance.group.value] = true;
        for (const Index<Mesh> mesh : scene.groups[instance.group.value].meshes) {
            visited += scene.meshes[mesh.value].triangles.size();
            if (visited > most_visited) return result;
            result.push_back({mesh.value, &instance.transform});
        }
    }
    return result;
}

static Corners corners_of(const Scene& scene, const Placed& placed, std::size_t triangle)
{
    const Mesh& mesh = scene.meshes[placed.mesh];
    const uvec3 t = mesh.triangles[triangle];
    Corners c;
    for (int k = 0; k < 3; ++k)
        c[static_cast<std::size_t>(k)] = transform_point(*placed.to_world, mesh.positions[t[k]]) + vec3(0.0f);
    return c;
}

struct Face
{
    std::uint64_t hash; // of where it is
    uint placed, triangle;
};

// All faces, or of a huge scene those with certain hashes: of a pair either both or none.
static std::vector<Face> hash_faces(const Scene& scene, const std::vector<Placed>& places)
{
    std::vector<std::size_t> begin = {0};
    for (const Placed& placed : places) begin.push_back(begin.back() + scene.meshes[placed.mesh].triangles.size());
    const std::size_t one_of = begin.back() / most_compared + 1;
    std::vector<std::vector<Face>> kept(places.size());
    parallel_for(places.size(), [&](std::size_t p) {
        const std::size_t count = begin[p + 1] - begin[p];
        kept[p].reserve(one_of == 1 ? count : 0);
        for (std::size_t i = 0; i < count; ++i) {
            Corners c = corners_of(scene, places[p], i);
            sort_corners(c);
            std::uint64_t hash = 0x9e3779b97f4a7c15ull;
            for (const vec3 v : c)
                for (int k = 0; k < 3; ++k) hash = mix_bits(hash, floatBitsToUint(v[k]));
            if (one_of == 1 || (hash >> 20) % one_of == 0)
                kept[p].push_back({hash, static_cast<uint>(p), static_cast<uint>(i)});
        }
    });
    std::vector<Face> faces;
    for (std::vector<Face>& of_place : kept) {
        faces.insert(faces.end(), of_place.begin(), of_place.end());
        std::vector<Face>().swap(of_place);
    }
    std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) {
        return a.hash != b.hash       ? a.hash < b.hash
               : a.placed != b.placed ? a.placed < b.placed
                                      : a.triangle < b.triangle;
    });
    return faces;
}

// Whether it makes a difference that a surface of this material is there twice.
static bool shows_twice(const MaterialDesc& m)
{
    return is_solid_glass(m) || is_emissive(m) || m.coverage == coverage_blend ||
           (m.kind == material_principled && m.principled.transmission > 0.0f);
}

void check_double_faces(const Scene& scene, Findings& findings)
{
    const std::vector<Placed> places = first_places(scene);
    const std::vector<Face> faces = hash_faces(scene, places);
    struct Pair
    {
        std::size_t count = 0, turned = 0;
        bool matters = false;
    };
    std::map<std::pair<uint, uint>, Pair> pairs; // of meshes
    for (std::size_t i = 1; i < faces.size(); ++i) {
        if (faces[i].hash != faces[i - 1].hash) continue;
        const Placed &first = places[faces[i - 1].placed], &second = places[faces[i].placed];
        Corners a = corners_of(scene, first, faces[i - 1].triangle), b = corners_of(scene, second, faces[i].triangle);
        const bool turned = sort_corners(a) != sort_corners(b);
        if (a != b) continue;
        Pair& pair = pairs[{first.mesh, second.mesh}];
        ++pair.count;
        pair.turned += turned ? 1 : 0;
        const uint material_a = material_of(scene.meshes[first.mesh], faces[i - 1].triangle);
        const uint material_b = material_of(scene.meshes[second.mesh], faces[i].triangle);
        const MaterialDesc &m = scene.materials[material_a], &n = scene.materials[material_b];
        // Back to back, the camera sees of each its own side.
        const bool is_two_sided_model = turned && m.single_sided && n.single_sided;
        const bool differ = material_a != material_b && !is_two_sided_model;
        pair.matters = pair.matters || differ || shows_twice(m) || shows_twice(n);
    }
    for (const auto& [meshes, pair] : pairs) {
        const std::string where =
            meshes.first == meshes.second
                ? fmt::format("{}: {} there twice", mesh_label(scene, meshes.first), amount(pair.count, "triangle"))
                : fmt::format("{} and {}: {} in the same place", mesh_label(scene, meshes.first),
                              mesh_label(scene, meshes.second), amount(pair.count, "triangle"));
        const std::string back = pair.turned == pair.count ? ", back to back" : "";
        findings.add("double-faces", pair.matters ? Severity::doubtful : Severity::info,
                     where + back +
                         (pair.matters ? ": which of the two a ray meets is left to rounding; remove one of them"
                                       : ", which makes no difference but in time"),
                     pair.count);
    }

    // The same for whole instances.
    std::vector<std::pair<std::uint64_t, uint>> keys(scene.instances.size());
    for (std::size_t i = 0; i < keys.size(); ++i) {
        const InstanceDesc& instance = scene.instances[i];
        std::uint64_t hash = mix_bits(0x9e3779b97f4a7c15ull, instance.group.value);
        for (const vec4 row : {instance.transform.x, instance.transform.y, instance.transform.z})
            for (int k = 0; k < 4; ++k) hash = mix_bits(hash, floatBitsToUint(row[k] + 0.0f));
        keys[i] = {hash, static_cast<uint>(i)};
    }
    std::sort(keys.begin(), keys.end());
    for (std::size_t i = 1; i < keys.size(); ++i) {
        if (keys[i].first != keys[i - 1].first) continue;
        const InstanceDesc &a = scene.instances[keys[i - 1].second], &b = scene.instances[keys[i].second];
        const Group& group = scene.groups[a.group.value];
        if (a.group != b.group || (group.meshes.empty() && group.spheres.empty())) continue;
        findings.add("double-instance", Severity::doubtful,
                     fmt::format("instances {} and {} place the same thing in the same place; remove one of them",
                                 label(a.name, keys[i - 1].second), label(b.name, keys[i].second)));
    }
}

} // namespace snell::doctor
