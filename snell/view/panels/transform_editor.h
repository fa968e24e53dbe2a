// Transforms as people think of them: translation, rotation, scale.
#pragma once

#include "snell/view/fields.h"

#include <optional>

namespace snell::view {

// Shows an affine map as translation, rotation around x, then y, then z, and scale; as its twelve numbers if it shears.
class TransformEditor
{
  public:
    // step: of the translation, for each pixel that it is dragged. id: of what has the transform.
    void edit(Fields& fields, Transform& transform, float step, std::uint64_t id);

  private:
    void take_apart(const Transform& transform);

    std::uint64_t id_ = 0;
    // The parts that made `made_`; others would make it too, so they are kept as they were typed.
    Transform made_ = {};
    vec3 translation_{0.0f}, degrees_{0.0f}, scale_{1.0f};
    bool shears_ = false;
};

// The map that applies scale, then rotations around x, y and z, then translation.
Transform compose_parts(vec3 translation, vec3 degrees, vec3 scale);

// The unit quaternion x y z w of such rotations.
vec4 quaternion_of(vec3 degrees);

// Such parts of a map; nothing: it shears. Of a map that mirrors, the first scale is negative.
struct TransformParts
{
    vec3 translation{0.0f}, degrees{0.0f}, scale{1.0f};
};
std::optional<TransformParts> take_apart(const Transform& transform);

} // namespace snell::view
