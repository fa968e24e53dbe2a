// The light list of a packed scene, from its finished primitives.
#include "snell/core/error.h"
#include "snell/core/parallel.h"
#include "snell/kernel/light.h"
#include "snell/kernel/random.h"
#include "snell/scene/lights.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace snell {

static constexpr std::size_t max_lights = std::size_t{1} << 28;

static bool is_emissive(const PackedScene& packed, uint material)
{
    return !is_black(packed.materials[material].emission);
}

// Gives the emissive primitives of a run consecutive light numbers from `first` on; returns how many there are.
static std::size_t number_lights(PackedScene& packed, const PackedGroup& group, std::size_t first)
{
    std::size_t next = first;
    const std::size_t end = std::size_t{group.first_triangle} + group.triangle_count;
    for (std::size_t t = group.first_triangle; t < end;) {
        const uint s = packed.triangles[t].surface;
        std::size_t surface_end =
            s + 1 < packed.surfaces.size() ? packed.surfaces[s + 1].first_triangle : packed.triangles.size();
        const bool shines = is_emissive(packed, packed.surfaces[s].material);
        packed.surfaces[s].first_light = shines ? static_cast<uint>(next) : none;
        if (shines) next += surface_end - t;
        t = surface_end;
    }
    for (uint i = 0; i < group.sphere_count; ++i) {
        Sphere& sphere = packed.spheres[group.first_sphere + i];
        sphere.light = is_emissive(packed, sphere.material) ? static_cast<uint>(next++) : none;
    }
    return next - first;
}

// Writes the lights of one placed run. base: what is added to the numbers that number_lights gave.
static void make_area_lights(const Scene& scene, PackedScene& packed, const PackedGroup& group,
                             const Instance* instance, uint instance_index, std::size_t base)
{
    const bool mirrored = instance != nullptr && determinant(instance->to_world) < 0.0f;
    const std::size_t end = std::size_t{group.first_triangle} + group.triangle_count;
    for (std::size_t t = group.first_triangle; t < end; ++t) {
        const Triangle triangle = packed.triangles[t];
        const Surface& surface = packed.surfaces[triangle.surface];
        if (surface.first_light == none) {
            // Skip the rest of a surface that is dark.
            const std::size_t next = std::size_t{triangle.surface} + 1;
            t = (next < packed.surfaces.size() ? packed.surfaces[next].first_triangle : packed.triangles.size()) - 1;
            continue;
        }
        vec3 p[3] = {packed.positions[triangle.v0], packed.positions[triangle.v1], packed.positions[triangle.v2]};
        if (instance != nullptr)
            for (vec3& corner : p) corner = transform_point(instance->to_world, corner);
        if (mirrored) std::swap(p[1], p[2]);
        Light& light = packed.lights[base + surface.first_light + (t - surface.first_triangle)];
        light = make_triangle_light(p[0], p[1], p[2], packed.materials[surface.material],
                                    pack_primitive(kind_triangle, static_cast<uint>(t)), instance_index);
        if (mirrored) light.flags |= light_mirrored;
    }
    for (uint i = 0; i < group.sphere_count; ++i) {
        const uint index = group.first_sphere + i;
        const Sphere& sphere = packed.spheres[index];
        if (sphere.light == none) continue;
        vec3 center = sphere.center;
        float radius = sphere.radius;
        if (instance != nullptr) {
            const float scale = uniform_scale(instance->to_world);
            if (scale == 0.0f) {
                const uint number = sphere.object - static_cast<uint>(scene.meshes.size());
                throw Error(fmt::format("sphere {} '{}' emits light and is placed by instance {} '{}' with a scale "
                                        "that differs by direction",
                                        number, scene.spheres[number].name, instance->object,
                                        scene.instances[instance->object].name),
                            "scale it uniformly, or use a mesh for a light of that shape");
            }
            center = transform_point(instance->to_world, center);
            radius *= scale;
        }
        packed.lights[base + sphere.light] = make_sphere_light(center, radius, packed.materials[sphere.material],
                                                               pack_primitive(kind_sphere, index), instance_index);
    }
}

// Half of the choices go by power, half to all lights alike: a weak light may be the one that is near.
static std::vector<double> selection_weights(const std::vector<double>& powers)
{
    const double total = std::accumulate(powers.begin(), powers.end(), 0.0);
    if (!(total > 0.0) || !std::isfinite(total)) return powers;
    const auto shining = std::count_if(powers.begin(), powers.end(), [](double p) { return p > 0.0; });
    std::vector<double> weights;
    for (const double power : powers)
        weights.push_back(power > 0.0 ? 0.5 * power / total + 0.5 / static_cast<double>(shining) : 0.0);
    return weights;
}

// Mean of what textures leave of a light's emission, by looking at some points of it. If all of them are dark it will
// not be chosen, and is found by rays that happen to hit it.
static double mean_light_texture(const SceneView& view, const Light& light)
{
    if ((light.flags & light_textured) == 0u) return 1.0;
    constexpr uint points = 64;
    double sum = 0.0;
    for (uint i = 0; i < points; ++i) {
        const uvec2 s = scrambled_sobol(reverse_bits(i), 0u);
        const vec2 u(unit_float(s.x), unit_float(s.y));
        const vec3 target = light.position + light.cos_inner * sample_uniform_sphere(u); // of a sphere
        sum += static_cast<double>(luminance(light_texture(view, light, u, target)));
    }
    return sum / points;
}

void pack_lights(const Scene& scene, PackedScene& packed)
{
    packed.lights.clear();
    for (const LightDesc& desc : scene.lights) packed.lights.push_back(make_light(desc));
    std::size_t count = packed.lights.size();
    count += number_lights(packed, packed.world, count);
    std::vector<std::size_t> lights_of_group;
    for (const PackedGroup& group : packed.groups) lights_of_group.push_back(number_lights(packed, group, 0));
    for (Instance& instance : packed.instances) {
        instance.light_base = static_cast<uint>(count);
        count += lights_of_group[instance.group];
        if (count > max_lights)
            throw Error(fmt::format("the scene has more than {} emissive primitives, counted by instance", max_lights),
                        "make fewer triangles emissive, or place them less often");
    }
    packed.lights.resize(count);

    make_area_lights(scene, packed, packed.world, nullptr, none, 0);
    parallel_for(packed.instances.size(), [&](std::size_t i) {
        const Instance& instance = packed.instances[i];
        if (lights_of_group[instance.group] == 0) return;
        make_area_lights(scene, packed, packed.groups[instance.group], &instance, static_cast<uint>(i),
                         instance.light_base);
    });

    std::vector<double> powers(count);
    const SceneView view = packed.view();
    parallel_for(count, [&](std::size_t i) {
        powers[i] = light_power(packed.lights[i], static_cast<double>(packed.radius)) *
                    mean_light_texture(view, packed.lights[i]);
    });
    build_alias_table(packed.lights, selection_weights(powers));
}

} // namespace snell
