#include "camera_choice.h"

#include "names.h"
#include "usage.h"

#include "snell/io/calibration.h"
#include "snell/io/lens_file.h"
#include "snell/scene/camera_models.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

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
        choice.fov_degrees = static_cast<float>(parse_number("--fov", text, 0.001, 360.0));
    });
    const auto length = [&](const char* option, const char* unit, const char* help, double least,
                            std::optional<float>& value) {
        options.value(option, unit, help, [&value, option, least](const std::string& text) {
            value = static_cast<float>(parse_number(option, text, least, 1e9));
        });
    };
    options.value("--camera-model", "NAME", "How it maps directions to the picture; `snell list` names the models",
                  [&](const std::string& text) {
                      std::vector<std::string> names;
                      for (const CameraModelInfo& info : camera_models()) names.emplace_back(info.name);
                      names.emplace_back("rectilinear");
                      check_name("camera model", text, names);
                      choice.model = find_camera_model(text)->kind;
                  });
    length("--view-size", "X", "Orthographic: what the picture's shorter side shows, in the scene's units", 1e-9,
           choice.view_size);
    length("--lens-radius", "X", "Of a thin lens, in the scene's units; 0: everything is sharp", 0.0,
           choice.lens_radius);
    length("--focus-distance", "X", "Where a thin or traced lens is sharp, in the scene's units [at the target]", 1e-9,
           choice.focus_distance);
    options.value("--blades", "N", "Corners of the lens's aperture; 0: it is round", [&](const std::string& text) {
        choice.blades = static_cast<uint>(parse_integer("--blades", text, 0, 100));
    });
    options.value("--blade-rotation", "DEGREES", "Turn the aperture counter-clockwise", [&](const std::string& text) {
        choice.blade_rotation_degrees = static_cast<float>(parse_number("--blade-rotation", text, -3600.0, 3600.0));
    });
    options.value("--distortion", "K1,K2,...",
                  "Coefficients: kannala-brandt 4; brown-conrady k1,k2,p1,p2[,k3[,k4,k5,k6]]; "
                  "hmd 3, or 9 for red, green, blue",
                  [&](const std::string& text) {
                      const auto count = static_cast<std::size_t>(std::count(text.begin(), text.end(), ',')) + 1;
                      choice.distortion.clear();
                      for (const double k : parse_numbers("--distortion", text, count, "numbers, as in -0.2,0.05,0,0"))
                          choice.distortion.push_back(static_cast<float>(k));
                  });
    options.value("--calibration", "FILE", "Model and coefficients from a calibration file of OpenCV (.yml .xml .json)",
                  [&](const std::string& text) { choice.calibration = text; });
    length("--ipd", "X", "Distance between the eyes of an hmd or a stereo pair, in the scene's units [0.064]", 0.0,
           choice.eye_distance);
    options.value("--lens", "NAME|FILE", "Look through the glass of a lens: double-gauss, fisheye, or a prescription",
                  [&](const std::string& text) { choice.lens = text; });
    length("--film", "MM", "The film's diagonal behind it [43.27, that of 35 mm film]", 1e-3, choice.film_diagonal);
    length("--stop", "MM", "Its aperture stop's diameter [fully open]", 1e-3, choice.stop_diameter);
    length("--lens-unit", "X", "A millimetre of it in the scene's units [0.001]", 1e-12, choice.millimetre);
}

static LensPrescription chosen_lens(const std::string& name)
{
    if (const LensPrescription* known = find_lens(name)) return *known;
    std::error_code code;
    if (!std::filesystem::exists(name, code)) {
        std::vector<std::string> names;
        for (const LensPrescription& lens : known_lenses()) names.push_back(lens.name);
        throw UsageError(
            fmt::format("--lens: there is no lens '{}', and no file; there are {}", name, fmt::join(names, ", ")));
    }
    return load_lens(name);
}

// What the command line says of model and lens. Throws UsageError.
static void choose_model(CameraDesc& camera, const CameraChoice& choice)
{
    CameraModel& m = camera.model;
    if (!choice.calibration.empty()) {
        if (choice.model && *choice.model != camera_kannala_brandt && *choice.model != camera_brown_conrady)
            throw UsageError("--calibration: it is for the camera models kannala-brandt and brown-conrady");
        m = load_calibration(choice.calibration, choice.model);
        if (choice.fov_degrees) throw UsageError("--fov: the calibration says what the camera sees; leave one out");
    }
    if (!choice.lens.empty() && choice.model.value_or(camera_lens) != camera_lens)
        throw UsageError("--lens: it is for the camera model lens; leave out one of the two");
    const std::optional<uint> kind = choice.lens.empty() ? choice.model : camera_lens;
    if (kind && *kind != m.kind) {
        m = usual_model(*kind);
        if (m.kind != camera_orthographic) camera.fov_degrees = camera_models()[m.kind].usual_fov;
    }
    const auto only_for = [&](bool is_given, uint model, const char* option) {
        if (is_given && m.kind != model)
            throw UsageError(fmt::format("{}: it is for the camera model {}, and this is {}", option,
                                         camera_models()[model].name, camera_models()[m.kind].name));
    };
    only_for(choice.view_size.has_value(), camera_orthographic, "--view-size");
    only_for(choice.film_diagonal.has_value(), camera_lens, "--film");
    only_for(choice.stop_diameter.has_value(), camera_lens, "--stop");
    only_for(choice.millimetre.has_value(), camera_lens, "--lens-unit");
    only_for(choice.eye_distance && !choice.is_stereo, camera_hmd, "--ipd");
    if (choice.is_stereo && m.kind == camera_hmd)
        throw UsageError("--stereo: the camera model hmd has both eyes in its picture; leave it out");
    if (choice.fov_degrees && m.kind == camera_lens)
        throw UsageError("--fov: lens and film say what the camera sees; leave it out");
    if (!choice.lens.empty()) m.lens = chosen_lens(choice.lens);
    if (choice.film_diagonal) m.film_diagonal = *choice.film_diagonal;
    if (choice.stop_diameter) m.stop_diameter = *choice.stop_diameter;
    if (choice.millimetre) m.millimetre = *choice.millimetre;
    if (choice.fov_degrees) m.half_side = 0.0f;
    if (choice.view_size) m.half_side = 0.5f * *choice.view_size;
    if (choice.lens_radius) m.lens_radius = *choice.lens_radius;
    if (choice.focus_distance) m.focus_distance = *choice.focus_distance;
    if (choice.blades) m.blades = *choice.blades;
    if (choice.blade_rotation_degrees) m.blade_rotation_degrees = *choice.blade_rotation_degrees;
    if (choice.eye_distance) m.eye_distance = *choice.eye_distance;
    if (!choice.distortion.empty() && !set_distortion(m, choice.distortion))
        throw UsageError(fmt::format("--distortion: {} numbers are not what the camera model {} takes; see --help",
                                     choice.distortion.size(), camera_models()[m.kind].name));
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
    choose_model(camera, choice);
    if (choice.fov_degrees) camera.fov_degrees = *choice.fov_degrees;
    if (const std::string fault = camera_fault(camera); !fault.empty()) {
        const bool is_fov = choice.fov_degrees && fault.starts_with("a field of view");
        throw UsageError((is_fov ? "--fov: the camera has " : "the camera has ") + fault);
    }

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
