// Where in the arrays of a PackedScene the parts of a Scene go.
#pragma once

#include "snell/scene/packed.h"

namespace snell {

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
    uint baked; // instance whose transform is applied; none: stays in object space
    uint group; // index into PackedScene::groups; none: the world
    uint first_vertex, normal_base, tangent_base, first_triangle, first_surface;
    bool writes_vertices; // false: shared with an earlier placement
    bool writes_uvs;      // the first placement of each mesh
};

struct SpherePlacement
{
    uint sphere;
    uint baked; // as MeshPlacement's
};

// A group that stays in object space.
struct GroupPlacement
{
    uint group; // in the Scene
    PackedGroup packed;
};

struct InstancePlacement
{
    uint instance; // in the Scene
    uint group;    // index into PackedScene::groups
};

struct PackPlan
{
    std::vector<MeshPlan> meshes;
    std::vector<MeshPlacement> mesh_placements;
    std::vector<SpherePlacement> sphere_placements;
    PackedGroup world;
    std::vector<GroupPlacement> groups;
    std::vector<InstancePlacement> instances;
    std::vector<uint> baked; // instances that are applied beforehand, ascending
    std::size_t positions = 0, normals = 0, tangents = 0, uvs = 0, colors = 0, triangles = 0, surfaces = 0;
};

// Which groups stay in object space whatever their number of instances: those with a mesh that an animation deforms,
// and those placed on a node that one moves. By group.
std::vector<std::uint8_t> moving_groups(const Scene& scene);

// Which instances are moved into world space beforehand, ascending: those whose group is placed once, unless `stays`
// says otherwise, or it has spheres that would become ellipsoids, or textured ones that would turn. Such groups are
// then marked in `stays`. textured: by material, 1: it looks something up by texture coordinates.
std::vector<uint> baked_instances(const Scene& scene, const std::vector<std::uint8_t>& textured,
                                  std::vector<std::uint8_t>& stays);

// For baked_instances(): by material.
std::vector<std::uint8_t> textured_materials(const std::vector<Material>& materials);

// materials: those of the scene, packed. stays: by group, 1: it is not moved into world space even if it could be.
// Throws Error if there are more primitives than can be numbered.
PackPlan plan_pack(const Scene& scene, const std::vector<Material>& materials, const std::vector<std::uint8_t>& stays);

} // namespace snell
