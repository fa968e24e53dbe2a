// Cameras: from a point of the picture to a ray, and back. docs/cameras.md has the formulas with their sources.
#ifndef SNELL_KERNEL_CAMERA_H
#define SNELL_KERNEL_CAMERA_H
#include "snell/kernel/camera_lens.h"
#include "snell/kernel/camera_projection.h"
#include "snell/kernel/lens_system.h"
#include "snell/kernel/ray.h"
SNELL_BEGIN

// The models: where the picture's points look. Camera::model.
SNELL_CONST uint camera_pinhole = 0u;              // R = f tan(theta); a thin lens where lens_radius > 0
SNELL_CONST uint camera_orthographic = 1u;         // parallel rays
SNELL_CONST uint camera_equirectangular = 2u;      // the whole sphere: longitude across, latitude down
SNELL_CONST uint camera_equidistant = 3u;          // fisheyes: R = f theta,
SNELL_CONST uint camera_equisolid = 4u;            // R = 2 f sin(theta / 2),
SNELL_CONST uint camera_stereographic = 5u;        // R = 2 f tan(theta / 2),
SNELL_CONST uint camera_fisheye_orthographic = 6u; // R = f sin(theta)
SNELL_CONST uint camera_kannala_brandt = 7u;       // OpenCV's fisheye model
SNELL_CONST uint camera_brown_conrady = 8u;        // OpenCV's model of lenses that are no fisheyes
SNELL_CONST uint camera_hmd = 9u;   // two eyes side by side, through the lenses of a head-mounted display
SNELL_CONST uint camera_lens = 10u; // through the glass of a photographic lens: lens_system.h
SNELL_CONST uint camera_model_count = 11u;

struct Camera
{
    vec3 origin; // between the eyes, where there are two
    float width; // of the picture, in pixels
    vec3 right;  // pinhole: half the picture's width at distance 1; orthographic: half its width; else unit length
    float height;
    vec3 up; // likewise, of the height
    uint model;
    vec3 forward;         // unit length
    float lens_radius;    // of a thin lens; 0: everything is sharp. Any other model has 0
    float focus_distance; // along `forward`
    uint blades;          // of the aperture; fewer than 3: a circle
    float blade_turn;     // of the first corner from `right`, in full turns counter-clockwise
    float eye_offset;     // half the distance between the eyes, along the unit vector of `right`
    vec2 focal;  // pixels per unit of the model's picture plane (lens: per millimetre of film); all but the first three
    vec2 center; // where the axis meets the picture, in pixels; of an eye: from the left edge of its half
    float k[9];  // Kannala-Brandt: k1 to k4. Brown-Conrady: k1 to k6, p1, p2. HMD: k1 to k3 of red, green and blue
    uint pad0;
    LensSystem lens; // of camera_lens; else it has no table
};
SNELL_LAYOUT(Camera, 176)

// Colours of HMDs: what `channel` may be. The others see green alike.
SNELL_CONST uint camera_green = 1u;

// A pinhole at eye that looks at target. tan_half_fov: tangent of half the full angle of the picture's shorter side.
// eye != target, up not parallel to the view.
SNELL_FN_COLD Camera make_pinhole(vec3 eye, vec3 target, vec3 up, float tan_half_fov, float width, float height)
{
    Camera camera;
    camera.origin = eye;
    camera.forward = normalize(target - eye);
    vec3 right = normalize(cross(camera.forward, up));
    float scale = tan_half_fov / min(width, height);
    camera.right = right * (scale * width);
    camera.up = cross(right, camera.forward) * (scale * height);
    camera.width = width;
    camera.height = height;
    camera.model = camera_pinhole;
    camera.lens_radius = 0.0f;
    camera.focus_distance = 1.0f;
    camera.blades = 0u;
    camera.blade_turn = 0.0f;
    camera.eye_offset = 0.0f;
    camera.focal = vec2(1.0f, 1.0f);
    camera.center = vec2(0.5f * width, 0.5f * height);
    for (uint i = 0u; i < 9u; ++i) camera.k[i] = 0.0f;
    camera.pad0 = 0u;
    camera.lens = no_lens();
    return camera;
}

// Which eye of an HMD sees a point of the picture: 0 left, 1 right.
SNELL_FN uint camera_eye(SNELL_IN(Camera) camera, float x)
{
    return camera.model == camera_hmd && x >= 0.5f * camera.width ? 1u : 0u;
}

SNELL_FN BrownConrady brown_of(SNELL_IN(Camera) camera)
{
    BrownConrady b;
    b.k1 = camera.k[0];
    b.k2 = camera.k[1];
    b.k3 = camera.k[2];
    b.k4 = camera.k[3];
    b.k5 = camera.k[4];
    b.k6 = camera.k[5];
    b.p1 = camera.k[6];
    b.p2 = camera.k[7];
    return b;
}

SNELL_FN vec4 kannala_of(SNELL_IN(Camera) camera)
{
    return vec4(camera.k[0], camera.k[1], camera.k[2], camera.k[3]);
}

SNELL_FN vec3 hmd_of(SNELL_IN(Camera) camera, uint channel)
{
    return vec3(camera.k[3u * channel], camera.k[3u * channel + 1u], camera.k[3u * channel + 2u]);
}

// Where a point of the picture looks, of all models but pinhole, orthographic and lens: x right, y up, z forward, unit
// length. (0, 0, 0): nowhere, it lies outside the circle of the picture.
SNELL_FN_COLD vec3 camera_look(SNELL_IN(Camera) camera, vec2 pixel, uint channel)
{
    if (camera.model == camera_equirectangular) {
        float longitude = (2.0f * pixel.x / camera.width - 1.0f) * pi;
        float latitude = (0.5f - pixel.y / camera.height) * pi;
        return vec3(cos(latitude) * sin(longitude), sin(latitude), cos(latitude) * cos(longitude));
    }
    float left = camera_eye(camera, pixel.x) == 1u ? 0.5f * camera.width : 0.0f;
    vec2 m = vec2((pixel.x - left - camera.center.x) / camera.focal.x, (camera.center.y - pixel.y) / camera.focal.y);
    if (camera.model == camera_brown_conrady) return brown_conrady_look(brown_of(camera), m);
    float r = length(m);
    float theta;
    if (camera.model == camera_kannala_brandt)
        theta = kannala_brandt_angle(kannala_of(camera), r);
    else if (camera.model == camera_hmd)
        theta = hmd_angle(hmd_of(camera, channel), r);
    else if (camera.model == camera_equidistant)
        theta = equidistant_angle(r);
    else if (camera.model == camera_equisolid)
        theta = equisolid_angle(r);
    else if (camera.model == camera_stereographic)
        theta = stereographic_angle(r);
    else
        theta = fisheye_orthographic_angle(r);
    if (theta < 0.0f) return vec3(0.0f);
    float s = r > 0.0f ? sin(theta) / r : 0.0f;
    return vec3(m.x * s, m.y * s, cos(theta));
}

// The film of a lens sees the world upside down: where on it the picture's point lies, in millimetres from the axis.
SNELL_FN vec2 camera_film_point(SNELL_IN(Camera) camera, vec2 pixel)
{
    return vec2((camera.center.x - pixel.x) / camera.focal.x, (pixel.y - camera.center.y) / camera.focal.y);
}

// A ray that has left a lens, in the scene: the camera's origin is the middle of the entrance pupil. A blocked one hits
// nothing.
SNELL_FN Ray camera_ray_of_lens(SNELL_IN(Camera) camera, LensRay r)
{
    if (!(r.weight > 0.0f)) return make_ray(camera.origin, camera.forward, -1.0f);
    vec3 o = camera.lens.unit * vec3(r.origin.x, r.origin.y, r.origin.z - camera.lens.entrance_z);
    vec3 origin = camera.origin + o.x * camera.right + o.y * camera.up + o.z * camera.forward;
    vec3 d = r.direction.x * camera.right + r.direction.y * camera.up + r.direction.z * camera.forward;
    return make_ray(origin, normalize(d), infinity());
}

// The chief ray of any point of the film; weight 0: blocked.
SNELL_FN_COLD LensRay camera_chief_ray(SNELL_IN(Camera) camera, vec2 film)
{
    float r = length(film);
    vec2 axis = r > 0.0f ? film / r : vec2(1.0f, 0.0f);
    LensRay ray = lens_chief_ray(camera.lens, r);
    vec3 o = ray.origin;
    vec3 d = ray.direction;
    ray.origin = vec3(axis.x * o.x - axis.y * o.y, axis.y * o.x + axis.x * o.y, o.z);
    ray.direction = vec3(axis.x * d.x - axis.y * d.y, axis.y * d.x + axis.x * d.y, d.z);
    return ray;
}

// The ray through a point of the picture in pixels: (0, 0) is the upper left corner of the upper left pixel. lens:
// where it passes a thin lens, from its centre, in radii; a traced one it passes in the middle. It hits nothing (t_max
// < 0) where the picture sees nothing.
SNELL_FN Ray camera_ray_through(SNELL_IN(Camera) camera, vec2 pixel, vec2 lens, uint channel)
{
    float x = 2.0f * pixel.x / camera.width - 1.0f;
    float y = 1.0f - 2.0f * pixel.y / camera.height;
    if (camera.model == camera_pinhole) {
        vec3 direction = camera.forward + x * camera.right + y * camera.up;
        if (camera.lens_radius == 0.0f) return make_ray(camera.origin, normalize(direction), infinity());
        vec3 shift = camera.lens_radius * (lens.x * normalize(camera.right) + lens.y * normalize(camera.up));
        return make_ray(camera.origin + shift, normalize(camera.focus_distance * direction - shift), infinity());
    }
    if (camera.model == camera_orthographic)
        return make_ray(camera.origin + x * camera.right + y * camera.up, camera.forward, infinity());
    if (camera.model == camera_lens)
        return camera_ray_of_lens(camera, camera_chief_ray(camera, camera_film_point(camera, pixel)));
    vec3 look = camera_look(camera, pixel, channel);
    if (is_black(look)) return make_ray(camera.origin, camera.forward, -1.0f);
    float side = camera_eye(camera, pixel.x) == 1u ? camera.eye_offset : -camera.eye_offset;
    if (camera.model != camera_hmd) side = 0.0f;
    vec3 direction = look.x * camera.right + look.y * camera.up + look.z * camera.forward;
    return make_ray(camera.origin + side * camera.right, normalize(direction), infinity());
}

// Through the centre of the lens, in green light.
SNELL_FN Ray camera_ray(SNELL_IN(Camera) camera, vec2 pixel)
{
    return camera_ray_through(camera, pixel, vec2(0.0f, 0.0f), camera_green);
}

SNELL_FN bool camera_sees(SNELL_IN(Ray) ray)
{
    return ray.t_max >= 0.0f;
}

// A ray and what the light along it counts for.
struct CameraSample
{
    Ray ray;      // !camera_sees(): there is none
    float weight; // 1, but for a traced lens: there the mean is 1 in the middle of the film, and 0 is no light
};

// A sample of what arrives at a point of the picture. u: where it passes the lens, uniform in the unit square.
SNELL_FN CameraSample sample_camera(SNELL_IN(Camera) camera, vec2 pixel, vec2 u, uint channel)
{
    CameraSample s;
    s.weight = 1.0f;
    if (camera.model == camera_lens) {
        LensRay r = sample_lens(camera.lens, camera_film_point(camera, pixel), u);
        s.weight = r.weight;
        s.ray = camera_ray_of_lens(camera, r);
        return s;
    }
    vec2 lens = vec2(0.0f, 0.0f);
    if (camera.lens_radius > 0.0f) lens = sample_aperture(camera.blades, camera.blade_turn, u);
    s.ray = camera_ray_through(camera, pixel, lens, channel);
    if (!camera_sees(s.ray)) s.weight = 0.0f;
    return s;
}

// Whether rays spread over a lens, so that samples need a place on it.
SNELL_FN bool camera_has_lens(SNELL_IN(Camera) camera)
{
    return camera.lens_radius > 0.0f || camera.model == camera_lens;
}

// Whether the eyes of an HMD see the three colours in different places: each sample then has one of them.
SNELL_FN bool camera_disperses(SNELL_IN(Camera) camera)
{
    if (camera.model != camera_hmd) return false;
    vec3 green = hmd_of(camera, 1u);
    return !is_black(hmd_of(camera, 0u) - green) || !is_black(hmd_of(camera, 2u) - green);
}

// Where in the picture a direction (x right, y up, z forward, not 0) is seen: pixels. Not visible: z of the result is
// 0, else 1. For all models but pinhole, orthographic and lens; of an HMD: from the left edge of the eye's half.
SNELL_FN_COLD vec3 camera_find(SNELL_IN(Camera) camera, vec3 d, uint channel)
{
    float across = sqrt(d.x * d.x + d.y * d.y);
    if (camera.model == camera_equirectangular) {
        float longitude = d.x == 0.0f && d.z == 0.0f ? 0.0f : atan(d.x, d.z);
        float latitude = atan(d.y, sqrt(d.x * d.x + d.z * d.z));
        return vec3(0.5f * (longitude * inv_pi + 1.0f) * camera.width, (0.5f - latitude * inv_pi) * camera.height,
                    1.0f);
    }
    vec2 m;
    if (camera.model == camera_brown_conrady) {
        if (!(d.z > 0.0f)) return vec3(0.0f);
        m = vec2(d.x / d.z, d.y / d.z);
        if (brown_conrady_folds(brown_of(camera), m)) return vec3(0.0f);
        m = brown_conrady_point(brown_of(camera), m);
    } else {
        float theta = atan(across, d.z);
        float r;
        if (camera.model == camera_kannala_brandt)
            r = kannala_brandt_radius(kannala_of(camera), theta);
        else if (camera.model == camera_hmd)
            r = hmd_radius(hmd_of(camera, channel), theta);
        else if (camera.model == camera_equidistant)
            r = theta;
        else if (camera.model == camera_equisolid)
            r = 2.0f * sin(0.5f * theta);
        else if (camera.model == camera_stereographic)
            r = stereographic_radius(theta);
        else
            r = fisheye_orthographic_radius(theta);
        if (r < 0.0f) return vec3(0.0f);
        float s = across > 0.0f ? r / across : 0.0f;
        m = vec2(d.x * s, d.y * s);
    }
    return vec3(camera.center.x + m.x * camera.focal.x, camera.center.y - m.y * camera.focal.y, 1.0f);
}

// Where the chief ray of a traced lens passes a point, d from its entrance pupil: pixels. z of the result: 0 not
// visible, else 1.
SNELL_FN_COLD vec3 camera_find_in_lens(SNELL_IN(Camera) camera, vec3 d)
{
    vec3 p = vec3(dot(d, camera.right), dot(d, camera.up), dot(d, camera.forward)) / camera.lens.unit;
    float aside = sqrt(p.x * p.x + p.y * p.y);
    float r = lens_film_radius(camera.lens, aside, p.z + camera.lens.entrance_z);
    if (r < 0.0f) return vec3(0.0f);
    float s = aside > 0.0f ? r / aside : 0.0f;
    return vec3(camera.center.x + p.x * s * camera.focal.x, camera.center.y - p.y * s * camera.focal.y, 1.0f);
}

// The inverse: where in the picture a world point appears (through the centre of the lens), and its depth along the
// view axis, or its distance from models that look to all sides; depth <= 0: it is not seen. eye: of an HMD, 0 left, 1
// right; else 0.
SNELL_FN vec3 camera_project_eye(SNELL_IN(Camera) camera, vec3 point, uint eye, uint channel)
{
    vec3 d = point - camera.origin;
    float depth = dot(d, camera.forward);
    if (camera.model == camera_pinhole || camera.model == camera_orthographic) {
        float w = camera.model == camera_pinhole ? depth : 1.0f;
        float x = dot(d, camera.right) / (dot(camera.right, camera.right) * w);
        float y = dot(d, camera.up) / (dot(camera.up, camera.up) * w);
        return vec3(0.5f * (x + 1.0f) * camera.width, 0.5f * (1.0f - y) * camera.height, depth);
    }
    if (camera.model == camera_hmd) d = d - (eye == 1u ? camera.eye_offset : -camera.eye_offset) * camera.right;
    if (is_black(d)) return vec3(0.0f);
    vec3 at;
    if (camera.model == camera_lens)
        at = camera_find_in_lens(camera, d);
    else
        at = camera_find(camera, vec3(dot(d, camera.right), dot(d, camera.up), dot(d, camera.forward)), channel);
    if (at.z == 0.0f) return vec3(0.0f);
    float left = eye == 1u ? 0.5f * camera.width : 0.0f;
    if (camera.model == camera_hmd && (at.x < 0.0f || at.x >= 0.5f * camera.width)) return vec3(0.0f);
    return vec3(at.x + left, at.y, length(d));
}

// In the left eye, in green light.
SNELL_FN vec3 camera_project(SNELL_IN(Camera) camera, vec3 point)
{
    return camera_project_eye(camera, point, 0u, camera_green);
}

SNELL_END
#endif
