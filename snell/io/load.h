// Scenes from files.
#pragma once

#include "snell/scene/scene.h"

#include <filesystem>

namespace snell {

// Loads .obj, .ply or .stl by ending (in any case). Throws Error (file, line, what to do) if the file is missing,
// unreadable, truncated or not of that format. What was repaired or missing is noted in Scene::notes. The result has
// passed validate(), but is not yet complete().
Scene load_scene(const std::filesystem::path& file);

// A built-in scene's name, or name:number for a parametric one, or else a file. An unknown name that is no file: an
// Error naming the nearest built-in.
Scene open_scene(const std::string& name_or_file);

} // namespace snell
