#include "snell/scene/pack_fill.h"

#include "snell/core/error.h"
#include "snell/core/parallel.h"

#include <algorithm>
#include <atomic>
#include <cstring>

namespace snell {

static constexpr std::size_t grain = 1 << 15;

// Bit for bit: a -0 that was a 0 is written too.
template <class T>
static bool put(T& place, const T& value)
{
    if (std::memcmp(&place, &value, sizeof(T)) == 0) return false;
    place = value;
    return true;
}

// put(places[i], value(i)) for all i, in parallel; returns whether anything has changed.
template <class T, class Value>
static bool put_all(T* places, std::size_t count, const Value& value)
{
    std::atomic<bool> changed = false;
    parallel_ranges(count, grain, [&](std::size_t begin, std::size_t end) {
        bool some = false;
        for (std::size_t i = begin; i < end; ++i) some |= put(places[i], value(i));
        if (some) changed.store(true, std::memory_order_relaxed);
    });
    return changed;
}

// Unit length by way of doubles: neither tiny nor huge normals are lost.
static vec3 unit(vec3 n)
{
    const glm::dvec3 v(n);
    const double size = glm::length(v);
    return size > 0.0 ? vec3(v / size) : n;
}

void size_geometry(const PackPlan& plan, PackedScene& packed)
{
    packed.positions.resize(plan.positions);
    packed.normals.resize(plan.normals);
    packed.tangents.resize(plan.tangents);
    packed.uvs.resize(plan.uvs);
    packed.colors.resize(plan.colors);
    packed.triangles.resize(plan.triangles);
    packed.surfaces.resize(plan.surfaces);
    packed.spheres.resize(plan.sphere_placements.size());
    packed.instances.resize(plan.instances.size());
}

void fill_surfaces(const Scene& scene, const PackPlan& plan, const MeshPlacement& placement, PackedScene& packed)
{
    const MeshPlan& mesh_plan = plan.meshes[placement.mesh];
    uint first = placement.first_triangle;
    for (std::size_t r = 0; r < mesh_plan.runs.size(); ++r) {
        Surface& surface = packed.surfaces[placement.first_surface + r];
        surface.material = mesh_plan.runs[r].material;
        surface.object = placement.mesh;
        surface.first_vertex = placement.first_vertex;
        surface.normal_base = placement.normal_base;
        surface.uv_base = mesh_plan.uv_base;
        surface.uv_1_base = mesh_plan.uv_1_base;
        surface.color_base = mesh_plan.color_base;
        surface.tangent_base = placement.tangent_base;
        surface.first_triangle = first;
        surface.first_light = none;
        first += mesh_plan.runs[r].count;
    }
    if (!placement.writes_uvs) return;
    const Mesh& mesh = scene.meshes[placement.mesh];
    if (mesh_plan.uv_base != none) std::copy(mesh.uvs.begin(), mesh.uvs.end(), packed.uvs.begin() + mesh_plan.uv_base);
    if (mesh_plan.uv_1_base != none)
        std::copy(mesh.uvs_1.begin(), mesh.uvs_1.end(), packed.uvs.begin() + mesh_plan.uv_1_base);
    if (mesh_plan.color_base != none)
        std::copy(mesh.colors.begin(), mesh.colors.end(), packed.colors.begin() + mesh_plan.color_base);
}

static const Transform* baked_transform(const Scene& scene, uint instance)
{
    return instance != none ? &scene.instances[instance].transform : nullptr;
}

VertexChanges fill_vertices(const Scene& scene, const MeshPlacement& placement, PackedScene& packed)
{
    if (!placement.writes_vertices) return {};
    const Mesh& mesh = scene.meshes[placement.mesh];
    const Transform* baked = baked_transform(scene, placement.baked);
    const Transform to_world = baked != nullptr ? *baked : identity_transform();
    const Transform to_object = inverse(to_world).value();
    VertexChanges changed;
    changed.positions =
        put_all(packed.positions.data() + placement.first_vertex, mesh.positions.size(), [&](std::size_t i) {
            return baked != nullptr ? transform_point(to_world, mesh.positions[i]) : mesh.positions[i];
        });
    if (!mesh.normals.empty())
        changed.normals = put_all(packed.normals.data() + placement.normal_base, mesh.normals.size(),
                                  [&](std::size_t i) { return unit(transform_normal(to_object, mesh.normals[i])); });
    const float handedness = determinant(to_world) < 0.0f ? -1.0f : 1.0f;
    if (!mesh.tangents.empty())
        put_all(packed.tangents.data() + placement.tangent_base, mesh.tangents.size(), [&](std::size_t i) {
            const vec4 t = mesh.tangents[i];
            return vec4(unit(transform_vector(to_world, vec3(t))), handedness * t.w);
        });
    return changed;
}

// Where a mesh has normals, they say which side is outside. The winding is made to agree, so that lights shine and
// glass refracts on the side that the picture shows.
static bool is_wound_against_normals(const Mesh& mesh, uvec3 t)
{
    if (mesh.normals.empty()) return false;
    const vec3 p = mesh.positions[t.x];
    const vec3 n = mesh.normals[t.x] + mesh.normals[t.y] + mesh.normals[t.z];
    return dot(cross(mesh.positions[t.y] - p, mesh.positions[t.z] - p), n) < 0.0f;
}

bool fill_triangles(const Scene& scene, const PackPlan& plan, const MeshPlacement& placement, PackedScene& packed)
{
    const Mesh& mesh = scene.meshes[placement.mesh];
    const std::vector<MaterialRun>& runs = plan.meshes[placement.mesh].runs;
    const Transform* baked = baked_transform(scene, placement.baked);
    const bool mirrored = baked != nullptr && determinant(*baked) < 0.0f;
    const auto triangle = [&](std::size_t i, uint surface) {
        const uvec3 t = mesh.triangles[i] + uvec3(placement.first_vertex);
        const bool flip = mirrored != is_wound_against_normals(mesh, mesh.triangles[i]);
        return flip ? Triangle{t.x, t.z, t.y, surface} : Triangle{t.x, t.y, t.z, surface};
    };
    Triangle* const places = packed.triangles.data() + placement.first_triangle;
    if (runs.size() == 1)
        return put_all(places, mesh.triangles.size(),
                       [&](std::size_t i) { return triangle(i, placement.first_surface); });

    std::vector<std::size_t> next; // by run: where its next triangle goes
    std::size_t first = 0;
    for (const MaterialRun& run : runs) {
        next.push_back(first);
        first += run.count;
    }
    bool changed = false;
    std::size_t r = 0;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const uint material = mesh.triangle_materials[i].value;
        if (runs[r].material != material)
            r = static_cast<std::size_t>(
                std::lower_bound(runs.begin(), runs.end(), material,
                                 [](const MaterialRun& run, uint m) { return run.material < m; }) -
                runs.begin());
        changed |= put(places[next[r]++], triangle(i, placement.first_surface + static_cast<uint>(r)));
    }
    return changed;
}

bool fill_sphere(const Scene& scene, const PackPlan& plan, std::size_t number, PackedScene& packed)
{
    const SpherePlacement& placement = plan.sphere_placements[number];
    const SphereDesc& desc = scene.spheres[placement.sphere];
    const Transform* baked = baked_transform(scene, placement.baked);
    const Sphere& old = packed.spheres[number];
    Sphere sphere = {};
    sphere.center = baked != nullptr ? transform_point(*baked, desc.center) : desc.center;
    sphere.radius = baked != nullptr ? uniform_scale(*baked) * desc.radius : desc.radius;
    sphere.material = desc.material.value;
    sphere.object = static_cast<uint>(scene.meshes.size() + placement.sphere);
    sphere.light = old.light;
    return put(packed.spheres[number], sphere);
}

bool fill_instance(const Scene& scene, const PackPlan& plan, std::size_t number, PackedScene& packed)
{
    const InstancePlacement& placement = plan.instances[number];
    const Transform& transform = scene.instances[placement.instance].transform;
    Instance& instance = packed.instances[number];
    instance.group = placement.group;
    instance.object = placement.instance;
    if (!put(instance.to_world, transform)) return false;
    instance.to_object = inverse(transform).value();
    return true;
}

void fill_bounds(const Bounds& bounds, PackedScene& packed)
{
    packed.center = vec3(0.0f);
    packed.radius = 1.0f;
    if (bounds.empty()) return;
    packed.center = bounds.center();
    const float radius = 0.5f * length(bounds.extent());
    if (radius > 0.0f) packed.radius = radius;
}

} // namespace snell
