// Cameras: from a point of the picture to a ray.
#ifndef SNELL_KERNEL_CAMERA_H
#define SNELL_KERNEL_CAMERA_H
#include "snell/kernel/ray.h"
SNELL_BEGIN

struct Camera
{
    vec3 origin;
    float width; // of the picture, in pixels
    vec3 right;  // half the picture's width at distance 1
    float height;
    vec3 up; // half the picture's height at distance 1
    float pad0;
    vec3 forward; // unit length
    float pad1;
};
SNELL_LAYOUT(Camera, 64)

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
    camera.pad0 = 0.0f;
    camera.pad1 = 0.0f;
    return camera;
}

// The ray through a point of the picture in pixels: (0, 0) is the upper left corner of the upper left pixel.
SNELL_FN Ray camera_ray(SNELL_IN(Camera) camera, vec2 pixel)
{
    float x = 2.0f * pixel.x / camera.width - 1.0f;
    float y = 1.0f - 2.0f * pixel.y / camera.height;
    return make_ray(camera.origin, normalize(camera.forward + x * camera.right + y * camera.up), infinity());
}

// The inverse: where in the picture a world point appears, and its depth along the view axis; depth <= 0: behind.
SNELL_FN vec3 camera_project(SNELL_IN(Camera) camera, vec3 point)
{
    vec3 d = point - camera.origin;
    float depth = dot(d, camera.forward);
    float x = dot(d, camera.right) / (dot(camera.right, camera.right) * depth);
    float y = dot(d, camera.up) / (dot(camera.up, camera.up) * depth);
    return vec3(0.5f * (x + 1.0f) * camera.width, 0.5f * (1.0f - y) * camera.height, depth);
}

SNELL_END
#endif
