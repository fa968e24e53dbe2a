#include "scene_choice.h"

#include "console.h"
#include "usage.h"

#include "snell/io/environment.h"
#include "snell/io/load.h"
#include "snell/scene/animation.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace snell::app {

void add_loading_options(Options& options, SceneChoice& choice)
{
    options.group("Loading");
    options.value("--variant", "NAME", "Which of the file's sets of materials; `snell info` names them",
                  [&](const std::string& text) { choice.variant = text; });
    options.flag("--sandbox", "Refuse references to files outside the scene's folder", [&] { choice.sandbox = true; });
}

void add_scene_options(Options& options, SceneChoice& choice)
{
    constexpr double any = std::numeric_limits<float>::max();
    options.group("Light from afar");
    options.value("--environment", "FILE", "A picture (.exr .hdr) of what is around, in place of the scene's",
                  [&](const std::string& text) { choice.environment = text; });
    options.value("--environment-rotation", "DEGREES", "Turn it about +Y; what the camera sees goes to the right",
                  [&](const std::string& text) {
                      choice.environment_rotation =
                          static_cast<float>(parse_number("--environment-rotation", text, -any, any));
                  });
    options.value("--environment-scale", "X", "Make it that many times as bright", [&](const std::string& text) {
        choice.environment_scale = static_cast<float>(parse_number("--environment-scale", text, 0.0, 1e9));
    });
    options.flag("--hide-environment", "It lights the scene, but the camera sees black, and alpha 0",
                 [&] { choice.hide_environment = true; });

    options.group("Animation");
    options.value("--time", "SECONDS", "The scene at that moment",
                  [&](const std::string& text) { choice.time = parse_number("--time", text, 0.0, 1e9); });
    options.value("--animation", "NAME|INDEX|all", "Which of the scene's animations [the first]",
                  [&](const std::string& text) { choice.animation = text; });
}

Scene load_chosen(const SceneChoice& choice, const LoadProgressCallback& progress)
{
    std::optional<LoadLine> line;
    LoadOptions options;
    options.variant = choice.variant;
    options.sandbox = choice.sandbox;
    options.progress = progress;
    if (!progress) {
        line.emplace();
        options.progress = [&line](const LoadProgress& now) { line->update(now); };
    }
    Scene scene = open_scene(choice.name, options);
    if (!choice.variant.empty()) check_name("variant", choice.variant, scene.variants); // built-in scenes have none
    return scene;
}

// All of the scene's animations at once, as one more.
static Index<Animation> join_animations(Scene& scene)
{
    Animation all;
    all.name = "all";
    for (const Animation& animation : scene.animations) {
        all.channels.insert(all.channels.end(), animation.channels.begin(), animation.channels.end());
        all.duration = std::max(all.duration, animation.duration);
    }
    scene.animations.push_back(std::move(all));
    return {static_cast<uint>(scene.animations.size() - 1)};
}

Index<Animation> find_animation(Scene& scene, const SceneChoice& choice, const char* option)
{
    if (scene.animations.empty())
        throw UsageError(fmt::format("{}: nothing moves in '{}', it has no animation", option, choice.name));
    if (choice.animation.empty()) return {0};
    std::vector<std::string> names;
    for (const Animation& animation : scene.animations) names.push_back(animation.name);
    if (choice.animation == "all" && std::find(names.begin(), names.end(), "all") == names.end())
        return join_animations(scene);
    return {static_cast<uint>(find_name_or_index("--animation", "animation", names, choice.animation))};
}

static void light_from_afar(Scene& scene, const SceneChoice& choice)
{
    const float degrees = choice.environment_rotation.value_or(0.0f), scale = choice.environment_scale.value_or(1.0f);
    if (!choice.environment.empty()) {
        set_environment(scene, choice.environment, degrees, scale);
        return;
    }
    if (!choice.environment_rotation && !choice.environment_scale) return;
    EnvironmentDesc& environment = scene.environment;
    if (!environment.image.valid() && is_black(environment.radiance))
        throw UsageError(fmt::format("{}: the scene has no environment; give one with --environment FILE",
                                     choice.environment_rotation ? "--environment-rotation" : "--environment-scale"));
    // As set_environment() turns: what a camera sees goes to the right.
    environment.to_world = compose(rotation(vec3(0.0f, 1.0f, 0.0f), -degrees), environment.to_world);
    environment.radiance *= scale;
}

Scene open_chosen(const SceneChoice& choice, const LoadProgressCallback& progress)
{
    Scene scene = load_chosen(choice, progress);
    light_from_afar(scene, choice);
    if (choice.time || !choice.animation.empty()) {
        const Index<Animation> animation = find_animation(scene, choice, choice.time ? "--time" : "--animation");
        const double seconds = choice.time.value_or(0.0);
        pose(scene, animation, static_cast<float>(seconds));
        if (const float duration = scene.animations[animation.value].duration; seconds > static_cast<double>(duration))
            console().detail(
                fmt::format("the animation ends at {:g} s, before --time {:g}: its last pose", duration, seconds));
    }
    return scene;
}

void hide_environment(Scene& scene, const SceneChoice& choice)
{
    if (choice.hide_environment) scene.environment.visible = false;
}

} // namespace snell::app
