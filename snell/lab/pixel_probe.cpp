#include "snell/lab/pixel_probe.h"

#include "snell/core/error.h"

#include <cmath>

namespace snell {

// Its own name, or what it is with its number; "" if there is no such thing.
template <class Things>
static std::string name_of(const Things& things, std::size_t i, std::string_view what)
{
    if (i >= things.size()) return "";
    return things[i].name.empty() ? fmt::format("{} {}", what, i) : things[i].name;
}

std::string object_name(const Scene& scene, uint object)
{
    std::size_t i = object;
    if (i < scene.meshes.size()) return name_of(scene.meshes, i, "mesh");
    i -= scene.meshes.size();
    if (i < scene.spheres.size()) return name_of(scene.spheres, i, "sphere");
    return name_of(scene.planes, i - scene.spheres.size(), "plane");
}

std::string material_name(const Scene& scene, uint material)
{
    return name_of(scene.materials, material, "material");
}

std::string primitive_name(uint primitive)
{
    if (primitive == none) return "";
    const uint kind = primitive_kind(primitive);
    return fmt::format("{} {}",
                       kind == kind_triangle ? "triangle"
                       : kind == kind_sphere ? "sphere"
                                             : "plane",
                       primitive_index(primitive));
}

PixelProbe probe_pixel(const Prepared& prepared, const CameraDesc& camera, const Scene& scene,
                       const RenderSettings& settings, int x, int y)
{
    RenderSettings centre = settings;
    centre.integrator = "albedo";
    centre.parameters.clear();
    centre.pixel_jitter = false;
    ProbedPath path = probe_path(prepared, camera, centre, x, y, 0);
    PixelProbe probe;
    probe.x = x;
    probe.y = y;
    probe.first = std::move(path.vertices.at(0));
    if (!probe.first.is_surface) return probe;
    probe.albedo = path.radiance;
    probe.depth = probe.first.hit.t * length(probe.first.ray.direction);
    probe.object = object_name(scene, probe.first.surface.object);
    probe.material = material_name(scene, probe.first.surface.material);
    if (probe.first.hit.instance != none) {
        probe.scene_instance = prepared.packed.instances[probe.first.hit.instance].object;
        probe.instance = name_of(scene.instances, probe.scene_instance, "instance");
    }
    return probe;
}

PixelValue pixel_value(const Film& film, int x, int y)
{
    PixelValue value;
    if (x < 0 || y < 0 || x >= film.width || y >= film.height) return value;
    const std::size_t i =
        static_cast<std::size_t>(y) * static_cast<std::size_t>(film.width) + static_cast<std::size_t>(x);
    value.samples = film.sample_count[i];
    if (value.samples > 0) value.mean = film.sum[i] / static_cast<float>(value.samples);
    value.standard_error = std::sqrt(film.mean_variance(i));
    if (!film.seconds.empty()) value.seconds = film.seconds[i];
    return value;
}

} // namespace snell
