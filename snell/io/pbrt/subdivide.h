// Loop subdivision.
#pragma once

#include "snell/scene/scene.h"

#include <span>

namespace snell::pbrt {

// Refines a triangle mesh `levels` times and moves its vertices to the surface's limit, with the limit's normals (Loop
// 1987, Smooth Subdivision Surfaces Based on Triangles; boundaries are cubic B-splines after Hoppe et al. 1994; limit
// masks after Zorin and Schroeder 2000). n triangles become n * 4^levels. Edges with more than two triangles are taken
// as boundaries.
Mesh subdivide(std::span<const vec3> points, std::span<const uvec3> triangles, uint levels);

} // namespace snell::pbrt
