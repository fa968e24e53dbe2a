// The parts of validate() that look at images, materials and the environment.
#pragma once

#include "snell/scene/scene.h"

namespace snell {

// Images, then materials and their references to images.
void validate_materials(Scene& scene);

// The environment and its image.
void validate_environment(Scene& scene);

} // namespace snell
