#include "snell/view/navigation.h"

#include "snell/core/error.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace snell::view {

static vec3 any_perpendicular(vec3 v)
{
    const vec3 axis = std::abs(v.y) < 0.9f ? vec3(0.0f, 1.0f, 0.0f) : vec3(1.0f, 0.0f, 0.0f);
    return normalize(cross(v, axis));
}

CameraAxes camera_axes(const CameraDesc& camera)
{
    CameraAxes axes{};
    const vec3 view = camera.target - camera.eye;
    axes.forward = length(view) > 0.0f ? normalize(view) : vec3(0.0f, 0.0f, -1.0f);
    const vec3 right = cross(axes.forward, camera.up);
    axes.right = length(right) > 1e-6f * length(camera.up) ? normalize(right) : any_perpendicular(axes.forward);
    axes.up = cross(axes.right, axes.forward);
    if (camera.mirrored) axes.right = -axes.right;
    return axes;
}

static vec3 vertical(const CameraDesc& camera)
{
    return length(camera.up) > 0.0f ? normalize(camera.up) : vec3(0.0f, 1.0f, 0.0f);
}

// Rodrigues' formula; axis of unit length.
static vec3 rotated(vec3 v, vec3 axis, float angle)
{
    return v * std::cos(angle) + cross(axis, v) * std::sin(angle) + axis * (dot(axis, v) * (1.0f - std::cos(angle)));
}

static CameraDesc moved(CameraDesc camera, vec3 by)
{
    camera.eye += by;
    camera.target += by;
    camera.node = {}; // it stands where it was put
    return camera;
}

CameraDesc fly(CameraDesc camera, float right, float up, float forward)
{
    const CameraAxes axes = camera_axes(camera);
    return moved(camera, right * axes.right + up * vertical(camera) + forward * axes.forward);
}

// As much of the angle upwards as keeps that far away from the poles.
static float held_off_poles(const CameraDesc& camera, vec3 forward, float up)
{
    constexpr float closest = 0.02f;
    const float angle = std::acos(std::clamp(dot(forward, vertical(camera)), -1.0f, 1.0f)); // from the zenith
    const float wanted = std::clamp(angle - up, closest, 3.14159265f - closest);
    return angle - wanted;
}

CameraDesc turn(CameraDesc camera, float right, float up)
{
    const CameraAxes axes = camera_axes(camera);
    const float hand = camera.mirrored ? -1.0f : 1.0f;
    const vec3 axis = hand * axes.right; // so that turning about it by a positive angle looks up
    vec3 view = camera.target - camera.eye;
    view = rotated(view, axis, held_off_poles(camera, axes.forward, up));
    view = rotated(view, vertical(camera), -hand * right);
    camera.target = camera.eye + view;
    camera.node = {};
    return camera;
}

CameraDesc orbit(CameraDesc camera, vec3 pivot, float right, float up)
{
    const CameraAxes axes = camera_axes(camera);
    const float hand = camera.mirrored ? -1.0f : 1.0f;
    const vec3 axis = hand * axes.right;
    const float pitch = held_off_poles(camera, axes.forward, up);
    const auto around = [&](vec3 v) { return rotated(rotated(v, axis, pitch), vertical(camera), -hand * right); };
    camera.eye = pivot + around(camera.eye - pivot);
    camera.target = pivot + around(camera.target - pivot);
    camera.node = {};
    return camera;
}

CameraDesc pan(CameraDesc camera, float right, float up)
{
    const CameraAxes axes = camera_axes(camera);
    return moved(camera, right * axes.right + up * axes.up);
}

CameraDesc dolly(CameraDesc camera, vec3 pivot, float factor)
{
    return moved(camera, (pivot - camera.eye) * (1.0f - factor));
}

CameraDesc frame(CameraDesc camera, const Bounds& box, float aspect)
{
    if (box.empty()) return camera;
    const CameraAxes axes = camera_axes(camera);
    const float tan_shorter = std::tan(glm::radians(std::clamp(camera.fov_degrees, 1.0f, 170.0f)) * 0.5f);
    const float tan_x = tan_shorter * std::max(aspect, 1.0f), tan_y = tan_shorter * std::max(1.0f / aspect, 1.0f);
    const vec3 center = box.center(), half = 0.5f * box.extent();
    float distance = 0.0f; // from the centre, so that each corner lies inside all four sides
    for (int corner = 0; corner < 8; ++corner) {
        const vec3 d = half * vec3((corner & 1) != 0 ? 1.0f : -1.0f, (corner & 2) != 0 ? 1.0f : -1.0f,
                                   (corner & 4) != 0 ? 1.0f : -1.0f);
        const float depth = dot(d, axes.forward);
        distance = std::max(
            {distance, std::abs(dot(d, axes.right)) / tan_x - depth, std::abs(dot(d, axes.up)) / tan_y - depth});
    }
    distance = std::max(1.05f * distance, 1e-6f);
    camera.target = center;
    camera.eye = center - distance * axes.forward;
    camera.node = {};
    return camera;
}

float natural_speed(const Bounds& box)
{
    if (box.empty()) return 1.0f;
    const float size = length(box.extent());
    return std::isfinite(size) && size > 0.0f ? 0.2f * size : 1.0f;
}

// The spline between b and c at u in [0, 1]; knots at the square roots of the distances.
static vec3 catmull_rom(const std::array<vec3, 4>& p, float u)
{
    std::array<float, 4> t{};
    for (std::size_t i = 1; i < 4; ++i) t[i] = t[i - 1] + std::max(std::sqrt(length(p[i] - p[i - 1])), 1e-4f);
    const float at = t[1] + u * (t[2] - t[1]);
    const auto lerp = [&](vec3 a, vec3 b, float ta, float tb) { return a + (b - a) * ((at - ta) / (tb - ta)); };
    const vec3 a1 = lerp(p[0], p[1], t[0], t[1]), a2 = lerp(p[1], p[2], t[1], t[2]), a3 = lerp(p[2], p[3], t[2], t[3]);
    const vec3 b1 = lerp(a1, a2, t[0], t[2]), b2 = lerp(a2, a3, t[1], t[3]);
    return lerp(b1, b2, t[1], t[2]);
}

CameraDesc along(std::span<const CameraDesc> views, float t)
{
    SNELL_CHECK_LE(std::size_t{1}, views.size());
    if (views.size() == 1) return views[0];
    const auto last = views.size() - 1;
    const float place = std::clamp(t, 0.0f, 1.0f) * static_cast<float>(last);
    const std::size_t i = std::min(static_cast<std::size_t>(place), last - 1);
    const float u = place - static_cast<float>(i);
    const std::array<std::size_t, 4> knots = {i == 0 ? 0 : i - 1, i, i + 1, std::min(i + 2, last)};

    CameraDesc camera = u < 0.5f ? views[i] : views[i + 1];
    const auto through = [&](auto&& value) {
        std::array<vec3, 4> p{};
        for (std::size_t k = 0; k < 4; ++k) p[k] = value(views[knots[k]]);
        // Beyond the ends the path goes on as it comes.
        if (i == 0) p[0] = 2.0f * p[1] - p[2];
        if (i + 1 == last) p[3] = 2.0f * p[2] - p[1];
        return catmull_rom(p, u);
    };
    camera.eye = through([](const CameraDesc& c) { return c.eye; });
    camera.target = through([](const CameraDesc& c) { return c.target; });
    const vec3 up = mix(views[i].up, views[i + 1].up, u);
    if (length(up) > 1e-6f) camera.up = up;
    camera.fov_degrees = mix(views[i].fov_degrees, views[i + 1].fov_degrees, u);
    camera.node = {};
    return camera;
}

} // namespace snell::view
