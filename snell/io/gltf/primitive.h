// The triangles of one glTF primitive.
#pragma once

#include "snell/io/gltf/accessors.h"

namespace snell::gltf {

// A mesh at rest, and what it needs to be posed. A primitive of points or lines, or without positions, has no
// triangles.
struct Primitive
{
    Mesh mesh; // without name and material
    std::vector<MorphTarget> targets;
    std::vector<uvec4> joints; // as in Rig, if it was read for a skin
    std::vector<vec4> weights;
    Remarks remarks;
};

// Reads primitive `number` of mesh `mesh`, with its joints if it is used with a skin. Texture coordinates are turned
// over: ours point up. Throws Error if its accessors do not fit together.
Primitive read_primitive(const Document& document, const Buffers& buffers, const Accessors& accessors, Budget& budget,
                         std::size_t mesh, std::size_t number, bool is_skinned);

} // namespace snell::gltf
