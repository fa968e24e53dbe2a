// Writing PLY files.
#pragma once

#include "snell/scene/scene.h"

#include <filesystem>

namespace snell {

// Writes a mesh as binary little-endian PLY, atomically. Vertices have, of what the mesh has, x y z, nx ny nz, u v,
// u1 v1 (second texture coordinates), tx ty tz tw (tangents) and red green blue alpha, all of them floats; faces have
// vertex_indices. load_ply() reads back exactly these numbers; other programs pass over the properties they do not
// know. Materials are not written. Throws Error.
void write_ply(const std::filesystem::path& file, const Mesh& mesh);

} // namespace snell
