// Whether a scene brings light of its own.
#pragma once

#include "snell/scene/scene.h"

namespace snell {

// True if there is an environment, a light, or a surface that shines and is meant as a lamp. Lamps have a radiance
// above 1 somewhere, or emit more than a hundredth of what the sphere around the scene would at radiance 1: the glowing
// details of a model do not light it. Principled surfaces that shine with 1 at most are no lamps. A scene whose materials are all unlit needs no light.
bool is_lit(const Scene& scene);

} // namespace snell
