// Pictures that MTL files use for something else than colour.
#pragma once

#include "snell/scene/scene.h"

namespace snell::obj {

// Does any texel have an alpha below 1?
bool has_alpha(const Image& image);

// `bump` means a height map since 1991, but most of today's writers put normal maps there. Is it grey all over?
bool is_height_map(const Image& image);

// The normals of a height map: where its height, in [0, 1], changes by 1 from one texel to the next, the surface rises
// by 45 degrees. The map is taken to repeat.
Image normal_map(const Image& heights);

} // namespace snell::obj
