#include "snell/lab/camera_lab.h"

#include "snell/core/error.h"

#include <algorithm>
#include <cmath>

namespace snell {
namespace {

constexpr float degrees = 57.2957795f;

bool sees(const Ray& ray)
{
    return ray.t_max > 0.0f;
}

float angle_between(vec3 a, vec3 b)
{
    return std::atan2(length(cross(a, b)), dot(a, b)) * degrees;
}

// Where the axis meets the picture; far away, so that the distance between the eyes of a pair is nothing.
vec2 middle(const Camera& camera)
{
    const vec3 at = camera_project(camera, camera.origin + 1e4f * camera.forward);
    return at.z > 0.0f ? vec2(at.x, at.y) : 0.5f * vec2(camera.width, camera.height);
}

// The angle from the axis at the last seeing point on the way from `from` to `to`.
float last_angle(const Camera& camera, vec2 from, vec2 to)
{
    float seeing = 0.0f, blind = 1.0f;
    const auto ray_at = [&](float t) { return camera_ray(camera, from + t * (to - from)); };
    if (sees(ray_at(1.0f))) return angle_between(ray_at(1.0f).direction, camera.forward);
    if (!sees(ray_at(0.0f))) return 0.0f;
    for (int i = 0; i < 24; ++i) {
        const float t = 0.5f * (seeing + blind);
        (sees(ray_at(t)) ? seeing : blind) = t;
    }
    return angle_between(ray_at(seeing).direction, camera.forward);
}

} // namespace

std::vector<CurvePoint> distortion_curve(const Camera& camera, int count)
{
    SNELL_CHECK_LT(1, count);
    const vec2 from = middle(camera);
    const vec2 way = vec2(camera.width, camera.height) - from;
    std::vector<CurvePoint> curve;
    for (int i = 0; i < count; ++i) {
        const float t = static_cast<float>(i) / static_cast<float>(count - 1);
        CurvePoint& point = curve.emplace_back();
        point.radius = t * length(way);
        const Ray ray = camera_ray(camera, from + t * way);
        if (sees(ray)) point.angle = angle_between(ray.direction, camera.forward);
    }
    return curve;
}

FieldOfView field_of_view(const Camera& camera)
{
    const vec2 from = middle(camera);
    const float w = camera.width, h = camera.height;
    FieldOfView fov;
    fov.horizontal = last_angle(camera, from, {0.0f, from.y}) + last_angle(camera, from, {w, from.y});
    fov.vertical = last_angle(camera, from, {from.x, 0.0f}) + last_angle(camera, from, {from.x, h});
    fov.diagonal = last_angle(camera, from, {0.0f, 0.0f}) + last_angle(camera, from, {w, h});
    return fov;
}

RoundTrip round_trip(const Camera& camera, int side, float size)
{
    SNELL_CHECK_LT(0, side);
    RoundTrip trip;
    double sum = 0;
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            const vec2 pixel((static_cast<float>(x) + 0.5f) / static_cast<float>(side) * camera.width,
                             (static_cast<float>(y) + 0.5f) / static_cast<float>(side) * camera.height);
            const Ray ray = camera_ray(camera, pixel);
            if (!sees(ray)) {
                ++trip.unseeing;
                continue;
            }
            for (const float distance : {1.0f, 10.0f, 100.0f}) {
                const vec3 back = camera_project_eye(camera, ray.origin + distance * size * ray.direction,
                                                     camera_eye(camera, pixel.x), camera_green);
                if (!(back.z > 0.0f)) {
                    ++trip.lost;
                    continue;
                }
                const float error = length(vec2(back.x, back.y) - pixel);
                trip.worst = std::max(trip.worst, error);
                sum += static_cast<double>(error);
                ++trip.points;
            }
        }
    if (trip.points > 0) trip.mean = static_cast<float>(sum / static_cast<double>(trip.points));
    return trip;
}

std::vector<vec2> round_trip_curve(const Camera& camera, int count, float size)
{
    SNELL_CHECK_LT(1, count);
    const vec2 from = middle(camera);
    const vec2 way = vec2(camera.width, camera.height) - from;
    std::vector<vec2> curve;
    for (int i = 0; i < count; ++i) {
        const float t = static_cast<float>(i) / static_cast<float>(count - 1);
        const vec2 pixel = from + t * way;
        const Ray ray = camera_ray(camera, pixel);
        if (!sees(ray)) continue;
        const uint eye = camera_eye(camera, pixel.x);
        float worst = 0.0f;
        bool is_found = true;
        for (const float distance : {1.0f, 10.0f, 100.0f}) {
            const vec3 back =
                camera_project_eye(camera, ray.origin + distance * size * ray.direction, eye, camera_green);
            is_found = is_found && back.z > 0.0f;
            worst = std::max(worst, length(vec2(back.x, back.y) - pixel));
        }
        if (is_found) curve.emplace_back(t * length(way), worst);
    }
    return curve;
}

std::vector<VignettingPoint> vignetting(const LensSystem& lens, int count, int side)
{
    SNELL_CHECK_LT(1, count);
    SNELL_CHECK_LT(0, side);
    std::vector<VignettingPoint> curve;
    for (int i = 0; i < count; ++i) {
        VignettingPoint& point = curve.emplace_back();
        point.radius = static_cast<float>(i) / static_cast<float>(count - 1) * lens.film_radius;
        const LensRay chief = lens_chief_ray(lens, point.radius);
        if (chief.weight > 0.0f) point.angle = angle_between(chief.direction, vec3(0.0f, 0.0f, 1.0f));
        double sum = 0;
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x) {
                const vec2 u((static_cast<float>(x) + 0.5f) / static_cast<float>(side),
                             (static_cast<float>(y) + 0.5f) / static_cast<float>(side));
                sum += static_cast<double>(sample_lens(lens, vec2(point.radius, 0.0f), u).weight);
            }
        point.light = static_cast<float>(sum / (static_cast<double>(side) * side));
        const float cos2 = 1.0f / (1.0f + sqr(point.radius / lens.rear_z));
        point.cos4 = cos2 * cos2;
    }
    return curve;
}

} // namespace snell
