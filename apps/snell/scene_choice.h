// Which scene to open, and what the command line makes of it: materials, light from afar, a moment.
#pragma once

#include "options.h"

#include "snell/io/load.h"
#include "snell/scene/scene.h"

#include <filesystem>
#include <optional>
#include <string>

namespace snell::app {

// What SCENE may be, for the help.
inline constexpr const char* scene_help =
    "A file (.gltf .glb .pbrt .obj .ply .stl; the last three also .gz) or a built-in scene";

struct SceneChoice
{
    std::string name; // of a file or built-in scene
    std::string variant;
    bool sandbox = false;
    std::filesystem::path environment;
    std::optional<float> environment_rotation, environment_scale; // degrees; factor
    bool hide_environment = false;
    std::string animation;      // name or index; empty: the first one
    std::optional<double> time; // seconds
};

// --variant and --sandbox.
void add_loading_options(Options& options, SceneChoice& choice);

// --environment, --environment-rotation, --environment-scale, --hide-environment, --time and --animation.
void add_scene_options(Options& options, SceneChoice& choice);

// Opens the scene as the loading options say. Without `progress` a line on the terminal shows how far it is.
Scene load_chosen(const SceneChoice& choice, const LoadProgressCallback& progress = {});

// load_chosen(), in its environment and at its moment. Throws UsageError if the scene has no such animation, or no
// environment to turn.
Scene open_chosen(const SceneChoice& choice, const LoadProgressCallback& progress = {});

// For after choose_camera(), which may have added light from everywhere.
void hide_environment(Scene& scene, const SceneChoice& choice);

// "all" joins them to one more. Throws UsageError if there is none. option: who asks, for the message.
Index<Animation> find_animation(Scene& scene, const SceneChoice& choice, const char* option);

} // namespace snell::app
