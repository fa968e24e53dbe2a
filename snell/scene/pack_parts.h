// The parts of pack() that do not deal with geometry.
#pragma once

#include "snell/scene/packed.h"

namespace snell {

// Fills materials, principled, slots and coverage.
void pack_materials(const Scene& scene, PackedScene& packed);

// Fills textures, texels and srgb. Throws Error if there are more texels than indices.
void pack_images(const Scene& scene, PackedScene& packed);

// Fills environment and environment_cdf. Lights must be there already.
void pack_environment(const Scene& scene, PackedScene& packed);

// Whether the material looks anything up by texture coordinates.
bool is_textured(const Material& material);

} // namespace snell
