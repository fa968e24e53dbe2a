// PackedScene: the flat arrays that kernels and accelerators read.
#pragma once

#include "snell/kernel/scene_view.h"
#include "snell/scene/scene.h"

#include <memory>
#include <span>

namespace snell {

// A run of primitives that one bottom-level structure covers.
struct PackedGroup
{
    uint first_triangle = 0, triangle_count = 0;
    uint first_sphere = 0, sphere_count = 0;
};

// What Scene becomes for rendering. Groups that are placed once are moved into world space; their primitives form
// `world` (except that spheres which would become ellipsoids, or textured ones that would turn, stay). The others stay
// in object space, in `groups`, and are reached through `instances` (one level, no nesting). Within each run the
// triangles of one surface are consecutive. A transform that mirrors exchanges two vertices, of triangles in world
// space and of the lights of mirrored instances, so that the side of the normal stays the same.
// Objects are numbered through all kinds: meshes, then spheres, then planes, each in the order of the Scene.
struct PackedScene
{
    std::vector<vec3> positions;
    std::vector<vec3> normals;
    std::vector<vec2> uvs;
    std::vector<vec4> tangents;
    std::vector<vec4> colors;
    std::vector<Triangle> triangles;
    std::vector<Surface> surfaces;
    std::vector<Sphere> spheres;
    std::vector<Plane> planes;
    std::vector<Instance> instances;
    std::vector<Material> materials;
    std::vector<Light> lights; // with the alias table for choosing one by power
    std::vector<Texture> textures;
    std::vector<std::uint32_t> texels;
    std::vector<float> srgb;
    std::vector<TextureSlot> slots;
    std::vector<Principled> principled;
    std::vector<float> albedo;
    std::vector<float> environment_cdf;
    Environment environment = {};
    uint coverage = 0; // scene_has_*
    vec3 center{0.0f};
    float radius = 1.0f;

    PackedGroup world;
    std::vector<PackedGroup> groups; // by Instance::group

    // The arrays as the kernels take them. Valid as long as this object is neither moved nor changed.
    SceneView view() const;
    std::size_t bytes() const;
};

// What of a PackedScene has changed. The numbers of primitives and instances may not.
struct PackedChanges
{
    bool world = false;       // vertices or spheres of PackedScene::world
    std::vector<uint> groups; // those whose vertices or spheres have changed, ascending
    bool instances = false;   // transforms
    bool any() const { return world || instances || !groups.empty(); }
};

// The scene must have passed validate(). For scenes that will be posed again and again: repose.h.
PackedScene pack(const Scene& scene);

} // namespace snell
