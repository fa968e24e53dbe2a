// Small scenes for the program to open.
#pragma once

#include "program.h"

#include <string>

namespace snell::test {

// A lamp of 1x1 in the plane Z = 0 that moves from X = -1 to X = 1 within two seconds, and then stays; beside it, a
// second animation "back" that goes the other way, and a third one "tracking" in which the camera goes with it. That
// looks from Z = 4. buffer: the URI of its data, which
// moving_lamp_data() is; empty: within the file.
std::string moving_lamp(const std::string& buffer = {});
std::string moving_lamp_data();

// The same without animations.
std::string still_lamp();

// A lamp whose colour depends on the variant: "red" (also without) or "green".
std::string coloured_lamp();

} // namespace snell::test
