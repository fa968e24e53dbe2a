// Light from a picture of the surroundings.
#pragma once

#include "snell/scene/scene.h"

#include <filesystem>

namespace snell {

// Replaces the scene's environment by a picture (.exr .hdr .pfm .png .jpg ...), and notes what it was taken for: one
// twice as wide as high is a latitude-longitude map whose middle lies along -Z, a square one an equal-area octahedral
// map (Clarberg 2008; pbrt's, whose +Z in the middle of the picture is turned to +Y here). degrees: turns it about +Y;
// positive moves what a camera sees to the right. scale multiplies the picture's radiance.
// Needs 16 bytes a texel of a float picture in the scene, as much again when it is packed, and the file's size while it
// is read: a map of 16384 x 8192 takes 2 GiB, twice. 8-bit pictures take a quarter of that.
// Throws Error if the file cannot be read, the picture has another shape, or a number is not finite (scale: negative).
void set_environment(Scene& scene, const std::filesystem::path& file, float degrees = 0.0f, float scale = 1.0f);

} // namespace snell
