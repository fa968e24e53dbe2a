// Simple meshes made in code. All have counter-clockwise triangles seen from outside, and no vertex normals unless
// said.
#pragma once

#include "snell/scene/scene.h"

#include <string>

namespace snell {

// Two triangles a b c, a c d; the front is on the side of cross(b - a, c - a). Texture coordinates (0,0) (1,0) (1,1)
// (0,1).
Mesh make_quad(std::string name, vec3 a, vec3 b, vec3 c, vec3 d, Index<MaterialDesc> material);

// An axis-aligned box with outward faces: 8 vertices, 12 triangles.
Mesh make_box(std::string name, vec3 lower, vec3 upper, Index<MaterialDesc> material);

// Squares in the plane y = 0 around the origin, columns along x and rows along z, facing up. Square (i, j), counted
// from the corner of least x and z, is `even` when i + j is even.
Mesh make_checkerboard(std::string name, uint columns, uint rows, float square, Index<MaterialDesc> even,
                       Index<MaterialDesc> odd);

// A torus around the y axis with smooth normals and texture coordinates; ring: radius of the circle that the tube of
// radius `tube` goes round.
Mesh make_torus(std::string name, float ring, float tube, uint ring_steps, uint tube_steps,
                Index<MaterialDesc> material);

// 2 x 2 squares, even top left and bottom right, for planes; so many texels a square that its edges look sharp.
Image make_checker_image(std::string name, vec3 even_srgb, vec3 odd_srgb);

} // namespace snell
