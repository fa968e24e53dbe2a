// Shapes into triangles.
#pragma once

#include "snell/scene/scene.h"

#include <functional>
#include <span>

namespace snell::pbrt {

// A point of the curve that turns around the z axis: at distance r and height z, with the outward normal (r, z).
struct ProfilePoint
{
    float r, z;
    float normal_r, normal_z;
};

// A surface of revolution: u is the angle over `phi_max` (degrees), v the place on the profile, which `rings` + 1
// points follow. At most 2 * segments * rings triangles; segments: of a whole turn.
Mesh revolve(std::span<const ProfilePoint> profile, float phi_max, uint segments);

// By how much the radius of a regular polygon exceeds that of the disk of the same area.
float equal_area_radius(uint segments);

// Bilinear patches between four corners each: indices of p00, p10, p01, p11. Flat parallelograms become two triangles,
// others `cells` x `cells` quads. normals and uvs are per corner or empty; patches without uvs have the unit square.
Mesh tessellate_patches(std::span<const vec3> points, std::span<const vec3> normals, std::span<const vec2> uvs,
                        std::span<const uvec4> patches, uint cells);
// Whether two triangles are exactly that patch.
bool is_parallelogram(std::span<const vec3> points, uvec4 patch);

// A regular grid of heights over the unit square: nx * ny values, rows of equal y.
Mesh tessellate_heights(std::span<const float> heights, uint nx, uint ny);

} // namespace snell::pbrt
