// Cameras as text: for the clipboard, for files, and back.
#pragma once

#include "snell/scene/scene.h"

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace snell::view {

// "--eye 1,2,3 --target 0,0,0 --up 0,1,0 --fov 40": every number in as many digits as bring it back exactly.
std::string camera_options(const CameraDesc& camera);

// pbrt's LookAt and Camera.
std::string camera_pbrt(const CameraDesc& camera);

// One view a line, as camera_options() writes them; # begins a comment. Throws Error with the line's place.
std::vector<CameraDesc> read_views(const std::filesystem::path& file);
void write_views(const std::filesystem::path& file, std::span<const CameraDesc> views);

// What camera_options() writes; what is not named keeps the value of `base`. Throws Error (place: for its message).
CameraDesc parse_camera(const std::string& text, CameraDesc base, const std::string& file = {}, int line = 0);

} // namespace snell::view
