#include "snell/scene/lit.h"

#include "snell/kernel/tone.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace snell {

static constexpr double pi_d = std::numbers::pi;

// Of at most some thousand texels, evenly spread.
static double mean_luminance(const Image& image)
{
    const std::size_t texels = std::size_t{image.width} * image.height, step = texels / 4096 + 1;
    double sum = 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < texels; i += step, ++count) {
        vec3 c(0.0f);
        for (uint k = 0; k < 3; ++k) {
            const std::size_t at = 4 * i + k;
            c[k] = image.format == texels_rgba32f ? image.floats.at(at)
                                                  : static_cast<float>(image.bytes.at(at)) * (1.0f / 255.0f);
            if (image.format == texels_rgba8_srgb) c[k] = srgb_decode(c[k]);
        }
        sum += static_cast<double>(luminance(c));
    }
    return count > 0 ? sum / static_cast<double>(count) : 0.0;
}

namespace {
struct Glow
{
    double radiance = 0; // mean, as luminance
    bool is_lamp = false;
};
} // namespace

static Glow glow_of(const Scene& scene, const MaterialDesc& material)
{
    Glow glow;
    if (is_black(material.emission) || material.kind == material_unlit) return glow;
    glow.radiance = static_cast<double>(luminance(material.emission));
    // Principled materials come from models made for viewers that bring their own light: their labels and displays
    // shine with at most 1, whereas a lamp there has an emissive strength.
    glow.is_lamp = max3(material.emission) > 1.0f;
    if (material.kind == material_principled && !glow.is_lamp) return Glow{};
    if (material.emission_texture.valid()) {
        const double mean = mean_luminance(scene.images.at(material.emission_texture.image.value));
        glow.radiance *= mean;
        glow.is_lamp = glow.is_lamp && mean > 0.0;
    }
    return glow;
}

// Radiance times area of what shines in the group; infinite if there is a lamp.
static double group_glow(const Scene& scene, const Group& group, const std::vector<Glow>& glows)
{
    constexpr double lamp = std::numeric_limits<double>::infinity();
    double shining = 0;
    for (const Index<SphereDesc> index : group.spheres) {
        const SphereDesc& sphere = scene.spheres[index.value];
        const Glow& glow = glows[sphere.material.value];
        if (glow.is_lamp) return lamp;
        shining += glow.radiance * 4 * pi_d * static_cast<double>(sphere.radius) * static_cast<double>(sphere.radius);
    }
    for (const Index<Mesh> index : group.meshes) {
        const Mesh& mesh = scene.meshes[index.value];
        if (mesh.triangle_materials.empty() && glows[mesh.material.value].radiance == 0) continue;
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
            const uint material =
                mesh.triangle_materials.empty() ? mesh.material.value : mesh.triangle_materials[t].value;
            const Glow& glow = glows[material];
            if (glow.radiance == 0) continue;
            if (glow.is_lamp) return lamp;
            const uvec3 v = mesh.triangles[t];
            const glm::dvec3 a(mesh.positions[v.x]), b(mesh.positions[v.y]), c(mesh.positions[v.z]);
            shining += glow.radiance * 0.5 * glm::length(glm::cross(b - a, c - a));
        }
    }
    return shining;
}

bool is_lit(const Scene& scene)
{
    if (!is_black(scene.environment.radiance)) return true;
    for (const LightDesc& light : scene.lights)
        if (!is_black(light.emission)) return true;
    const auto is_unlit = [](const MaterialDesc& m) { return m.kind == material_unlit; };
    if (!scene.materials.empty() && std::all_of(scene.materials.begin(), scene.materials.end(), is_unlit)) return true;

    std::vector<Glow> glows;
    for (const MaterialDesc& material : scene.materials) glows.push_back(glow_of(scene, material));
    if (std::all_of(glows.begin(), glows.end(), [](const Glow& g) { return g.radiance == 0; })) return false;
    for (const PlaneDesc& plane : scene.planes) // endless, so never a detail
        if (glows[plane.material.value].radiance > 0) return true;

    // each group once, however often it is placed
    std::vector<double> shining_of(scene.groups.size(), -1.0);
    double shining = 0; // radiance times area
    for (const InstanceDesc& instance : scene.instances) {
        double& of_group = shining_of[instance.group.value];
        if (of_group < 0) of_group = group_glow(scene, scene.groups[instance.group.value], glows);
        if (std::isinf(of_group)) return true;
        shining += of_group * std::pow(std::abs(static_cast<double>(determinant(instance.transform))), 2.0 / 3.0);
    }
    const double radius = 0.5 * static_cast<double>(length(scene_bounds(scene).extent()));
    return shining > 0.01 * 4 * pi_d * radius * radius;
}

} // namespace snell
