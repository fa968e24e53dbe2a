// Scenes made of a few parts, and how bright a point of them is.
//
// A probe is a picture so small and so narrow that all its pixels see the same point: the spread between them is the
// error of their mean, whatever sampler drew them.
#pragma once

#include "snell/core/error.h"
#include "snell/render/render.h"
#include "tests/stat/chi_square.h"

#include <gtest/gtest.h>

#include <map>
#include <string>

namespace snell::test {

using Parameters = std::map<std::string, std::string>;

inline Index<MaterialDesc> diffuse(Scene& scene, float albedo, float emission = 0.0f, bool two_sided = false)
{
    MaterialDesc m;
    m.base_color = vec3(albedo);
    m.emission = vec3(emission);
    m.two_sided_emission = two_sided;
    return add(scene, m);
}

inline Index<MaterialDesc> glass(Scene& scene, float ior, float absorption = 0.0f, float alpha = 0.0f)
{
    MaterialDesc m;
    m.kind = material_dielectric;
    m.base_color = vec3(1.0f);
    m.ior = ior;
    m.absorption = vec3(absorption);
    m.alpha = alpha;
    return add(scene, m);
}

// A convex polygon as a fan; its front is where the corners run counter-clockwise.
inline Mesh polygon(const std::vector<vec3>& corners, Index<MaterialDesc> material)
{
    Mesh mesh;
    mesh.positions = corners;
    for (uint i = 2; i < corners.size(); ++i) mesh.triangles.emplace_back(0u, i - 1u, i);
    mesh.material = material;
    return mesh;
}

inline void add_plane(Scene& scene, vec3 point, vec3 normal, Index<MaterialDesc> material)
{
    PlaneDesc plane;
    plane.point = point;
    plane.normal = normal;
    plane.material = material;
    add(scene, plane);
}

inline void add_sphere(Scene& scene, vec3 center, float radius, Index<MaterialDesc> material)
{
    SphereDesc sphere;
    sphere.center = center;
    sphere.radius = radius;
    sphere.material = material;
    place(scene, sphere);
}

inline void add_point_light(Scene& scene, vec3 position, float intensity)
{
    LightDesc light;
    light.position = position;
    light.emission = vec3(intensity);
    add(scene, light);
}

inline void look(Scene& scene, vec3 eye, vec3 target, float fov_degrees = 0.01f)
{
    CameraDesc camera;
    camera.eye = eye;
    camera.target = target;
    const vec3 view = normalize(target - eye);
    camera.up = abs(view.y) > 0.9f ? vec3(1.0f, 0.0f, 0.0f) : vec3(0.0f, 1.0f, 0.0f);
    camera.fov_degrees = fov_degrees;
    scene.cameras = {camera};
}

inline RenderSettings probe_settings(const std::string& integrator, const Parameters& parameters = {}, uint spp = 256)
{
    RenderSettings settings;
    settings.width = settings.height = 16;
    settings.spp = long_tests() ? 16 * spp : spp;
    settings.integrator = integrator;
    settings.parameters = parameters;
    settings.strict = true;
    settings.seed = static_cast<uint>(test_seed());
    return settings;
}

inline Film render_film(Scene scene, const RenderSettings& settings)
{
    validate(scene);
    return render(scene, settings).film;
}

struct Measurement
{
    double mean = 0;
    double error = 0; // standard error of the mean
};

inline Measurement mean_of(const std::vector<double>& values)
{
    const double n = static_cast<double>(values.size());
    const double mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
    double squares = 0;
    for (const double v : values) squares += (v - mean) * (v - mean);
    return {mean, std::sqrt(squares / (n - 1) / n)};
}

inline std::vector<double> pixel_means(const Film& film)
{
    std::vector<double> values;
    for (std::size_t i = 0; i < film.sum.size(); ++i)
        values.push_back(double{film.sum[i].y} / static_cast<double>(film.sample_count[i]));
    return values;
}

// Brightness of green, over pixels that all have the same expectation.
inline Measurement measure(const Scene& scene, const RenderSettings& settings)
{
    return mean_of(pixel_means(render_film(scene, settings)));
}

// The value is known: within 4 standard errors, and what float arithmetic needs. worst: the standard error that would
// make the test worthless, relative to the value.
inline void expect_value(const Measurement& m, double exact, double worst = 0.01)
{
    EXPECT_NEAR(m.mean, exact, 4 * m.error + 3e-5 * exact + 1e-9) << "standard error " << m.error;
    EXPECT_LE(m.error, worst * exact + 1e-9) << "too noisy to tell anything";
}

// The ways of the path tracer to find light.
struct Technique
{
    std::string name;
    Parameters parameters;
};

inline std::vector<Technique> techniques()
{
    return {{"MIS", {}},
            {"light sampling", {{"mis", "0"}}},
            {"BSDF sampling", {{"nee", "0"}}},
            {"MIS without roulette", {{"rr", "0"}}}};
}

} // namespace snell::test
