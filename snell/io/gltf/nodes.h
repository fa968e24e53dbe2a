// The hierarchy of a glTF file, and what hangs on it.
#pragma once

#include "snell/io/gltf/accessors.h"
#include "snell/io/gltf/primitive.h"

#include <functional>
#include <vector>

namespace snell::gltf {

// Which nodes there are and which of them the default scene shows. Vectors of bool are by node.
struct Hierarchy
{
    std::vector<bool> is_shown;
    std::vector<bool> is_moving; // it or an ancestor is animated
    std::vector<uint> order;     // the nodes' numbers, parents before their children
};

// Fills Scene::nodes, with the same indices as the file's. Throws Error if they do not form trees.
Hierarchy read_nodes(const Document& document, Scene& scene, Remarks& remarks);

// Fills Scene::skins. Throws Error on joints that are no nodes, or too few matrices.
void read_skins(const Document& document, const Accessors& accessors, Scene& scene);

// Puts lights and cameras on the shown nodes.
void read_lights(const Document& document, const Hierarchy& hierarchy, Scene& scene, Remarks& remarks);
void read_cameras(const Document& document, const Hierarchy& hierarchy, Scene& scene, Remarks& remarks);

// Places the meshes that the shown nodes have, as groups and instances, with rigs for those that are skinned or morph.
// Reads their primitives in parallel; material_of(mesh, primitive) gives the material of one; progress gets the part
// that is read.
void read_meshes(const Document& document, const Buffers& buffers, const Accessors& accessors, Budget& budget,
                 const Hierarchy& hierarchy,
                 const std::function<Index<MaterialDesc>(std::size_t, std::size_t)>& material_of,
                 const std::function<void(double)>& progress, Scene& scene, Remarks& remarks);

// Fills Scene::animations; Scene::nodes must be there with all their weights. Channels that make no sense are left out
// and noted.
void read_animations(const Document& document, const Accessors& accessors, Scene& scene, Remarks& remarks);

} // namespace snell::gltf
