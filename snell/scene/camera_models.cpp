#include "snell/scene/camera_models.h"

#include "snell/core/error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <mutex>
#include <numbers>

namespace snell {

static constexpr std::array<CameraModelInfo, camera_model_count> models = {{
    {camera_pinhole, "pinhole", "R = f tan(theta); with a lens radius: a thin lens", 40.0f, 180.0f},
    {camera_orthographic, "orthographic", "parallel rays", 40.0f, 180.0f},
    {camera_equirectangular, "equirectangular", "the whole sphere, longitude across and latitude down", 180.0f, 360.0f},
    {camera_equidistant, "equidistant", "fisheye, R = f theta", 180.0f, 360.0f},
    {camera_equisolid, "equisolid", "fisheye, R = 2 f sin(theta / 2): equal areas for equal solid angles", 180.0f,
     360.0f},
    {camera_stereographic, "stereographic", "fisheye, R = 2 f tan(theta / 2): circles stay circles", 180.0f, 359.0f},
    {camera_fisheye_orthographic, "fisheye-orthographic", "fisheye, R = f sin(theta)", 180.0f, 180.1f},
    {camera_kannala_brandt, "kannala-brandt", "fisheye with OpenCV's four coefficients", 120.0f, 360.0f},
    {camera_brown_conrady, "brown-conrady", "OpenCV's radial and tangential distortion of a rectilinear lens", 60.0f,
     180.0f},
    {camera_hmd, "hmd", "two eyes side by side, distorted against the lenses of a head-mounted display", 90.0f, 180.0f},
    {camera_lens, "lens", "rays traced through the glass of a photographic lens", 40.0f, 180.0f},
}};

std::span<const CameraModelInfo> camera_models()
{
    return models;
}

const CameraModelInfo* find_camera_model(std::string_view name)
{
    if (name == "rectilinear") name = "pinhole";
    const auto found = std::find_if(models.begin(), models.end(), [&](const auto& m) { return m.name == name; });
    return found == models.end() ? nullptr : &*found;
}

CameraModel usual_model(uint kind)
{
    CameraModel m;
    m.kind = kind;
    if (kind == camera_lens) m.lens = *find_lens("double-gauss");
    return m;
}

CameraDesc stereo_eye(const CameraDesc& camera, uint eye)
{
    const Camera both = make_pinhole(camera.eye, camera.target, camera.up, 1.0f, 1.0f, 1.0f);
    const bool to_the_right = (eye == 1u) != camera.mirrored;
    const vec3 shift = (to_the_right ? 0.5f : -0.5f) * camera.model.eye_distance * normalize(both.right);
    CameraDesc one = camera;
    one.eye += shift, one.target += shift;
    one.node = {};
    return one;
}

// Radius of the model's picture plane at half the field of view; negative: there is none.
static float edge_radius(const CameraModel& m, float half_fov)
{
    const vec4 k(m.k[0], m.k[1], m.k[2], m.k[3]);
    switch (m.kind) {
    case camera_equidistant:
        return half_fov;
    case camera_equisolid:
        return 2.0f * std::sin(0.5f * half_fov);
    case camera_stereographic:
        return stereographic_radius(half_fov);
    case camera_fisheye_orthographic:
        return std::sin(std::min(half_fov, 0.5f * pi));
    case camera_kannala_brandt:
        return kannala_brandt_radius(k, half_fov);
    case camera_brown_conrady: {
        Camera camera{};
        std::copy(m.k.begin(), m.k.end(), camera.k);
        const vec2 edge(std::tan(half_fov), 0.0f);
        return brown_conrady_folds(brown_of(camera), edge) ? -1.0f : brown_conrady_point(brown_of(camera), edge).x;
    }
    case camera_hmd:
        return hmd_radius(vec3(m.k[3], m.k[4], m.k[5]), half_fov);
    default:
        return 1.0f;
    }
}

// Focusing takes tens of milliseconds, and cameras are made anew for every picture and every click: the last few are
// kept. distance: in the scene's units. Throws Error as focus_lens() does.
static std::shared_ptr<const FocusedLens> focused(const CameraModel& m, float distance)
{
    struct Entry
    {
        LensPrescription lens;
        std::array<float, 4> numbers;
        std::shared_ptr<const FocusedLens> glass;
    };
    static std::mutex mutex;
    static std::deque<Entry> kept; // the last used one first
    constexpr std::size_t most = 8;

    const std::array<float, 4> numbers = {distance, m.film_diagonal, m.stop_diameter, m.millimetre};
    const auto same = [&](const Entry& e) { return e.numbers == numbers && e.lens == m.lens; };
    {
        const std::lock_guard lock(mutex);
        if (const auto found = std::find_if(kept.begin(), kept.end(), same); found != kept.end()) {
            std::rotate(kept.begin(), found, found + 1);
            return kept.front().glass;
        }
    }
    // Not while the lock is held: it works in parallel, and who waits for that may be given a task that comes here.
    auto glass = std::make_shared<const FocusedLens>(
        focus_lens(m.lens, static_cast<double>(distance / m.millimetre), static_cast<double>(m.film_diagonal),
                   static_cast<double>(m.stop_diameter), static_cast<double>(m.millimetre)));
    const std::lock_guard lock(mutex);
    kept.push_front({m.lens, numbers, glass});
    if (kept.size() > most) kept.pop_back();
    return glass;
}

// Where thin and traced lenses are sharp.
static float focus_of(const CameraDesc& camera)
{
    return camera.model.focus_distance > 0.0f ? camera.model.focus_distance : length(camera.target - camera.eye);
}

static std::string lens_fault(const CameraDesc& camera)
{
    const CameraModel& m = camera.model;
    const auto is_size = [](float x) { return std::isfinite(x) && x > 0.0f; };
    if (m.lens.surfaces.empty()) return "no lens to look through; name one";
    if (!is_size(m.film_diagonal) || !is_size(m.millimetre) || !(m.stop_diameter == 0.0f || is_size(m.stop_diameter)))
        return "a film, an aperture stop or a unit of length that is not positive; give millimetres";
    try {
        focused(m, focus_of(camera));
    } catch (const Error& error) {
        return fmt::format("a lens that makes no picture: {}", error.what());
    }
    return {};
}

std::string camera_fault(const CameraDesc& camera)
{
    const CameraModel& m = camera.model;
    if (m.kind >= camera_model_count) return fmt::format("there is no camera model {}", m.kind);
    const CameraModelInfo& info = models[m.kind];
    const float fov = camera.fov_degrees;
    if (!(fov > 0.0f) || !(fov < info.largest_fov || (info.largest_fov == 360.0f && fov <= 360.0f)))
        return fmt::format("a field of view of {:g} degrees; for {} it must lie between 0 and {:.0f}", fov, info.name,
                           info.largest_fov);
    const auto is_length = [](float x) { return std::isfinite(x) && x >= 0.0f; };
    if (!is_length(m.lens_radius) || !is_length(m.focus_distance) || !is_length(m.eye_distance) ||
        !is_length(m.half_side))
        return "a lens radius, focus distance, size or distance between the eyes that is negative or not finite; give "
               "lengths";
    if (m.lens_radius > 0.0f && m.kind != camera_pinhole)
        return fmt::format("a lens radius with the camera model {}; only pinhole has a thin lens", info.name);
    if (m.kind == camera_lens) return lens_fault(camera);
    for (const float k : m.k)
        if (!std::isfinite(k)) return "a distortion coefficient that is not finite; give numbers";
    if (m.calibrated_width != 0.0f) {
        if (m.kind != camera_kannala_brandt && m.kind != camera_brown_conrady)
            return fmt::format("a calibration with the camera model {}; it is for kannala-brandt and brown-conrady",
                               info.name);
        if (!(m.calibrated_width > 0.0f && m.calibrated_height > 0.0f && m.focal.x > 0.0f && m.focal.y > 0.0f) ||
            !std::isfinite(m.calibrated_width + m.calibrated_height + m.focal.x + m.focal.y + m.center.x + m.center.y))
            return "a calibration whose picture size or focal lengths are not positive; calibrate again";
    } else if (!(edge_radius(m, fov * pi / 360.0f) > 0.0f)) {
        return fmt::format("a distortion that folds the picture within the field of view of {:g} degrees; give a "
                           "smaller one, or other coefficients",
                           fov);
    }
    return {};
}

// Where OpenCV's order k1 k2 p1 p2 k3 k4 k5 k6 goes in Camera::k.
static constexpr std::array<std::size_t, 8> opencv_order = {0, 1, 6, 7, 2, 3, 4, 5};

bool set_distortion(CameraModel& model, std::span<const float> c)
{
    std::array<float, 9> k{};
    if (model.kind == camera_kannala_brandt && c.size() == 4) {
        std::copy(c.begin(), c.end(), k.begin());
    } else if (model.kind == camera_brown_conrady && (c.size() == 4 || c.size() == 5 || c.size() == 8)) {
        for (std::size_t i = 0; i < c.size(); ++i) k[opencv_order[i]] = c[i];
    } else if (model.kind == camera_hmd && (c.size() == 3 || c.size() == 9)) {
        for (std::size_t i = 0; i < 9; ++i) k[i] = c[i % c.size()];
    } else {
        return false;
    }
    model.k = k;
    return true;
}

std::vector<float> distortion_of(const CameraModel& model)
{
    const std::array<float, 9>& k = model.k;
    std::vector<float> c;
    if (model.kind == camera_kannala_brandt) c.assign(k.begin(), k.begin() + 4);
    if (model.kind == camera_brown_conrady)
        for (const std::size_t place : opencv_order) c.push_back(k[place]);
    if (model.kind == camera_hmd) c.assign(k.begin(), k.end());
    return c;
}

ReadyCamera make_camera(const CameraDesc& desc, int width, int height)
{
    const CameraModel& m = desc.model;
    const float half_fov = desc.fov_degrees * std::numbers::pi_v<float> / 360.0f;
    const float w = static_cast<float>(width), h = static_cast<float>(height);
    const bool is_flat = m.kind == camera_pinhole || m.kind == camera_orthographic;
    ReadyCamera camera{make_pinhole(desc.eye, desc.target, desc.up, is_flat ? std::tan(half_fov) : 1.0f, w, h),
                       nullptr};
    if (desc.mirrored) camera.right = -camera.right;
    camera.model = m.kind;
    camera.lens_radius = m.lens_radius;
    camera.focus_distance = focus_of(desc);
    camera.blades = m.blades;
    const float turn = m.blade_rotation_degrees / 360.0f;
    camera.blade_turn = turn - std::floor(turn);
    if (camera.blade_turn >= 1.0f) camera.blade_turn = 0.0f;
    camera.eye_offset = 0.5f * m.eye_distance;
    std::copy(m.k.begin(), m.k.end(), camera.k);
    if (m.kind == camera_orthographic) {
        const float scale = m.half_side > 0.0f ? m.half_side / std::tan(half_fov) : length(desc.target - desc.eye);
        camera.right *= scale, camera.up *= scale;
    }
    if (is_flat) return camera;

    camera.right = normalize(camera.right);
    camera.up = normalize(camera.up);
    if (m.kind == camera_lens) {
        camera.glass = focused(m, camera.focus_distance);
        camera.lens = camera.glass->view();
        camera.focal = vec2(std::sqrt(w * w + h * h) / m.film_diagonal);
        return camera;
    }
    if (m.calibrated_width > 0.0f) {
        const vec2 scale(w / m.calibrated_width, h / m.calibrated_height);
        camera.focal = m.focal * scale;
        camera.center = m.center * scale;
        return camera;
    }
    const float half_width = m.kind == camera_hmd ? 0.25f * w : 0.5f * w;
    camera.center = vec2(half_width, 0.5f * h);
    if (m.kind != camera_equirectangular)
        camera.focal = vec2(std::min(half_width, 0.5f * h) / edge_radius(m, half_fov));
    return camera;
}

} // namespace snell
