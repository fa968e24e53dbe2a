// Small packed scenes made by hand, and rays for them.
#pragma once

#include "snell/bvh/accel.h"
#include "snell/scene/scene.h"

#include <cmath>
#include <random>
#include <vector>

namespace snell::test {

// The same numbers on every machine, which the standard distributions do not promise.
struct Random
{
    std::mt19937 bits;

    explicit Random(uint seed) : bits(seed) {}
    float uniform() { return static_cast<float>(bits() >> 8) * 0x1p-24f; }
    float range(float a, float b) { return a + (b - a) * uniform(); }
    vec3 in_box(float half)
    {
        const float x = range(-half, half), y = range(-half, half);
        return vec3(x, y, range(-half, half));
    }
    vec3 direction()
    {
        for (;;) {
            const vec3 p = in_box(1.0f);
            const float r2 = dot(p, p);
            if (r2 > 0.01f && r2 <= 1.0f) return p / std::sqrt(r2);
        }
    }
};

inline void add_triangle(PackedScene& scene, vec3 a, vec3 b, vec3 c)
{
    const uint first = static_cast<uint>(scene.positions.size());
    scene.positions.insert(scene.positions.end(), {a, b, c});
    scene.triangles.push_back({first, first + 1, first + 2, 0});
}

inline void add_sphere(PackedScene& scene, vec3 center, float radius)
{
    Sphere ball = {};
    ball.center = center;
    ball.radius = radius;
    scene.spheres.push_back(ball);
}

inline void add_plane(PackedScene& scene, vec3 normal, float offset)
{
    Plane plane = {};
    plane.normal = normalize(normal);
    plane.offset = offset;
    scene.planes.push_back(plane);
}

inline void add_instance(PackedScene& scene, uint group, const Transform& to_world)
{
    Instance instance = {};
    instance.to_world = to_world;
    instance.to_object = inverse(to_world).value();
    instance.group = group;
    scene.instances.push_back(instance);
}

// Whatever was added since the last call becomes a group, or the world.
inline PackedGroup take_group(PackedScene& scene)
{
    PackedGroup group;
    for (const PackedGroup& g : scene.groups) {
        group.first_triangle += g.triangle_count;
        group.first_sphere += g.sphere_count;
    }
    group.triangle_count = static_cast<uint>(scene.triangles.size()) - group.first_triangle;
    group.sphere_count = static_cast<uint>(scene.spheres.size()) - group.first_sphere;
    return group;
}
inline void end_group(PackedScene& scene)
{
    scene.groups.push_back(take_group(scene));
}
inline void end_world(PackedScene& scene)
{
    scene.world = take_group(scene);
}

inline void add_soup(PackedScene& scene, Random& random, int count, float size, vec3 center = vec3(0.0f))
{
    for (int i = 0; i < count; ++i) {
        const vec3 at = center + random.in_box(1.0f);
        const vec3 a = at + random.in_box(size), b = at + random.in_box(size);
        add_triangle(scene, a, b, at + random.in_box(size));
    }
}

// n by n squares of two triangles in the plane z = height, all vertices at exact places: many ties and edge hits.
inline void add_grid(PackedScene& scene, int n, float height)
{
    const auto at = [&](int i, int j) {
        return vec3(static_cast<float>(2 * i - n) / static_cast<float>(n),
                    static_cast<float>(2 * j - n) / static_cast<float>(n), height);
    };
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            add_triangle(scene, at(i, j), at(i + 1, j), at(i + 1, j + 1));
            add_triangle(scene, at(i, j), at(i + 1, j + 1), at(i, j + 1));
        }
}

inline void add_cloud(PackedScene& scene, Random& random, int count, float radius)
{
    for (int i = 0; i < count; ++i) {
        const vec3 center = random.in_box(1.0f);
        add_sphere(scene, center, random.range(0.1f, 1.0f) * radius);
    }
}

inline Ray ray_between(vec3 from, vec3 to)
{
    return make_ray(from, to - from, infinity());
}

// Rays of all kinds around the box [-size, size] at the centre.
inline std::vector<Ray> random_rays(Random& random, int count, float size = 1.0f, vec3 center = vec3(0.0f))
{
    std::vector<Ray> rays;
    for (int i = 0; i < count; ++i) {
        const vec3 from = center + random.in_box(2.0f * size);
        Ray ray = ray_between(from, center + random.in_box(size));
        if (i % 3 == 1) ray = make_ray(center + random.in_box(size), random.direction(), infinity());
        if (i % 7 == 2) ray.t_max = random.range(0.0f, 2.0f);
        if (i % 11 == 3) ray.t_min = random.range(-1.0f, 1.0f);
        if (i % 13 == 4) ray.direction *= std::exp2(random.range(-30.0f, 30.0f));
        rays.push_back(ray);
    }
    return rays;
}

// Rays of a camera at `eye`, in blocks of 4 by 4 pixels, that sees about as much as a box of half the width `size`
// around `target`. The same origin, much the same direction: what packets are for.
inline std::vector<Ray> camera_rays(vec3 eye, vec3 target, float size, int blocks)
{
    const vec3 forward = target - eye;
    const vec3 right = normalize(
        cross(forward, std::abs(forward.y) < length(forward) * 0.9f ? vec3(0.0f, 1.0f, 0.0f) : vec3(1.0f, 0.0f, 0.0f)));
    const vec3 up = normalize(cross(right, forward));
    const auto place = [&](int pixel) {
        return (static_cast<float>(pixel) / static_cast<float>(2 * blocks) - 1.0f) * size;
    };
    std::vector<Ray> rays;
    for (int block = 0; block < blocks * blocks; ++block)
        for (int i = 0; i < 16; ++i) {
            const int x = block % blocks * 4 + i % 4, y = block / blocks * 4 + i / 4;
            rays.push_back(ray_between(eye, target + place(x) * right + place(y) * up));
        }
    return rays;
}

// Rays that break tracers: along axes, with zero components of both signs, NaN, infinities, empty intervals, from
// vertices and surfaces.
inline std::vector<Ray> hostile_rays(const PackedScene& scene, Random& random)
{
    const float nan = std::nanf("");
    std::vector<Ray> rays;
    const float values[] = {-1.0f, -0.0f, 0.0f, 1.0f, 0.5f};
    for (float x : values)
        for (float y : values)
            for (float z : values)
                for (float o : {0.0f, 0.25f, -1.0f, 3.0f}) {
                    rays.push_back(make_ray(vec3(o, 0.0f, -o), vec3(x, y, z), infinity()));
                    rays.push_back(make_ray(vec3(-o, o, 2.0f), vec3(x, y, z), infinity()));
                }
    for (float bad : {nan, infinity(), -infinity(), 1e38f, -1e38f, 1e-40f, 1e-38f, 1e-30f, 1e30f})
        for (int axis = 0; axis < 3; ++axis) {
            Ray ray = make_ray(vec3(0.1f, 0.2f, 3.0f), vec3(0.01f, -0.02f, -1.0f), infinity());
            Ray origin = ray, direction = ray;
            origin.origin[axis] = bad;
            direction.direction[axis] = bad;
            rays.push_back(origin);
            rays.push_back(direction);
            ray.direction *= bad;
            rays.push_back(ray);
        }
    for (float bad : {nan, infinity(), -infinity(), 0.0f, -0.0f, -1.0f, 1e-38f, 1e-45f, 1.0f, 3.0f, 3.4e38f}) {
        Ray ray = make_ray(vec3(0.1f, 0.2f, 3.0f), vec3(0.01f, -0.02f, -1.0f), infinity());
        ray.t_max = bad;
        rays.push_back(ray);
        ray.t_max = infinity();
        ray.t_min = bad;
        rays.push_back(ray);
        ray.t_max = bad;
        rays.push_back(ray);
    }
    // From a vertex, from a point of a triangle, and to vertices and edges along axes.
    for (std::size_t i = 0; i < scene.triangles.size() && i < 50; ++i) {
        const Triangle& tri = scene.triangles[i];
        const vec3 a = scene.positions[tri.v0], b = scene.positions[tri.v1], c = scene.positions[tri.v2];
        rays.push_back(make_ray(a, random.direction(), infinity()));
        rays.push_back(make_ray(0.25f * a + 0.25f * b + 0.5f * c, random.direction(), infinity()));
        rays.push_back(make_ray(a + vec3(0.0f, 0.0f, 2.0f), vec3(0.0f, 0.0f, -1.0f), infinity()));
        rays.push_back(make_ray(b + vec3(0.0f, -2.0f, 0.0f), vec3(-0.0f, 1.0f, 0.0f), infinity()));
        rays.push_back(make_ray(0.5f * (a + b) - vec3(2.0f, 0.0f, 0.0f), vec3(1.0f, 0.0f, -0.0f), infinity()));
        rays.push_back(make_ray(a, b - a, infinity()));
        rays.push_back(ray_between(vec3(3.0f, 2.0f, 1.0f), c));
    }
    return rays;
}

} // namespace snell::test
