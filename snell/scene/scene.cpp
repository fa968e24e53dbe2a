#include "snell/scene/scene.h"

#include "snell/core/error.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace snell {

template <class T>
static Index<T> append(std::vector<T>& all, T item)
{
    all.push_back(std::move(item));
    return Index<T>{static_cast<uint>(all.size() - 1)};
}

Index<Image> add(Scene& scene, Image image)
{
    return append(scene.images, std::move(image));
}

Index<MaterialDesc> add(Scene& scene, MaterialDesc material)
{
    return append(scene.materials, std::move(material));
}

Index<Mesh> add(Scene& scene, Mesh mesh)
{
    return append(scene.meshes, std::move(mesh));
}

Index<SphereDesc> add(Scene& scene, SphereDesc sphere)
{
    return append(scene.spheres, std::move(sphere));
}

Index<Group> add(Scene& scene, Group group)
{
    return append(scene.groups, std::move(group));
}

void add(Scene& scene, PlaneDesc plane)
{
    scene.planes.push_back(std::move(plane));
}

void add(Scene& scene, InstanceDesc instance)
{
    scene.instances.push_back(std::move(instance));
}

void add(Scene& scene, LightDesc light)
{
    scene.lights.push_back(std::move(light));
}

void add(Scene& scene, CameraDesc camera)
{
    scene.cameras.push_back(std::move(camera));
}

void place(Scene& scene, Mesh mesh, const Transform& transform)
{
    const std::string name = mesh.name;
    const Index<Mesh> index = add(scene, std::move(mesh));
    const Index<Group> group = add(scene, Group{name, {index}, {}});
    add(scene, InstanceDesc{name, group, transform});
}

void place(Scene& scene, SphereDesc sphere)
{
    const std::string name = sphere.name;
    const Index<SphereDesc> index = add(scene, std::move(sphere));
    const Index<Group> group = add(scene, Group{name, {}, {index}});
    add(scene, InstanceDesc{name, group, identity_transform()});
}

void note(Scene& scene, Note::Kind kind, std::string text)
{
    scene.notes.push_back(Note{kind, std::move(text)});
}

Transform identity_transform()
{
    return {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
}

Transform translation(vec3 offset)
{
    return {{1, 0, 0, offset.x}, {0, 1, 0, offset.y}, {0, 0, 1, offset.z}};
}

Transform scaling(vec3 factors)
{
    return {{factors.x, 0, 0, 0}, {0, factors.y, 0, 0}, {0, 0, factors.z, 0}};
}

Transform rotation(vec3 axis, float degrees)
{
    const glm::dvec3 given(axis);
    const double size = glm::length(given);
    if (!(size > 0.0) || !std::isfinite(size) || !std::isfinite(degrees))
        throw Error(fmt::format("cannot rotate by {} degrees around ({}, {}, {})", degrees, axis.x, axis.y, axis.z),
                    "give a finite angle and an axis of non-zero length");
    // Rodrigues' formula.
    const glm::dvec3 a = given / size;
    const double angle = static_cast<double>(degrees) * (3.14159265358979323846 / 180.0);
    const double c = std::cos(angle), s = std::sin(angle), k = 1.0 - c;
    return {vec4(glm::dvec4(a.x * a.x * k + c, a.x * a.y * k - a.z * s, a.x * a.z * k + a.y * s, 0.0)),
            vec4(glm::dvec4(a.y * a.x * k + a.z * s, a.y * a.y * k + c, a.y * a.z * k - a.x * s, 0.0)),
            vec4(glm::dvec4(a.z * a.x * k - a.y * s, a.z * a.y * k + a.x * s, a.z * a.z * k + c, 0.0))};
}

static vec4 compose_row(vec4 row, const Transform& b)
{
    const glm::dvec4 r(row);
    return vec4(r.x * glm::dvec4(b.x) + r.y * glm::dvec4(b.y) + r.z * glm::dvec4(b.z) + glm::dvec4(0, 0, 0, r.w));
}

Transform compose(const Transform& a, const Transform& b)
{
    return {compose_row(a.x, b), compose_row(a.y, b), compose_row(a.z, b)};
}

std::optional<Transform> inverse(const Transform& m)
{
    const glm::dvec3 x(m.x.x, m.x.y, m.x.z), y(m.y.x, m.y.y, m.y.z), z(m.z.x, m.z.y, m.z.z);
    const glm::dvec3 offset(m.x.w, m.y.w, m.z.w);
    // Columns of the inverse are the cross products of the rows over the determinant.
    const glm::dvec3 yz = glm::cross(y, z), zx = glm::cross(z, x), xy = glm::cross(x, y);
    const double determinant = glm::dot(x, yz);

    // How far from parallel the rows, or the columns, are. A scale along one axis leaves one of the two at 1 however
    // small it is; what is below the rounding error of floats in both has lost a dimension.
    constexpr double rounding = 1e-7;
    const glm::dvec3 p(x.x, y.x, z.x), q(x.y, y.y, z.y), r(x.z, y.z, z.z);
    const double rows = glm::length(x) * glm::length(y) * glm::length(z);
    const double columns = glm::length(p) * glm::length(q) * glm::length(r);
    if (!(std::abs(determinant) > rounding * std::min(rows, columns))) return std::nullopt;

    const glm::dvec3 a = yz / determinant, b = zx / determinant, c = xy / determinant;
    const glm::dvec3 back = -(a * offset.x + b * offset.y + c * offset.z);
    const Transform result = {vec4(glm::dvec4(a.x, b.x, c.x, back.x)), vec4(glm::dvec4(a.y, b.y, c.y, back.y)),
                              vec4(glm::dvec4(a.z, b.z, c.z, back.z))};
    for (const vec4 row : {m.x, m.y, m.z, result.x, result.y, result.z})
        for (int i = 0; i < 4; ++i)
            if (!std::isfinite(row[i])) return std::nullopt;
    return result;
}

float determinant(const Transform& m)
{
    return dot(vec3(m.x.x, m.x.y, m.x.z), cross(vec3(m.y.x, m.y.y, m.y.z), vec3(m.z.x, m.z.y, m.z.z)));
}

float uniform_scale(const Transform& m)
{
    const glm::dvec3 x(m.x.x, m.x.y, m.x.z), y(m.y.x, m.y.y, m.y.z), z(m.z.x, m.z.y, m.z.z);
    const double xx = glm::dot(x, x), yy = glm::dot(y, y), zz = glm::dot(z, z);
    constexpr double tolerance = 1e-5; // rounding of composed rotations
    const double limit = tolerance * xx;
    for (const double error : {xx - yy, xx - zz, glm::dot(x, y), glm::dot(y, z), glm::dot(z, x)})
        if (!(std::abs(error) <= limit)) return 0.0f;
    return static_cast<float>(std::sqrt((xx + yy + zz) / 3.0));
}

} // namespace snell
