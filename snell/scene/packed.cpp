#include "snell/scene/packed.h"

#include <algorithm>

namespace snell {

SceneView PackedScene::view() const
{
    SceneView v = {};
    v.positions.at = positions.data();
    v.normals.at = normals.data();
    v.uvs.at = uvs.data();
    v.tangents.at = tangents.data();
    v.colors.at = colors.data();
    v.triangles.at = triangles.data();
    v.surfaces.at = surfaces.data();
    v.spheres.at = spheres.data();
    v.planes.at = planes.data();
    v.instances.at = instances.data();
    v.materials.at = materials.data();
    v.lights.at = lights.data();
    v.textures.at = textures.data();
    v.texels.at = texels.data();
    v.srgb.at = srgb.data();
    v.slots.at = slots.data();
    v.principled.at = principled.data();
    v.albedo.at = albedo.data();
    v.environment_cdf.at = environment_cdf.data();
    v.light_count = static_cast<uint>(lights.size());
    const auto is_area_light = [](const Light& light) { return light.kind >= light_triangle; };
    v.delta_light_count = static_cast<uint>(std::find_if(lights.begin(), lights.end(), is_area_light) - lights.begin());
    v.plane_count = static_cast<uint>(planes.size());
    v.coverage = coverage;
    v.environment = environment;
    v.scene_radius = radius;
    v.scene_center = center;
    return v;
}

template <class T>
static std::size_t bytes_of(const std::vector<T>& items)
{
    return items.size() * sizeof(T);
}

std::size_t PackedScene::bytes() const
{
    return bytes_of(positions) + bytes_of(normals) + bytes_of(tangents) + bytes_of(uvs) + bytes_of(colors) +
           bytes_of(triangles) + bytes_of(surfaces) + bytes_of(spheres) + bytes_of(planes) + bytes_of(instances) +
           bytes_of(materials) + bytes_of(lights) + bytes_of(textures) + bytes_of(texels) + bytes_of(srgb) +
           bytes_of(slots) + bytes_of(principled) + bytes_of(albedo) + bytes_of(environment_cdf) + bytes_of(groups);
}

} // namespace snell
