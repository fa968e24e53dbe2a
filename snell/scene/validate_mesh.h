// The part of validate() that looks at every triangle, and what all its parts share.
#pragma once

#include "snell/scene/scene.h"

#include <string>
#include <vector>

namespace snell {

// How messages name an object: 'name', or its number if it has none.
std::string label(const std::string& name, std::size_t number);

// Whether a position can be computed with: finite, and small enough that squares of differences stay finite.
bool is_seen(vec3 p);

// The same for all numbers of a map.
bool is_usable(const Transform& m);

void warn(Scene& scene, std::string text);

// Checks and mends one mesh. who: "mesh 'floor'". Returns what was mended, in words; throws Error on an index out of
// range or an attribute of the wrong length. A none in triangle_materials falls back to the mesh's material. A mesh
// that changes its shape keeps triangles without area: they may have some in another pose.
std::vector<std::string> validate_mesh(Mesh& mesh, const std::string& who, std::size_t material_count,
                                       bool changes_shape);

} // namespace snell
