#include "camera_choice.h"

#include "usage.h"

#include <fmt/format.h>

#include <cmath>

namespace snell::app {

static std::size_t find_camera(const Scene& scene, const std::string& name)
{
    std::vector<std::string> names;
    for (const CameraDesc& camera : scene.cameras) names.push_back(camera.name);
    if (names.empty()) throw UsageError("--camera: the scene has no cameras; --eye and --target make one");
    return find_name_or_index("--camera", "camera", names, name);
}

void add_camera_options(Options& options, CameraChoice& choice)
{
    options.group("Camera");
    options.value("--camera", "NAME|INDEX", "One of the scene's cameras [the first]",
                  [&](const std::string& text) { choice.camera = text; });
    options.value("--eye", "X,Y,Z", "Where it stands",
                  [&](const std::string& text) { choice.eye = parse_vec3("--eye", text); });
    options.value("--target", "X,Y,Z", "What it looks at",
                  [&](const std::string& text) { choice.target = parse_vec3("--target", text); });
    options.value("--up", "X,Y,Z", "Which way is up",
                  [&](const std::string& text) { choice.up = parse_vec3("--up", text); });
    options.value("--fov", "DEGREES", "Full angle of the picture's shorter side", [&](const std::string& text) {
        choice.fov_degrees = static_cast<float>(parse_number("--fov", text, 0.001, 179.0));
    });
}

void choose_camera(Scene& scene, const CameraChoice& choice, float aspect)
{
    std::size_t chosen = 0;
    if (!choice.camera.empty()) {
        chosen = find_camera(scene, choice.camera);
    } else if (scene.cameras.empty() && choice.eye && choice.target) {
        add(scene, CameraDesc{"command line"}); // nothing to be framed, and nothing to be said about it
    }
    const std::size_t notes = scene.notes.size();
    complete_camera(scene, aspect, choice.up && length(*choice.up) > 0.0f ? *choice.up : vec3(0.0f, 1.0f, 0.0f));
    if (choice.eye || choice.target || choice.fov_degrees) scene.notes.resize(notes); // it names another camera

    CameraDesc camera = scene.cameras.at(chosen);
    if (choice.eye) camera.eye = *choice.eye;
    if (choice.target) camera.target = *choice.target;
    if (choice.up) camera.up = *choice.up;
    if (choice.eye || choice.target || choice.up) camera.node = {}; // it stands where it was put
    if (choice.fov_degrees) camera.fov_degrees = *choice.fov_degrees;

    const vec3 view = camera.target - camera.eye;
    if (!(length(view) > 0.0f)) throw UsageError("--eye and --target are the same point; move one of them");
    if (!(length(cross(normalize(view), camera.up)) > 1e-6f * length(camera.up))) {
        if (choice.up) throw UsageError("--up is zero or points along the view; give another direction");
        camera.up = std::abs(view.y) > std::abs(view.x) ? vec3(0.0f, 0.0f, -1.0f) : vec3(0.0f, 1.0f, 0.0f);
    }
    scene.cameras.assign(1, camera);
    complete_light(scene); // which stands behind the camera's shoulder
}

} // namespace snell::app
