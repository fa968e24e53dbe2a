// Camera, film, sampler and integrator: what stands before WorldBegin.
#include "snell/io/lens_file.h"
#include "snell/io/pbrt/loader.h"
#include "snell/io/text_cursor.h"
#include "snell/scene/camera_models.h"

#include <algorithm>
#include <cmath>

namespace snell::pbrt {
namespace {

constexpr float degree = 0.01745329252f;

// What a window of the screen other than the usual one does to the field of view.
float window_fov(Loader& loader, const Parameter& window, float fov, float aspect)
{
    const std::vector<float>& w = window.numbers;
    if (w.size() != 4 || !(w[1] > w[0]) || !(w[3] > w[2]) || !std::isfinite(w[0] + w[1] + w[2] + w[3])) {
        loader.warn(window.spot, "screenwindow",
                    "\"float screenwindow\" has no left, right, bottom and top; it is ignored");
        return fov;
    }
    const float width = w[1] - w[0], height = w[3] - w[2];
    if (std::abs(w[0] + w[1]) > 1e-3f * width || std::abs(w[2] + w[3]) > 1e-3f * height)
        loader.warn(window.spot, "screenwindow centre",
                    "a screenwindow that is not centred (a shifted lens) is centred: the picture moves");
    if (std::abs(width / height / aspect - 1.0f) > 1e-3f)
        loader.warn(window.spot, "screenwindow shape",
                    "a screenwindow of another shape than the picture would stretch it: its shorter side counts");
    return std::atan(std::tan(0.5f * fov * degree) * 0.5f * std::min(width, height)) * 2.0f / degree;
}

// A camera that is nothing but a LookAt, perhaps mirrored before, has its numbers as they stand in the file, and keeps
// the distance of what it looks at.
void take_look(const Loader& loader, CameraDesc& camera)
{
    if (!loader.look) return;
    const auto [eye, target, up] = *loader.look;
    const Matrix m = look_at(eye, target, up).value_or(Matrix(1.0));
    if (loader.ctm() != m && loader.ctm() != scale({-1, 1, 1}) * m) return;
    camera.eye = vec3(eye), camera.target = vec3(target), camera.up = vec3(up);
}

// Our own cameras: "fisheye" and "hmd" of docs/pbrt.md.
void take_model(Loader& loader, const std::string& type, const ParameterList& parameters, CameraDesc& camera)
{
    CameraModel& m = camera.model;
    m.kind = camera_hmd;
    if (type == "fisheye") {
        const std::string name = parameters.text("projection", "equidistant");
        const CameraModelInfo* info = find_camera_model(name);
        m.kind = info != nullptr ? info->kind : camera_equidistant;
        const bool is_there = info != nullptr && (m.kind == camera_pinhole ||
                                                  (m.kind >= camera_equidistant && m.kind <= camera_brown_conrady));
        if (!is_there) {
            m.kind = camera_equidistant;
            loader.warn(parameters.spot, "projection " + name,
                        fmt::format("the projection {} is not there; equidistant stands in", show_word(name)));
        }
    }
    m.eye_distance = parameters.number("ipd", m.eye_distance);
    if (const Parameter* k = parameters.find("distortion"))
        if (!set_distortion(m, k->numbers))
            loader.warn(k->spot, "distortion", "these are not the numbers that this lens has; they are ignored");
    if (const Parameter* c = parameters.find("calibration")) { // width height fx fy cx cy
        if (c->numbers.size() == 6) {
            m.calibrated_width = c->numbers[0], m.calibrated_height = c->numbers[1];
            m.focal = vec2(c->numbers[2], c->numbers[3]), m.center = vec2(c->numbers[4], c->numbers[5]);
        } else {
            loader.warn(c->spot, "calibration", "this has not six numbers, width height fx fy cx cy; it is ignored");
        }
    }
}

// pbrt's "realistic" camera: rays through glass. A lens that cannot be had leaves a pinhole, with a note.
void take_lens(Loader& loader, const ParameterList& parameters, CameraDesc& camera)
{
    CameraModel& m = camera.model;
    const std::string name = parameters.text("lensfile");
    m.focus_distance = parameters.number("focusdistance", 10.0f); // these are pbrt's defaults
    m.stop_diameter = parameters.number("aperturediameter", 1.0f);
    m.millimetre = parameters.number("millimetre", 0.001f);
    parameters.ignore({"shutteropen", "shutterclose", "aperture", "simpleweighting", "scale"});
    try {
        const LensPrescription* known = find_lens(name);
        if (name.empty()) throw Error("the camera has no \"string lensfile\"");
        m.lens = known != nullptr ? *known : load_lens(loader.resolve(name, parameters.spot));
        m.kind = camera_lens;
    } catch (const Error& error) {
        loader.warn(parameters.spot, "lensfile", fmt::format("{}: a perspective camera stands in", error.what()));
        m = CameraModel{};
    }
}

} // namespace

void set_camera(Loader& loader, const std::string& type, const ParameterList& parameters)
{
    const Spot spot = parameters.spot;
    loader.coordinate_systems["camera"] = loader.state.ctm;
    const std::optional<Matrix> to_world = invert(loader.ctm());
    if (!to_world)
        throw Error(spot.place(), "the transform of the camera has no inverse", "check the directives before");
    std::array<Matrix, 2>& from_camera = loader.coordinate_systems["camera"];
    from_camera[0] = *to_world;
    from_camera[1] = invert(loader.state.ctm[1]).value_or(*to_world);
    if (loader.state.ctm[0] != loader.state.ctm[1])
        loader.warn(spot, "moving camera", "the camera moves; it stands where it is when the shutter opens");

    const vec3 eye = transform_point(*to_world, vec3(0.0f));
    const vec3 view = transform_vector(*to_world, vec3(0, 0, 1)), up = transform_vector(*to_world, vec3(0, 1, 0));
    const vec3 right = transform_vector(*to_world, vec3(1, 0, 0));
    CameraDesc camera;
    camera.name = parameters.text("name", loader.camera_name);
    loader.camera_name.clear();
    camera.eye = eye;
    camera.target = eye + normalize(view);
    camera.up = normalize(up);
    camera.mirrored = dot(cross(view, up), right) < 0.0f;
    take_look(loader, camera);

    loader.screen_window.reset();
    float& frame = loader.frame_aspect;
    frame = 0.0f;
    float fov = parameters.number("fov", 90.0f);
    if (const std::optional<float> half = parameters.number("halffov"); half && !parameters.has("fov")) fov = 2 * *half;
    float largest_fov = 180.0f;
    if (type == "perspective") {
        if (const Parameter* window = parameters.find("screenwindow")) loader.screen_window = *window;
        frame = parameters.number("frameaspectratio", 0.0f);
        camera.model.lens_radius = parameters.number("lensradius", 0.0f);
        const float focus = parameters.number("focaldistance", 1e6f); // pbrt's default
        if (camera.model.lens_radius > 0.0f) camera.model.focus_distance = focus;
        camera.model.blades = static_cast<uint>(std::max(parameters.integer("blades", 0), 0));
        camera.model.blade_rotation_degrees = parameters.number("bladerotation", 0.0f);
        parameters.ignore({"shutteropen", "shutterclose", "frameaspectratio"});
    } else if (type == "orthographic") {
        float half = 1.0f;
        if (const Parameter* window = parameters.find("screenwindow"); window && window->numbers.size() == 4)
            half = 0.5f * std::min(std::abs(window->numbers[1] - window->numbers[0]),
                                   std::abs(window->numbers[3] - window->numbers[2]));
        camera.model.kind = camera_orthographic;
        const float scaled = length(up);
        camera.model.half_side = std::abs(scaled - 1.0f) < 1e-5f ? half : half * scaled; // rotations leave it as it is
        fov = CameraDesc{}.fov_degrees;
        parameters.ignore(
            {"lensradius", "focaldistance", "shutteropen", "shutterclose", "frameaspectratio", "screenwindow"});
    } else if (type == "spherical" || type == "environment") {
        camera.model.kind = camera_equirectangular;
        fov = camera_models()[camera_equirectangular].usual_fov, largest_fov = 361.0f;
        const char* const usual = type == "spherical" ? "equalarea" : "equirectangular"; // of pbrt-v4, and of v3
        if (const std::string mapping = parameters.text("mapping", usual); mapping != "equirectangular")
            loader.warn(spot, "mapping " + mapping,
                        fmt::format("the mapping {} is not there; equirectangular stands in", show_word(mapping)));
        parameters.ignore({"lensradius", "focaldistance", "shutteropen", "shutterclose", "frameaspectratio"});
    } else if (type == "fisheye" || type == "hmd") {
        take_model(loader, type, parameters, camera);
        const CameraModelInfo& info = camera_models()[camera.model.kind];
        fov = parameters.number("fov", info.usual_fov),
        largest_fov = info.largest_fov == 360.0f ? 361.0f : info.largest_fov;
    } else if (type == "realistic") {
        take_lens(loader, parameters, camera);
        camera.model.film_diagonal = loader.film_diagonal;
        fov = camera_models()[camera_lens].usual_fov;
    } else {
        loader.warn(spot, "camera " + type,
                    fmt::format("the camera {} is not there; a perspective one stands in for it", show_word(type)));
        for (const Parameter& parameter : parameters.all()) parameter.used = true;
    }
    if (!(fov > 0.0f) || !(fov < largest_fov)) {
        loader.warn(spot, "fov", fmt::format("a field of view of {} degrees is none; it becomes 90", fov));
        fov = 90.0f;
    }
    camera.fov_degrees = fov;
    if (const std::string fault = camera_fault(camera); !fault.empty()) {
        loader.warn(spot, "camera model", fmt::format("{}: a pinhole stands in", fault));
        camera.model = CameraModel{};
        camera.fov_degrees = std::min(fov, 90.0f);
    }
    parameters.report_unused(fmt::format("Camera \"{}\"", type.substr(0, 40)), loader.notes);

    // The last one counts, as in pbrt; those with a name are all kept.
    std::vector<CameraDesc>& cameras = loader.scene.cameras;
    if (camera.name.empty()) std::erase_if(cameras, [](const CameraDesc& other) { return other.name.empty(); });
    cameras.push_back(camera);
}

void finish_options(Loader& loader)
{
    RenderHints& hints = loader.scene.hints;
    if (loader.in_world && !hints.integrator) hints.integrator = "path", hints.max_depth = 5; // pbrt's default
    if (loader.scene.cameras.empty()) return;
    for (CameraDesc& camera : loader.scene.cameras)
        if (camera.model.kind == camera_lens) camera.model.film_diagonal = loader.film_diagonal;
    CameraDesc& camera = loader.scene.cameras.back();
    const float width = static_cast<float>(hints.width.value_or(1280));
    const float aspect = width / static_cast<float>(hints.height.value_or(720));
    if (loader.screen_window)
        camera.fov_degrees = window_fov(loader, *loader.screen_window, camera.fov_degrees, aspect);
    if (loader.frame_aspect > 0.0f && std::abs(loader.frame_aspect / aspect - 1.0f) > 1e-3f)
        loader.warn({}, "frame", "the camera's frameaspectratio is not that of the picture; it is ignored");
}

void set_film(Loader& loader, const std::string& type, const ParameterList& parameters)
{
    RenderHints& hints = loader.scene.hints;
    constexpr int largest = 1 << 16;
    const auto size = [&](std::string_view name, int otherwise) {
        const int value = parameters.integer(name, otherwise);
        if (value > 0 && value <= largest) return value;
        loader.warn(parameters.spot, "film size",
                    fmt::format("a picture of {} pixels a side is none; {} is taken", value, otherwise));
        return otherwise;
    };
    hints.width = size("xresolution", loader.is_v3 ? 640 : 1280);
    hints.height = size("yresolution", loader.is_v3 ? 480 : 720);
    if (const std::string name = parameters.text("filename"); !name.empty()) hints.output = name;
    if (const float diagonal = parameters.number("diagonal", 35.0f); std::isfinite(diagonal) && diagonal > 0.0f)
        loader.film_diagonal = diagonal;
    else
        loader.warn(parameters.spot, "diagonal", fmt::format("a film of {} mm is none; 35 is taken", diagonal));
    if (const std::span<const float> crop = parameters.numbers("cropwindow"); crop.size() == 4) {
        std::array<float, 4> c{};
        for (std::size_t i = 0; i < 4; ++i) c[i] = clamp(std::isnan(crop[i]) ? 0.0f : crop[i], 0.0f, 1.0f);
        if (c[0] < c[1] && c[2] < c[3]) hints.crop_window = c;
    }
    if (const std::span<const int> bounds = parameters.integers("pixelbounds"); bounds.size() == 4) {
        std::array<float, 4> c{};
        for (std::size_t i = 0; i < 4; ++i)
            c[i] = clamp(static_cast<float>(bounds[i]) / static_cast<float>(i < 2 ? *hints.width : *hints.height), 0.0f,
                         1.0f);
        if (c[0] < c[1] && c[2] < c[3]) hints.crop_window = c;
    }
    const float iso = parameters.number("iso", 100.0f), seconds = parameters.number("exposuretime", 1.0f);
    const float scale = parameters.number("scale", 1.0f); // v3
    const float exposure = iso / 100.0f * seconds * scale;
    if (std::isfinite(exposure) && exposure > 0.0f) loader.exposure = exposure;
    if (loader.exposure != 1.0f)
        loader.inform(parameters.spot, "exposure",
                      fmt::format("the film's exposure of {} is applied to the lights", loader.exposure));
    if (const std::string sensor = parameters.text("sensor", "cie1931"); sensor != "cie1931")
        loader.warn(parameters.spot, "sensor",
                    fmt::format("the colours of the sensor {} are not imitated", show_word(sensor)));
    if (parameters.number("whitebalance", 0.0f) > 0.0f)
        loader.warn(parameters.spot, "whitebalance", "white balance is left to post-processing");
    parameters.ignore({"savefp16", "maxcomponentvalue", "maxsampleluminance", "display", "fstop", "coordinatesystem",
                       "nbuckets", "lambdamin", "lambdamax", "buckets", "filterimportance"});
    parameters.report_unused(fmt::format("Film \"{}\"", type.substr(0, 40)), loader.notes);
}

void set_sampler(Loader& loader, const std::string& type, const ParameterList& parameters)
{
    RenderHints& hints = loader.scene.hints;
    int spp = parameters.integer("pixelsamples", 16);
    if (type == "stratified") {
        const long long x = parameters.integer("xsamples", 4), y = parameters.integer("ysamples", 4);
        spp = static_cast<int>(std::clamp<long long>(x > 0 && y > 0 ? x * y : 16, 1, 1 << 24));
    }
    if (spp > 0) hints.spp = static_cast<uint>(spp);
    if (const std::optional<int> seed = parameters.integer("seed")) hints.seed = static_cast<uint>(*seed);
    hints.sampler = type == "random" || type == "independent" ? "independent" : "sobol";
    parameters.ignore({"randomization", "dimensions", "jitter", "scramble", "samplepixelcenter"});
    parameters.report_unused(fmt::format("Sampler \"{}\"", type.substr(0, 40)), loader.notes);
}

void set_option(Loader& loader, const ParameterList& parameters)
{
    if (const std::optional<int> seed = parameters.integer("seed")) loader.scene.hints.seed = static_cast<uint>(*seed);
    for (const Parameter& option : parameters.all())
        if (!option.used)
            loader.inform(
                option.spot, "option " + option.name,
                fmt::format("the option {} is ignored: options are given on the command line", show_word(option.name)));
}

void set_filter(Loader& loader, const std::string& type, const ParameterList& parameters)
{
    const float x = parameters.number("xradius", parameters.number("xwidth", 0.5f));
    const float y = parameters.number("yradius", parameters.number("ywidth", 0.5f));
    if (type != "box" || x != 0.5f || y != 0.5f)
        loader.inform(parameters.spot, "filter", "pixels are means over their own square: PixelFilter is ignored");
}

void set_accelerator(Loader& loader, const std::string&, const ParameterList& parameters)
{
    loader.inform(parameters.spot, "accelerator", "Accelerator is ignored: the command line chooses one");
}

void set_integrator(Loader& loader, const std::string& type, const ParameterList& parameters)
{
    RenderHints& hints = loader.scene.hints;
    hints.integrator = "path";
    if (type == "whitted")
        hints.integrator = "whitted";
    else if (type == "ambientocclusion" || type == "ao")
        hints.integrator = "ao";
    else if (type != "path" && type != "volpath" && type != "simplepath" && type != "simplevolpath")
        loader.inform(parameters.spot, "integrator",
                      fmt::format("the integrator {} is not there; path is taken", show_word(type)));
    // pbrt ends paths after 5 bounces unless told otherwise.
    int depth = parameters.integer("maxdepth", 5);
    if (depth <= 0) {
        loader.warn(parameters.spot, "maxdepth", "a maxdepth of 0 shows lights alone; 1 is taken");
        depth = 1;
    }
    if (*hints.integrator != "ao") hints.max_depth = static_cast<uint>(depth);
    for (const Parameter& parameter : parameters.all())
        parameter.used = true; // all others are of that integrator alone
}

} // namespace snell::pbrt
