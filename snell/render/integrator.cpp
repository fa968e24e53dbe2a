#include "snell/render/integrator.h"

#include "snell/core/error.h"
#include "snell/kernel/views.h"
#include "snell/render/visibility.h"

namespace snell {

// A custom integrator's rays have no number; no two of them are equal.
static uint ray_seed(const Ray& ray)
{
    const uvec3 h =
        pcg3d(uvec3(floatBitsToUint(ray.origin.x), floatBitsToUint(ray.origin.y), floatBitsToUint(ray.origin.z)));
    const uvec3 d = pcg3d(
        uvec3(floatBitsToUint(ray.direction.x), floatBitsToUint(ray.direction.y), floatBitsToUint(ray.direction.z)));
    return hash_uint(h.x ^ d.y);
}

Hit RayScene::intersect(const Ray& ray) const
{
    Hit hit;
    intersect_covered(view, accel_, {&ray, 1}, {&hit, 1}, false, [&](uint) { return ray_seed(ray); });
    return hit;
}

bool RayScene::occluded(const Ray& ray) const
{
    std::uint8_t blocked = 0;
    occluded_covered(view, accel_, {&ray, 1}, {&blocked, 1}, [&](uint) { return ray_seed(ray); });
    return blocked != 0;
}

static std::vector<IntegratorInfo>& registry()
{
    static const std::string depth = "max_depth=0  bounces after which a path ends; 0: no limit";
    static std::vector<IntegratorInfo> list = {
        {"path",
         "path tracing with next event estimation, multiple importance sampling, Russian roulette",
         {depth, "nee=1  0: do not sample the lights", "mis=1  0: light sampling alone where both could find a light",
          "rr=1  0: no Russian roulette"},
         {}},
        {"direct",
         "direct light alone: path tracing that ends after one bounce",
         {"nee=1  0: do not sample the lights", "mis=1  0: light sampling alone where both could find a light"},
         {}},
        {"whitted",
         "Whitted 1980: direct light with shadows, perfect reflection and refraction",
         {"max_depth=12  number of reflections and refractions that are followed, direct light not counted"},
         {}},
        {"ao",
         "ambient occlusion: how much of its surroundings a surface sees",
         {"distance=  how far surfaces shade each other, in scene units; a quarter of the scene's radius if not given"},
         {}},
        {"furnace",
         "path tracing with light of 1 from everywhere and no emitters: an albedo of 1 vanishes",
         {depth, "rr=1  0: no Russian roulette"},
         {}},
        {"normals", "shading normals, from [-1, 1] to [0, 1]", {}, {}, true, view_normals},
        {"geometric-normals", "normals of the surfaces themselves, likewise", {}, {}, true, view_geometric_normals},
        {"facing", "blue: seen from the front, where the normal points; red: from the back", {}, {}, true, view_facing},
        {"uv", "texture coordinates in red and green", {}, {}, true, view_uv},
        {"barycentrics", "weights of a triangle's vertices in red, green and blue", {}, {}, true, view_barycentrics},
        {"depth", "distance from the camera, 1 at the far side of the scene", {}, {}, true, view_depth},
        {"albedo", "colour of the materials", {}, {}, true, view_albedo},
        {"object", "a colour for each mesh, sphere and plane", {}, {}, true, view_object},
        {"instance", "a colour for each instance; grey: placed once", {}, {}, true, view_instance},
        {"material", "a colour for each material", {}, {}, true, view_material},
        {"primitive", "a colour for each triangle or sphere", {}, {}, true, view_primitive},
        {"steps",
         "traversal steps of camera rays as a heat map",
         {"max_steps=100  steps at the bright end"},
         {},
         true,
         view_steps},
    };
    return list;
}

void register_integrator(std::string name, std::string summary, RadianceFunction radiance)
{
    if (find_integrator(name) != nullptr)
        throw Error(fmt::format("there is an integrator '{}' already", name), "register yours under another name");
    registry().push_back({std::move(name), std::move(summary), {}, std::move(radiance)});
}

std::span<const IntegratorInfo> integrators()
{
    return registry();
}

bool traces_paths(const IntegratorInfo& integrator)
{
    return integrator.name == "path" || integrator.name == "direct" || integrator.name == "furnace";
}

const IntegratorInfo* find_integrator(std::string_view name)
{
    for (const IntegratorInfo& info : registry())
        if (info.name == name) return &info;
    return nullptr;
}

} // namespace snell
