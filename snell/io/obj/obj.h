// Wavefront OBJ with its material libraries.
#pragma once

#include "snell/io/load.h"

#include <filesystem>

namespace snell {

// One mesh for each object (`o`), or for each group (`g`) in files without objects, all placed together; materials as
// material.h says. Polygons of any size, negative indices, continued lines, UTF-16, gzip. Without `vn`, faces in a
// smoothing group get normals averaged by angle over that group, others stay flat. Vertex colours (`v x y z r g b`) are
// taken as linear Rec.709; if one exceeds 1, all are taken as 0 to 255. What is not drawn (lines, points, free-form
// surfaces) is noted. Throws Error with the line, and the column where one is to blame.
Scene load_obj(const std::filesystem::path& file, const LoadOptions& options = {});

} // namespace snell
