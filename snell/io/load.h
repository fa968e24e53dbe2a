// Scenes from files.
#pragma once

#include "snell/scene/scene.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

namespace snell {

// How far loading has come. Called from any thread, one at a time, a few times a second at most.
struct LoadProgress
{
    std::string what;      // "reading mesh.ply", "decoding textures"
    double fraction = 0.0; // of the whole, in [0, 1]; never falls
};
using LoadProgressCallback = std::function<void(const LoadProgress&)>;

struct LoadOptions
{
    // Refuse references to files outside the scene's folder. Else they are followed, and noted.
    bool sandbox = false;
    std::string variant; // name of one of Scene::variants; empty: the file's own choice. Unknown: an Error
    LoadProgressCallback progress;
};

// Loads .gltf, .glb, .pbrt, .obj, .ply or .stl by ending (in any case; the last three also with .gz behind). Throws
// Error (file, line, what to do) if the file is missing, unreadable, truncated or not of that format. What was repaired
// or missing is noted in Scene::notes. The result has passed validate(), but is not yet complete().
Scene load_scene(const std::filesystem::path& file, const LoadOptions& options = {});

// A built-in scene's name, or name:number for a parametric one, or else a file. An unknown name that is no file: an
// Error naming the nearest built-in.
Scene open_scene(const std::string& name_or_file, const LoadOptions& options = {});

} // namespace snell
