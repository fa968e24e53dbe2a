// The Stanford polygon format.
#pragma once

#include "snell/io/load.h"

#include <filesystem>

namespace snell {

// ASCII and binary of both byte orders, also packed with gzip. Read are, in any order and of any type: the vertices'
// x y z, nx ny nz, texture coordinates (u v, s t or texture_u texture_v; a second set: u1 v1), tangents (tx ty tz, and
// tw: the bitangent's sign) and colours (red green blue alpha; integers are sRGB bytes or words, floats are linear),
// the faces' vertex_indices or vertex_index (polygons of any size) and texcoord (coordinates by corner, which split
// vertices), and triangle strips. The textures that 'comment TextureFile' lines name are used, by the faces' texnumber
// if there are several. Everything else is skipped and named in a note. One mesh. Throws Error with a line (header,
// ASCII) or a byte offset (binary).
Scene load_ply(const std::filesystem::path& file, const LoadOptions& options = {});

} // namespace snell
