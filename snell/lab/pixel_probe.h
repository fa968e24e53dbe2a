// What is behind a pixel.
#pragma once

#include "snell/lab/path_probe.h"
#include "snell/scene/scene.h"

namespace snell {

struct PixelProbe
{
    int x = 0, y = 0;
    ProbedVertex first;                     // of the ray through the pixel's centre; is_surface false: nothing is there
    vec3 albedo{0.0f};                      // part of the light that the material sends back
    float depth = 0;                        // distance from where the ray starts, in scene units
    std::string object, material, instance; // names in the scene; empty: it has none
    uint scene_instance = none;             // number in Scene::instances; none: placed once
};

// scene: what `prepared` was made from, for the names. Throws Error if the pixel is not in the picture.
PixelProbe probe_pixel(const Prepared& prepared, const CameraDesc& camera, const Scene& scene,
                       const RenderSettings& settings, int x, int y);

// The name of an object by its number (meshes, then spheres, then planes), "sphere 3" if it has none; "" for none.
std::string object_name(const Scene& scene, uint object);
std::string material_name(const Scene& scene, uint material);

// "triangle 17", "sphere 3", "plane 0", by its number in the packed arrays; "" for none.
std::string primitive_name(uint primitive);

// A pixel's samples until now. standard_error: of the mean, on luminance; 0 with fewer than two samples.
struct PixelValue
{
    vec3 mean{0.0f};
    uint samples = 0;
    double standard_error = 0;
    float seconds = 0; // of a thread's time; shared alike by its tile's pixels
};
PixelValue pixel_value(const Film& film, int x, int y);

} // namespace snell
