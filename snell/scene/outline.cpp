#include "snell/scene/outline.h"

#include "snell/scene/bounds.h"

#include <algorithm>

namespace snell {

// Each material that a triangle has, ascending.
static std::vector<Index<MaterialDesc>> distinct(const std::vector<Index<MaterialDesc>>& all)
{
    std::vector<Index<MaterialDesc>> result;
    // Neighbours are alike: what is sorted is then short.
    for (const Index<MaterialDesc> material : all)
        if (result.empty() || result.back() != material) result.push_back(material);
    const auto less = [](Index<MaterialDesc> a, Index<MaterialDesc> b) { return a.value < b.value; };
    std::sort(result.begin(), result.end(), less);
    result.erase(std::unique(result.begin(), result.end()), result.end());
    return result;
}

Scene outline(const Scene& scene)
{
    Scene o;
    o.name = scene.name;
    for (const Image& image : scene.images)
        o.images.push_back({image.name, image.width, image.height, image.format, {}, {}});
    o.materials = scene.materials;
    for (const Mesh& mesh : scene.meshes) {
        Mesh& light = o.meshes.emplace_back();
        light.name = mesh.name;
        light.material = mesh.material;
        light.triangle_materials = distinct(mesh.triangle_materials);
    }
    o.spheres = scene.spheres;
    o.planes = scene.planes;
    o.groups = scene.groups;
    o.instances = scene.instances;
    o.lights = scene.lights;
    o.cameras = scene.cameras;
    o.environment = scene.environment;
    o.nodes = scene.nodes;
    o.animations = scene.animations;
    o.variants = scene.variants;
    o.hints = scene.hints;
    return o;
}

std::vector<MeshFigures> mesh_figures(const Scene& scene)
{
    std::vector<MeshFigures> figures;
    figures.reserve(scene.meshes.size());
    for (uint i = 0; i < scene.meshes.size(); ++i) {
        const Mesh& mesh = scene.meshes[i];
        MeshFigures f;
        f.triangles = mesh.triangles.size();
        f.vertices = mesh.positions.size();
        f.has_normals = !mesh.normals.empty();
        f.has_uvs = !mesh.uvs.empty();
        f.has_tangents = !mesh.tangents.empty();
        f.has_colors = !mesh.colors.empty();
        f.bounds = group_bounds(scene, Group{{}, {Index<Mesh>{i}}, {}}, identity_transform());
        figures.push_back(f);
    }
    for (const Rig& rig : scene.rigs) figures[rig.mesh.value].is_rigged = true;
    return figures;
}

} // namespace snell
