#include "snell/view/panels/transform_editor.h"

#include "snell/view/widgets.h"

#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace snell::view {

Transform compose_parts(vec3 translation, vec3 degrees, vec3 scale)
{
    const Transform turned = compose(rotation(vec3(0, 0, 1), degrees.z),
                                     compose(rotation(vec3(0, 1, 0), degrees.y), rotation(vec3(1, 0, 0), degrees.x)));
    return compose(snell::translation(translation), compose(turned, scaling(scale)));
}

vec4 quaternion_of(vec3 degrees)
{
    const glm::dvec3 half = glm::dvec3(degrees) * (3.14159265358979323846 / 360.0);
    const glm::dvec3 c = glm::cos(half), s = glm::sin(half);
    return vec4(glm::dvec4(s.x * c.y * c.z - c.x * s.y * s.z, c.x * s.y * c.z + s.x * c.y * s.z,
                           c.x * c.y * s.z - s.x * s.y * c.z, c.x * c.y * c.z + s.x * s.y * s.z));
}

static float to_degrees(double radians)
{
    return static_cast<float>(radians * (180.0 / 3.14159265358979323846));
}

std::optional<TransformParts> take_apart(const Transform& m)
{
    TransformParts parts;
    parts.translation = {m.x.w, m.y.w, m.z.w};
    glm::dvec3 columns[3];
    for (int i = 0; i < 3; ++i) {
        columns[i] = glm::dvec3(m.x[i], m.y[i], m.z[i]);
        const double size = glm::length(columns[i]);
        if (!(size > 0.0)) return {};
        parts.scale[i] = static_cast<float>(size);
        columns[i] /= size;
    }
    constexpr double tolerance = 1e-4;
    if (std::abs(glm::dot(columns[0], columns[1])) > tolerance ||
        std::abs(glm::dot(columns[1], columns[2])) > tolerance ||
        std::abs(glm::dot(columns[2], columns[0])) > tolerance)
        return {};
    if (determinant(m) < 0.0f) {
        parts.scale.x = -parts.scale.x;
        columns[0] = -columns[0];
    }
    // The rotation Rz Ry Rx has -sin(y) in its lower left corner.
    const double sine = std::clamp(-columns[0].z, -1.0, 1.0);
    parts.degrees.y = to_degrees(std::asin(sine));
    if (std::abs(sine) < 0.9999999) {
        parts.degrees.x = to_degrees(std::atan2(columns[1].z, columns[2].z));
        parts.degrees.z = to_degrees(std::atan2(columns[0].y, columns[0].x));
    } else { // x and z turn around the same axis
        parts.degrees.x = to_degrees(std::atan2(-columns[2].y, columns[1].y));
    }
    parts.degrees += vec3(0.0f); // a -0 looks odd
    return parts;
}

void TransformEditor::take_apart(const Transform& transform)
{
    const std::optional<TransformParts> parts = view::take_apart(transform);
    shears_ = !parts.has_value();
    made_ = transform;
    if (shears_) return;
    translation_ = parts->translation;
    degrees_ = parts->degrees;
    scale_ = parts->scale;
}

void TransformEditor::edit(Fields& fields, Transform& transform, float step, std::uint64_t id)
{
    if (id != id_ || std::memcmp(&made_, &transform, sizeof(Transform)) != 0) take_apart(transform);
    id_ = id;
    Fields own;
    if (shears_) {
        paragraph("It shears: no product of translation, rotation and scale.");
        const char* const labels[] = {"Row x", "Row y", "Row z"};
        vec4* const rows[] = {&transform.x, &transform.y, &transform.z};
        for (int i = 0; i < 3; ++i) {
            const bool changed = ImGui::DragFloat4(labels[i], &rows[i]->x, 0.1f * step, 0.0f, 0.0f, "%.4g");
            name_item(labels[i]);
            tip("A row of the affine map from object to world space.");
            if (changed) fields.touch(labels[i]);
        }
        made_ = transform;
        return;
    }
    own.vector("Translation", translation_, step, "Where its origin lies.");
    own.vector("Rotation", degrees_, 0.5f, "Degrees around x, then y, then z (Euler angles).");
    own.vector("Scale", scale_, 0.01f, "Size along its own axes; negative mirrors.");
    if (!own.changed()) return;
    fields.touch("transform");
    transform = made_ = compose_parts(translation_, degrees_, scale_);
}

} // namespace snell::view
