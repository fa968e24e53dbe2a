// What is shown where a file is missing.
#pragma once

#include "snell/scene/scene.h"

namespace snell {

// A magenta and black checkerboard of 8 x 8 squares, which nobody takes for the real thing.
Image checkerboard(const std::string& name);

} // namespace snell
