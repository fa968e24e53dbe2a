// The parts of pack() that do not deal with geometry.
#pragma once

#include "snell/scene/packed.h"

namespace snell {

// What is seen of an environment's picture in each of the cells that it is sampled by, row by row.
struct EnvironmentCells
{
    uint image = none, mapping = 0;
    uint columns = 0, rows = 0;
    std::vector<vec3> means;
};

// Fills materials, principled, slots, albedo and coverage, which are empty.
void pack_materials(const Scene& scene, PackedScene& packed);

// Fills textures, texels and srgb, whatever is in them. Throws Error if there are more texels than indices.
void pack_images(const Scene& scene, PackedScene& packed);

// Fills environment and environment_cdf. Lights must be there already. kept: of an earlier call with the same images,
// or empty; spares looking at the picture again.
void pack_environment(const Scene& scene, PackedScene& packed, EnvironmentCells& kept);

// The part of it that depends on whether there are lights.
void choose_environment(PackedScene& packed);

// Fills planes, whatever is in it.
void pack_planes(const Scene& scene, PackedScene& packed);

// Whether the material looks anything up by texture coordinates.
bool is_textured(const Material& material);

} // namespace snell
