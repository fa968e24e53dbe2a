#include "snell/io/pbrt/transform.h"

#include <cmath>

namespace snell::pbrt {

Matrix translate(glm::dvec3 offset)
{
    Matrix m(1.0);
    m[3] = glm::dvec4(offset, 1.0);
    return m;
}

Matrix scale(glm::dvec3 factors)
{
    Matrix m(1.0);
    for (int i = 0; i < 3; ++i) m[i][i] = factors[i];
    return m;
}

Matrix rotate(double degrees, glm::dvec3 axis)
{
    const double length = glm::length(axis);
    if (!(length > 0)) return Matrix(1.0);
    const glm::dvec3 a = axis / length;
    const double angle = degrees * 3.14159265358979323846 / 180.0, s = std::sin(angle), c = std::cos(angle);
    Matrix m(1.0);
    for (int column = 0; column < 3; ++column) {
        glm::dvec3 e(0.0);
        e[column] = 1.0;
        // Rodrigues
        m[column] = glm::dvec4(c * e + s * glm::cross(a, e) + (1 - c) * glm::dot(a, e) * a, 0.0);
    }
    return m;
}

std::optional<Matrix> look_at(glm::dvec3 eye, glm::dvec3 target, glm::dvec3 up)
{
    const glm::dvec3 view = target - eye, side = glm::cross(up, view);
    const double lengths = glm::length(view) * glm::length(up);
    if (!(glm::length(side) > 1e-9 * lengths) || !(lengths > 0)) return {};
    const glm::dvec3 z = glm::normalize(view), x = glm::normalize(side), y = glm::cross(z, x);
    Matrix camera(1.0);
    camera[0] = glm::dvec4(x, 0.0), camera[1] = glm::dvec4(y, 0.0), camera[2] = glm::dvec4(z, 0.0);
    camera[3] = glm::dvec4(eye, 1.0);
    return invert(camera);
}

std::optional<Matrix> invert(const Matrix& m)
{
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row)
            if (!(std::abs(m[column][row]) < 1e18)) return {};
    if (m[0][3] != 0 || m[1][3] != 0 || m[2][3] != 0 || m[3][3] == 0) return {};
    const glm::dvec3 x(m[0]), y(m[1]), z(m[2]);
    const double volume = glm::dot(x, glm::cross(y, z));
    if (!(std::abs(volume) > 1e-12 * glm::length(x) * glm::length(y) * glm::length(z))) return {};
    return glm::inverse(m);
}

Transform to_transform(const Matrix& m)
{
    const auto row = [&m](int r) { return vec4(glm::dvec4(m[0][r], m[1][r], m[2][r], m[3][r]) / m[3][3]); };
    return {row(0), row(1), row(2)};
}

vec3 transform_point(const Matrix& m, vec3 p)
{
    const glm::dvec4 q = m * glm::dvec4(glm::dvec3(p), 1.0);
    return vec3(glm::dvec3(q) / q.w);
}

vec3 transform_vector(const Matrix& m, vec3 v)
{
    return vec3(glm::dvec3(m * glm::dvec4(glm::dvec3(v), 0.0)));
}

void transform_mesh(Mesh& mesh, const Matrix& m)
{
    if (m == Matrix(1.0)) return; // or normals change by rounding
    const glm::dmat3 linear(m);
    const glm::dmat3 for_normals = glm::transpose(glm::inverse(linear));
    for (vec3& p : mesh.positions) p = transform_point(m, p);
    for (vec3& n : mesh.normals) {
        const glm::dvec3 turned = for_normals * glm::dvec3(n);
        const double length = glm::length(turned);
        n = length > 0 ? vec3(turned / length) : n;
    }
    for (vec4& t : mesh.tangents) {
        const glm::dvec3 turned = linear * glm::dvec3(t.x, t.y, t.z);
        const double length = glm::length(turned);
        if (length > 0) t = vec4(vec3(turned / length), t.w);
    }
    if (glm::determinant(linear) < 0) {
        for (uvec3& t : mesh.triangles) std::swap(t.y, t.z);
        for (vec4& t : mesh.tangents) t.w = -t.w;
    }
}

void flip_mesh(Mesh& mesh)
{
    for (uvec3& t : mesh.triangles) std::swap(t.y, t.z);
    for (vec3& n : mesh.normals) n = -n;
    for (vec4& t : mesh.tangents) t.w = -t.w;
}

} // namespace snell::pbrt
