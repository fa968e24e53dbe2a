// A scene without what is heavy: for those who show and edit it, beside the one that renders.
#pragma once

#include "snell/scene/scene.h"

namespace snell {

// The same parts with the same indices, but without vertices, triangles, texels, skins and rigs, and without notes. Of
// a mesh of several materials, triangle_materials has each once, ascending. pose() moves its nodes, instances, lights
// and cameras, and edits do in it what they do in the scene.
Scene outline(const Scene& scene);

// What is left out of it that is worth showing.
struct MeshFigures
{
    std::size_t triangles = 0, vertices = 0;
    bool has_normals = false, has_uvs = false, has_tangents = false, has_colors = false;
    bool is_rigged = false;
    Bounds bounds; // in the mesh's own space
};

// By mesh.
std::vector<MeshFigures> mesh_figures(const Scene& scene);

} // namespace snell
