// The matrices of pbrt's directives.
#pragma once

#include "snell/scene/scene.h"

#include <glm/mat4x4.hpp>

#include <optional>

namespace snell::pbrt {

using Matrix = glm::dmat4;

Matrix translate(glm::dvec3 offset);
Matrix scale(glm::dvec3 factors);
// Counter-clockwise about the axis, seen from its tip. An axis of length 0: the identity.
Matrix rotate(double degrees, glm::dvec3 axis);
// World to camera, left-handed: x to the right, y up, z into the picture. Empty if the directions span no frame.
std::optional<Matrix> look_at(glm::dvec3 eye, glm::dvec3 target, glm::dvec3 up);

// Empty if singular, not finite, or projective.
std::optional<Matrix> invert(const Matrix& m);

Transform to_transform(const Matrix& m);
vec3 transform_point(const Matrix& m, vec3 p);
vec3 transform_vector(const Matrix& m, vec3 v);

// Moves the mesh; normals by the inverse transpose, and the winding so that outside stays outside. m is invertible.
void transform_mesh(Mesh& mesh, const Matrix& m);
// Turns inside and outside round.
void flip_mesh(Mesh& mesh);

} // namespace snell::pbrt
