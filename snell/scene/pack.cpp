// From the scene that people edit to the flat arrays that kernels read.
//
// First the plan, serially and by object: which groups move into world space, and where in the arrays each mesh of
// each run goes. Then the filling, in parallel and by element. Lights come last, from the finished primitives.
#include "snell/core/error.h"
#include "snell/core/parallel.h"
#include "snell/scene/lights.h"
#include "snell/scene/pack_parts.h"
#include "snell/scene/packed.h"

#include <algorithm>
#include <cmath>

namespace snell {

static constexpr std::size_t grain = 1 << 15;

static constexpr std::size_t max_primitives = std::size_t{1} << 30; // two bits of Hit::primitive hold the kind

// ---- maps ----

static bool is_unrotated(const Transform& m)
{
    return m.x.x > 0.0f && m.y.y > 0.0f && m.z.z > 0.0f && m.x.y == 0.0f && m.x.z == 0.0f && m.y.x == 0.0f &&
           m.y.z == 0.0f && m.z.x == 0.0f && m.z.y == 0.0f;
}

// Unit length by way of doubles: neither tiny nor huge normals are lost.
static vec3 unit(vec3 n)
{
    const glm::dvec3 v(n);
    const double size = glm::length(v);
    return size > 0.0 ? vec3(v / size) : n;
}

// ---- the plan ----

// A run of triangles of one mesh with one material.
struct MaterialRun
{
    uint material;
    uint count;
};

// What of a mesh is the same wherever it is placed.
struct MeshPlan
{
    bool planned = false;
    std::vector<MaterialRun> runs; // by material
    uint uv_base = none, uv_1_base = none, color_base = none;
    uint object_positions = none, object_normals = none,
         object_tangents = none; // if it is in a group that stays in object space
};

// One mesh in one run of primitives.
struct MeshPlacement
{
    uint mesh;
    const InstanceDesc* baked; // the transform to apply; nullptr: object space
    uint first_vertex, normal_base, tangent_base, first_triangle, first_surface;
    bool writes_vertices; // false: shared with an earlier placement
};

struct SpherePlacement
{
    uint sphere;
    const InstanceDesc* baked;
};

namespace {
class Packer
{
  public:
    Packer(const Scene& scene, PackedScene& packed) : scene_(scene), packed_(packed) {}

    void run()
    {
        pack_materials(scene_, packed_);
        pack_images(scene_, packed_);
        plan_groups();
        fill_meshes();
        fill_spheres();
        pack_planes();
        const Bounds bounds = scene_bounds(scene_);
        if (!bounds.empty()) {
            packed_.center = bounds.center();
            const float radius = 0.5f * length(bounds.extent());
            if (radius > 0.0f) packed_.radius = radius;
        }
        pack_lights(scene_, packed_);
        pack_environment(scene_, packed_);
    }

  private:
    bool can_be_baked(const InstanceDesc& instance) const;
    void plan_groups();
    void plan_mesh(uint mesh);
    PackedGroup add_group(const Group& group, const InstanceDesc* baked);
    void fill_meshes();
    void fill_placement(const MeshPlacement& placement);
    void fill_triangles(const MeshPlacement& placement);
    void fill_spheres();
    void pack_planes();

    const Scene& scene_;
    PackedScene& packed_;
    std::vector<MeshPlan> meshes_;
    std::vector<MeshPlacement> mesh_placements_;
    std::vector<SpherePlacement> sphere_placements_;
    std::vector<std::uint8_t> writes_uvs_; // by placement: the first one of each mesh
    std::size_t positions_ = 0, normals_ = 0, tangents_ = 0, uvs_ = 0, colors_ = 0, triangles_ = 0, surfaces_ = 0;
};
} // namespace

// A map that makes spheres ellipsoids, or that turns textured ones, cannot be applied beforehand.
bool Packer::can_be_baked(const InstanceDesc& instance) const
{
    const Group& group = scene_.groups[instance.group.value];
    if (group.spheres.empty()) return true;
    if (uniform_scale(instance.transform) == 0.0f) return false;
    if (is_unrotated(instance.transform)) return true;
    return std::none_of(group.spheres.begin(), group.spheres.end(), [&](Index<SphereDesc> sphere) {
        return is_textured(packed_.materials[scene_.spheres[sphere.value].material.value]);
    });
}

void Packer::plan_mesh(uint index)
{
    MeshPlan& plan = meshes_[index];
    if (plan.planned) return;
    plan.planned = true;
    const Mesh& mesh = scene_.meshes[index];
    if (!mesh.uvs.empty()) {
        plan.uv_base = static_cast<uint>(uvs_);
        uvs_ += mesh.uvs.size();
    }
    if (!mesh.uvs_1.empty()) {
        plan.uv_1_base = static_cast<uint>(uvs_);
        uvs_ += mesh.uvs_1.size();
    }
    if (!mesh.colors.empty()) {
        plan.color_base = static_cast<uint>(colors_);
        colors_ += mesh.colors.size();
    }
    if (mesh.triangles.empty()) return;
    if (mesh.triangle_materials.empty()) {
        plan.runs = {{mesh.material.value, static_cast<uint>(mesh.triangles.size())}};
        return;
    }
    // Count neighbours of one material together first: what is then sorted is short for ordinary meshes.
    for (const Index<MaterialDesc> material : mesh.triangle_materials) {
        if (plan.runs.empty() || plan.runs.back().material != material.value) plan.runs.push_back({material.value, 0});
        ++plan.runs.back().count;
    }
    std::sort(plan.runs.begin(), plan.runs.end(),
              [](const MaterialRun& a, const MaterialRun& b) { return a.material < b.material; });
    std::size_t kept = 0;
    for (std::size_t i = 1; i < plan.runs.size(); ++i) {
        if (plan.runs[i].material == plan.runs[kept].material)
            plan.runs[kept].count += plan.runs[i].count;
        else
            plan.runs[++kept] = plan.runs[i];
    }
    plan.runs.resize(kept + 1);
    plan.runs.shrink_to_fit();
}

// Appends the group's primitives to the plan.
PackedGroup Packer::add_group(const Group& group, const InstanceDesc* baked)
{
    PackedGroup result;
    result.first_triangle = static_cast<uint>(triangles_);
    result.first_sphere = static_cast<uint>(sphere_placements_.size());
    for (const Index<Mesh> index : group.meshes) {
        const Mesh& mesh = scene_.meshes[index.value];
        if (mesh.triangles.empty()) continue;
        MeshPlan& plan = meshes_[index.value];
        writes_uvs_.push_back(plan.planned ? 0 : 1);
        plan_mesh(index.value);

        const bool is_shared = baked == nullptr && plan.object_positions != none;
        MeshPlacement p = {};
        p.mesh = index.value;
        p.baked = baked;
        p.writes_vertices = !is_shared;
        p.first_vertex = is_shared ? plan.object_positions : static_cast<uint>(positions_);
        p.normal_base = mesh.normals.empty() ? none : is_shared ? plan.object_normals : static_cast<uint>(normals_);
        p.tangent_base = mesh.tangents.empty() ? none : is_shared ? plan.object_tangents : static_cast<uint>(tangents_);
        p.first_triangle = static_cast<uint>(triangles_);
        p.first_surface = static_cast<uint>(surfaces_);
        mesh_placements_.push_back(p);
        if (baked == nullptr) {
            plan.object_positions = p.first_vertex;
            plan.object_normals = p.normal_base;
            plan.object_tangents = p.tangent_base;
        }
        if (!is_shared) {
            positions_ += mesh.positions.size();
            normals_ += mesh.normals.size();
            tangents_ += mesh.tangents.size();
        }
        triangles_ += mesh.triangles.size();
        surfaces_ += plan.runs.size();
        if (triangles_ >= max_primitives || positions_ >= none)
            throw Error(fmt::format("the scene has more than {} triangles or {} vertices, the most that one can hold",
                                    max_primitives - 1, none - 1));
    }
    for (const Index<SphereDesc> sphere : group.spheres) sphere_placements_.push_back({sphere.value, baked});
    if (sphere_placements_.size() >= max_primitives)
        throw Error(fmt::format("the scene has more than {} spheres, the most that one can hold", max_primitives - 1));
    result.triangle_count = static_cast<uint>(triangles_) - result.first_triangle;
    result.sphere_count = static_cast<uint>(sphere_placements_.size()) - result.first_sphere;
    return result;
}

void Packer::plan_groups()
{
    meshes_.resize(scene_.meshes.size());
    std::vector<std::size_t> uses(scene_.groups.size(), 0);
    for (const InstanceDesc& instance : scene_.instances) ++uses[instance.group.value];

    std::vector<std::uint8_t> stays(scene_.groups.size(), 0);
    for (const InstanceDesc& instance : scene_.instances) {
        const uint g = instance.group.value;
        if (uses[g] > 1 || !can_be_baked(instance)) {
            stays[g] = 1;
            continue;
        }
        add_group(scene_.groups[g], &instance);
    }
    packed_.world.triangle_count = static_cast<uint>(triangles_);
    packed_.world.sphere_count = static_cast<uint>(sphere_placements_.size());

    std::vector<uint> group_number(scene_.groups.size(), none);
    for (std::size_t i = 0; i < scene_.instances.size(); ++i) {
        const InstanceDesc& desc = scene_.instances[i];
        const uint g = desc.group.value;
        if (stays[g] == 0) continue;
        if (group_number[g] == none) {
            const PackedGroup group = add_group(scene_.groups[g], nullptr);
            group_number[g] = static_cast<uint>(packed_.groups.size());
            packed_.groups.push_back(group);
        }
        const PackedGroup& group = packed_.groups[group_number[g]];
        if (group.triangle_count == 0 && group.sphere_count == 0) continue;
        Instance instance = {};
        instance.to_world = desc.transform;
        instance.to_object = inverse(desc.transform).value();
        instance.group = group_number[g];
        instance.object = static_cast<uint>(i);
        packed_.instances.push_back(instance);
    }
}

// ---- the filling ----

// Where a mesh has normals, they say which side is outside. The winding is made to agree, so that lights shine and
// glass refracts on the side that the picture shows.
static bool is_wound_against_normals(const Mesh& mesh, uvec3 t)
{
    if (mesh.normals.empty()) return false;
    const vec3 p = mesh.positions[t.x];
    const vec3 n = mesh.normals[t.x] + mesh.normals[t.y] + mesh.normals[t.z];
    return dot(cross(mesh.positions[t.y] - p, mesh.positions[t.z] - p), n) < 0.0f;
}

void Packer::fill_triangles(const MeshPlacement& placement)
{
    const Mesh& mesh = scene_.meshes[placement.mesh];
    const MeshPlan& plan = meshes_[placement.mesh];
    const bool mirrored = placement.baked != nullptr && determinant(placement.baked->transform) < 0.0f;
    const auto put = [&](std::size_t from, std::size_t to, uint surface) {
        const uvec3 t = mesh.triangles[from] + uvec3(placement.first_vertex);
        const bool flip = mirrored != is_wound_against_normals(mesh, mesh.triangles[from]);
        packed_.triangles[to] = flip ? Triangle{t.x, t.z, t.y, surface} : Triangle{t.x, t.y, t.z, surface};
    };

    std::vector<uint> next; // by run: where its next triangle goes
    uint first = placement.first_triangle;
    for (std::size_t r = 0; r < plan.runs.size(); ++r) {
        Surface& surface = packed_.surfaces[placement.first_surface + r];
        surface.material = plan.runs[r].material;
        surface.object = placement.mesh;
        surface.first_vertex = placement.first_vertex;
        surface.normal_base = placement.normal_base;
        surface.uv_base = plan.uv_base;
        surface.uv_1_base = plan.uv_1_base;
        surface.color_base = plan.color_base;
        surface.tangent_base = placement.tangent_base;
        surface.first_triangle = first;
        surface.first_light = none;
        next.push_back(first);
        first += plan.runs[r].count;
    }
    if (plan.runs.size() == 1) {
        parallel_ranges(mesh.triangles.size(), grain, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) put(i, placement.first_triangle + i, placement.first_surface);
        });
        return;
    }
    std::size_t r = 0;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const uint material = mesh.triangle_materials[i].value;
        if (plan.runs[r].material != material)
            r = static_cast<std::size_t>(
                std::lower_bound(plan.runs.begin(), plan.runs.end(), material,
                                 [](const MaterialRun& run, uint m) { return run.material < m; }) -
                plan.runs.begin());
        put(i, next[r]++, placement.first_surface + static_cast<uint>(r));
    }
}

void Packer::fill_placement(const MeshPlacement& placement)
{
    fill_triangles(placement);
    if (!placement.writes_vertices) return;
    const Mesh& mesh = scene_.meshes[placement.mesh];
    const Transform to_world = placement.baked != nullptr ? placement.baked->transform : identity_transform();
    const Transform to_object = inverse(to_world).value();
    parallel_ranges(mesh.positions.size(), grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const vec3 p = mesh.positions[i];
            packed_.positions[placement.first_vertex + i] =
                placement.baked != nullptr ? transform_point(to_world, p) : p;
        }
    });
    parallel_ranges(mesh.normals.size(), grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            packed_.normals[placement.normal_base + i] = unit(transform_normal(to_object, mesh.normals[i]));
    });
    const float handedness = determinant(to_world) < 0.0f ? -1.0f : 1.0f;
    parallel_ranges(mesh.tangents.size(), grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const vec4 t = mesh.tangents[i];
            packed_.tangents[placement.tangent_base + i] =
                vec4(unit(transform_vector(to_world, vec3(t))), handedness * t.w);
        }
    });
}

void Packer::fill_meshes()
{
    packed_.positions.resize(positions_);
    packed_.normals.resize(normals_);
    packed_.tangents.resize(tangents_);
    packed_.uvs.resize(uvs_);
    packed_.colors.resize(colors_);
    packed_.triangles.resize(triangles_);
    packed_.surfaces.resize(surfaces_);
    parallel_for(mesh_placements_.size(), [&](std::size_t i) {
        fill_placement(mesh_placements_[i]);
        if (writes_uvs_[i] == 0) return;
        const Mesh& mesh = scene_.meshes[mesh_placements_[i].mesh];
        const MeshPlan& plan = meshes_[mesh_placements_[i].mesh];
        if (plan.uv_base != none) std::copy(mesh.uvs.begin(), mesh.uvs.end(), packed_.uvs.begin() + plan.uv_base);
        if (plan.uv_1_base != none)
            std::copy(mesh.uvs_1.begin(), mesh.uvs_1.end(), packed_.uvs.begin() + plan.uv_1_base);
        if (plan.color_base != none)
            std::copy(mesh.colors.begin(), mesh.colors.end(), packed_.colors.begin() + plan.color_base);
    });
}

void Packer::fill_spheres()
{
    packed_.spheres.resize(sphere_placements_.size());
    parallel_ranges(sphere_placements_.size(), grain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const SphereDesc& desc = scene_.spheres[sphere_placements_[i].sphere];
            const InstanceDesc* baked = sphere_placements_[i].baked;
            Sphere& sphere = packed_.spheres[i];
            sphere.center = baked != nullptr ? transform_point(baked->transform, desc.center) : desc.center;
            sphere.radius = baked != nullptr ? uniform_scale(baked->transform) * desc.radius : desc.radius;
            sphere.material = desc.material.value;
            sphere.object = static_cast<uint>(scene_.meshes.size() + sphere_placements_[i].sphere);
            sphere.light = none;
            sphere.pad0 = 0;
        }
    });
}

void Packer::pack_planes()
{
    for (std::size_t i = 0; i < scene_.planes.size(); ++i) {
        const PlaneDesc& desc = scene_.planes[i];
        Plane plane = {};
        plane.normal = unit(desc.normal);
        plane.offset = static_cast<float>(glm::dot(glm::dvec3(plane.normal), glm::dvec3(desc.point)));
        plane.material = desc.material.value;
        plane.object = static_cast<uint>(scene_.meshes.size() + scene_.spheres.size() + i);
        packed_.planes.push_back(plane);
    }
}

// ---- the result ----

PackedScene pack(const Scene& scene)
{
    PackedScene packed;
    Packer(scene, packed).run();
    return packed;
}

} // namespace snell
