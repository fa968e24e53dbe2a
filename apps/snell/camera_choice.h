// Which of a scene's cameras to render through, and how the command line changes it.
#pragma once

#include "options.h"

#include "snell/scene/scene.h"

#include <optional>
#include <string>
#include <vector>

namespace snell::app {

struct CameraChoice
{
    std::string camera; // name or index; empty: the first one
    std::optional<vec3> eye, target, up;
    std::optional<float> fov_degrees;
    std::optional<uint> model; // camera_*
    std::optional<float> lens_radius, focus_distance, blade_rotation_degrees, eye_distance, view_size;
    std::optional<uint> blades;
    std::vector<float> distortion;
    std::string calibration; // a file of OpenCV's
    std::string lens;        // a lens's name, or a file of its prescription
    std::optional<float> film_diagonal, stop_diameter, millimetre;
    bool is_stereo = false; // the picture is for two eyes, whatever the model
};

// --camera, --eye, --target, --up, --fov, and what its model and lens are.
void add_camera_options(Options& options, CameraChoice& choice);

// Completes the scene (see snell/scene/scene.h) and leaves in it the one camera that was chosen. Throws UsageError if
// there is no such camera or it cannot see: eye and target in one place, up along the view.
void choose_camera(Scene& scene, const CameraChoice& choice, float aspect);

} // namespace snell::app
