// snell info --bvh: what each builder makes of a scene.
#pragma once

#include "scene_choice.h"

namespace snell::app {

// A table of all builders, or one JSON object; its keys are documented in docs/info.md.
void print_bvh_info(const SceneChoice& choice, bool json);

} // namespace snell::app
