// The Stanford polygon format.
#pragma once

#include "snell/scene/scene.h"

#include <filesystem>

namespace snell {

// ASCII and binary of both byte orders. Read are, in any order and of any type: the vertices' x y z, nx ny nz,
// texture coordinates (u v, s t or texture_u texture_v) and colours (red green blue; integers are sRGB bytes or words,
// floats are linear), the faces' vertex_indices or vertex_index (polygons of any size), and triangle strips.
// Everything else is skipped and named in a note. One mesh. Throws Error with a line (header, ASCII) or a byte offset
// (binary).
Scene load_ply(const std::filesystem::path& file);

} // namespace snell
