// The scenes of our reference pictures, transcribed number for number. All are grey, for square pictures, and have
// passed validate(). (The fourth, veach-mis, is a built-in scene.)
#pragma once

#include "snell/scene/scene.h"

namespace snell::test {

Scene make_cornell_diffuse_reference(); // the box with two diffuse blocks
Scene make_cornell_reference();         // the box with a block of rough metal and a ball of glass
Scene make_glass_checker_reference();   // an absorbing ball of glass over a checkerboard, a point light, a grey sky

} // namespace snell::test
