#include "snell/scene/studio.h"

#include "snell/core/error.h"
#include "snell/kernel/environment.h"

#include <algorithm>
#include <cmath>

namespace snell {

namespace {
// A rectangle that shines, seen from the middle of the room.
struct Softbox
{
    vec3 direction; // of its middle; unit length
    vec3 right, up; // orthonormal with it
    vec2 half_size; // at distance 1
    float radiance; // in the middle; the edges are soft
};
} // namespace

static Softbox softbox(vec3 toward, vec2 half_size, float radiance)
{
    Softbox box;
    box.direction = normalize(toward);
    box.right = normalize(cross(vec3(0, 1, 0), box.direction));
    box.up = cross(box.direction, box.right);
    box.half_size = half_size;
    box.radiance = radiance;
    return box;
}

// From 1 in the middle to 0 at the edge, over the outer part of the way: x is 1 at the edge.
static float soft_edge(float x)
{
    constexpr float begin = 0.75f;
    const float t = std::clamp((1.0f - std::abs(x)) / (1.0f - begin), 0.0f, 1.0f);
    return t * t * (3.0f - 2.0f * t);
}

static float light_of(const Softbox& box, vec3 w)
{
    const float ahead = dot(w, box.direction);
    if (ahead <= 0.0f) return 0.0f;
    return box.radiance * soft_edge(dot(w, box.right) / (ahead * box.half_size.x)) *
           soft_edge(dot(w, box.up) / (ahead * box.half_size.y));
}

// A floor that is darker than the ceiling, without an edge between them.
static float light_of_room(vec3 w)
{
    const float t = 0.5f + 0.5f * w.y;
    return 0.07f + 0.21f * t * t * (3.0f - 2.0f * t);
}

Image make_studio_image()
{
    const Softbox boxes[] = {
        softbox(vec3(-0.95f, 0.80f, 0.55f), vec2(0.42f, 0.42f), 4.5f), // key
        softbox(vec3(1.00f, 0.15f, 0.35f), vec2(0.35f, 0.60f), 0.5f),  // fill
        softbox(vec3(0.35f, 0.85f, -0.75f), vec2(0.90f, 0.12f), 5.0f), // rim
    };
    Image image;
    image.name = "studio";
    image.width = 256, image.height = 128;
    image.format = texels_rgba32f;
    image.floats.reserve(std::size_t{4} * image.width * image.height);
    Environment straight = {};
    straight.row_x = vec3(1, 0, 0), straight.row_y = vec3(0, 1, 0), straight.row_z = vec3(0, 0, 1);
    straight.mapping = environment_equirectangular;
    for (uint y = 0; y < image.height; ++y)
        for (uint x = 0; x < image.width; ++x) {
            const vec2 p((static_cast<float>(x) + 0.5f) / static_cast<float>(image.width),
                         (static_cast<float>(y) + 0.5f) / static_cast<float>(image.height));
            const vec3 w = environment_direction(straight, p);
            float light = light_of_room(w);
            for (const Softbox& box : boxes) light += light_of(box, w);
            image.floats.insert(image.floats.end(), {light, light, light, 1.0f});
        }
    return image;
}

void add_studio(Scene& scene)
{
    SNELL_CHECK_LT(0u, scene.cameras.size());
    const CameraDesc& camera = scene.cameras.front();
    // the room stands upright, however the camera is inclined
    const vec3 up = normalize(camera.up);
    const vec3 right = normalize(cross(camera.target - camera.eye, up)) * (camera.mirrored ? -1.0f : 1.0f);
    const vec3 back = cross(camera.mirrored ? -right : right, up);

    scene.environment.image = add(scene, make_studio_image());
    scene.environment.mapping = environment_equirectangular;
    scene.environment.radiance = vec3(1.0f);
    scene.environment.to_world = {vec4(right.x, up.x, back.x, 0.0f), vec4(right.y, up.y, back.y, 0.0f),
                                  vec4(right.z, up.z, back.z, 0.0f)};
}

} // namespace snell
