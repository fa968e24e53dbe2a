// snell camera: a camera or a lens, measured.
#include "camera_choice.h"
#include "commands.h"
#include "options.h"
#include "scene_choice.h"
#include "usage.h"

#include "snell/lab/camera_lab.h"
#include "snell/scene/camera_models.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace snell::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr int trip_side = 100; // even, so that no point lies between the eyes of an HMD

struct Request
{
    SceneChoice scene;
    CameraChoice camera;
    std::pair<int, int> size{960, 640};
    int points = 13;
    bool json = false;
};

Json number_or_null(std::optional<float> value)
{
    return value ? Json(*value) : Json(nullptr);
}

std::string angle_in_words(std::optional<float> angle)
{
    return angle ? fmt::format("{:10.4f}", *angle) : fmt::format("{:>10}", "-");
}

Json lens_json(const CameraModel& model, const FocusedLens& focused, const std::vector<VignettingPoint>& curve)
{
    const Cardinal c = cardinal(model.lens);
    Json json;
    json["name"] = model.lens.name;
    json["surfaces"] = model.lens.surfaces.size();
    json["focal_length_mm"] = c.focal_length, json["back_focus_mm"] = c.back_focus;
    json["f_number"] = c.f_number(), json["length_mm"] = c.length;
    json["entrance_pupil_mm"] = c.entrance_pupil;
    json["film_distance_mm"] = focused.system.rear_z, json["film_diagonal_mm"] = model.film_diagonal;
    json["vignetting"] = Json::array();
    for (const VignettingPoint& p : curve)
        json["vignetting"].push_back({{"radius_mm", p.radius},
                                      {"angle_degrees", number_or_null(p.angle)},
                                      {"light", p.light},
                                      {"cos4", p.cos4}});
    return json;
}

void print_lens(const CameraModel& model, const FocusedLens& focused, const std::vector<VignettingPoint>& curve)
{
    const Cardinal c = cardinal(model.lens);
    fmt::print("\nlens           {}, {} surfaces, {:.2f} mm long\n", model.lens.name, model.lens.surfaces.size(),
               c.length);
    fmt::print("focal length   {:.3f} mm, f/{:.2f} fully open\n", c.focal_length, c.f_number());
    fmt::print("back focus     {:.3f} mm; entrance pupil {:.3f} mm behind the front\n", c.back_focus, c.entrance_pupil);
    fmt::print("film           {:.3f} mm behind the lens, {:.2f} mm across\n", focused.system.rear_z,
               model.film_diagonal);
    fmt::print("\nradius [mm]  angle [degrees]   light    cos^4\n");
    for (const VignettingPoint& p : curve)
        fmt::print("{:11.3f}  {:>15}  {:6.4f}  {:6.4f}\n", p.radius, angle_in_words(p.angle), p.light, p.cos4);
}

void measure(const Request& request)
{
    SceneChoice choice = request.scene;
    if (choice.name.empty()) choice.name = "grid";
    Scene scene = open_chosen(choice);
    const auto [width, height] = request.size;
    choose_camera(scene, request.camera, static_cast<float>(width) / static_cast<float>(height));
    const CameraDesc& desc = scene.cameras.front();
    const std::string_view model = camera_models()[desc.model.kind].name;
    const ReadyCamera camera = make_camera(desc, width, height);
    const Bounds bounds = scene_bounds(scene);
    const float size = bounds.empty() ? 1.0f : std::max(0.5f * length(bounds.extent()), 1e-6f);

    const FieldOfView fov = field_of_view(camera);
    const RoundTrip trip = round_trip(camera, trip_side, size);
    const std::vector<CurvePoint> curve = distortion_curve(camera, request.points);
    std::vector<VignettingPoint> dark;
    if (camera.glass) dark = vignetting(camera.lens, request.points);
    if (request.json) {
        Json json;
        json["camera"] = desc.name;
        json["model"] = model;
        json["width"] = width, json["height"] = height;
        json["fov_degrees"] = {{"horizontal", fov.horizontal}, {"vertical", fov.vertical}, {"diagonal", fov.diagonal}};
        json["round_trip"] = {{"worst_pixels", trip.worst},
                              {"mean_pixels", trip.mean},
                              {"points", trip.points},
                              {"lost", trip.lost},
                              {"unseeing", trip.unseeing}};
        json["distortion"] = Json::array();
        for (const CurvePoint& p : curve)
            json["distortion"].push_back({{"radius_pixels", p.radius}, {"angle_degrees", number_or_null(p.angle)}});
        if (camera.glass) json["lens"] = lens_json(desc.model, *camera.glass, dark);
        fmt::print("{}\n", json.dump(-1, ' ', false, Json::error_handler_t::replace));
        return;
    }
    fmt::print("model          {}\n", model);
    fmt::print("picture        {} x {}\n", width, height);
    fmt::print("field of view  {:.3f} degrees across, {:.3f} down, {:.3f} from corner to corner\n", fov.horizontal,
               fov.vertical, fov.diagonal);
    fmt::print("round trip     {:.2g} pixels at worst, {:.2g} in the mean of {}", trip.worst, trip.mean, trip.points);
    if (trip.lost > 0) fmt::print("; {} not found", trip.lost);
    if (trip.unseeing > 0)
        fmt::print("; {:.1f}% of the picture sees nothing",
                   100.0 * static_cast<double>(trip.unseeing) / (trip_side * trip_side));
    fmt::print("\n\nradius [pixels]  angle [degrees]\n");
    for (const CurvePoint& p : curve) fmt::print("{:15.3f}  {:>15}\n", p.radius, angle_in_words(p.angle));
    if (camera.glass) print_lens(desc.model, *camera.glass, dark);
}

} // namespace

int run_camera(const Arguments& arguments)
{
    Request r;
    Options options(
        "camera",
        "Measures a camera: field of view, distortion curve, and how exactly the way from the "
        "picture to the scene and back leads home; of a lens, focal length and vignetting too.",
        "Examples:\n  snell camera\n  snell camera cornell --fov 90 --size 640x480 --json\n"
        "  snell camera --lens double-gauss --focus-distance 2\n  snell camera --lens lenses/fisheye.txt\n");
    options.positional(
        "SCENE", "Whose camera to measure: a file or a built-in scene [grid]",
        [&](const std::string& text) { r.scene.name = text; }, false);
    options.value("--size", "WxH", "Of the picture in pixels [960x640]",
                  [&](const std::string& text) { r.size = parse_size("--size", text); });
    options.value("--points", "N", "Lines of the table [13]", [&](const std::string& text) {
        r.points = static_cast<int>(parse_integer("--points", text, 2, 100000));
    });
    options.flag("--json", "Print one JSON object", [&] { r.json = true; });
    add_camera_options(options, r.camera);
    if (const auto code = options.parse(arguments)) return *code;

    measure(r);
    return 0;
}

} // namespace snell::app
