#include "snell/scene/lights.h"

#include "snell/core/error.h"

#include <cmath>

namespace snell {

static constexpr double pi_d = 3.14159265358979323846;

static vec3 unit(vec3 v)
{
    return vec3(glm::normalize(glm::dvec3(v)));
}

static float cos_degrees(float degrees)
{
    return static_cast<float>(std::cos(static_cast<double>(degrees) * (pi_d / 180.0)));
}

static Light blank_light(uint kind)
{
    Light light = {};
    light.kind = kind;
    light.primitive = none;
    light.instance = none;
    return light;
}

Light make_light(const LightDesc& desc)
{
    Light light = blank_light(desc.kind);
    light.emission = desc.emission;
    if (desc.kind != light_directional) light.position = desc.position;
    if (desc.kind != light_point) light.direction = unit(desc.direction);
    if (desc.kind == light_spot) {
        // The fall-off divides by the difference of the cosines: a hard edge is a very narrow soft one.
        constexpr float narrowest = 1e-5f;
        light.cos_outer = cos_degrees(desc.outer_degrees);
        light.cos_inner = std::max(cos_degrees(desc.inner_degrees), light.cos_outer + narrowest);
    }
    return light;
}

static uint emission_flags(const Material& material)
{
    const bool is_textured = material.emission_slot != none || material.coverage != coverage_opaque;
    return (material.flags & material_two_sided_emission ? light_two_sided : 0u) | (is_textured ? light_textured : 0u);
}

Light make_triangle_light(vec3 a, vec3 b, vec3 c, const Material& material, uint primitive, uint instance)
{
    Light light = blank_light(light_triangle);
    light.position = a;
    light.direction = b - a;
    light.edge = c - a;
    const glm::dvec3 cross = glm::cross(glm::dvec3(b) - glm::dvec3(a), glm::dvec3(c) - glm::dvec3(a));
    const double area2 = glm::length(cross); // twice the area
    light.cos_outer = static_cast<float>(0.5 * area2);
    light.normal = area2 > 0.0 ? vec3(cross / area2) : vec3(0.0f);
    light.emission = material.emission;
    light.flags = emission_flags(material);
    light.primitive = primitive;
    light.instance = instance;
    return light;
}

Light make_sphere_light(vec3 center, float radius, const Material& material, uint primitive, uint instance)
{
    Light light = blank_light(light_sphere);
    light.position = center;
    light.cos_inner = radius;
    light.emission = material.emission;
    light.flags = emission_flags(material);
    light.primitive = primitive;
    light.instance = instance;
    return light;
}

double light_power(const Light& light, double scene_radius)
{
    const double emitted = 0.2126 * static_cast<double>(light.emission.x) +
                           0.7152 * static_cast<double>(light.emission.y) +
                           0.0722 * static_cast<double>(light.emission.z);
    const double sides = (light.flags & light_two_sided) != 0u ? 2.0 : 1.0;
    const double a = static_cast<double>(light.cos_inner), b = static_cast<double>(light.cos_outer);
    switch (light.kind) {
    case light_point:
        return 4.0 * pi_d * emitted;
    case light_directional:
        return pi_d * scene_radius * scene_radius * emitted;
    case light_spot:
        return 2.0 * pi_d * (1.0 - 0.5 * (a + b)) * emitted; // the soft edge counts half
    case light_triangle:
        return pi_d * b * sides * emitted;
    case light_sphere:
        return pi_d * 4.0 * pi_d * a * a * sides * emitted;
    default:
        fail_check(__FILE__, __LINE__, fmt::format("unknown kind of light {}", light.kind));
    }
}

void build_alias_table(std::span<Light> lights, std::span<const double> powers)
{
    SNELL_CHECK_EQ(lights.size(), powers.size());
    const std::size_t count = lights.size();
    if (count == 0) return;
    double total = 0.0;
    for (const double power : powers) total += power;
    const bool uniform = !(total > 0.0) || !std::isfinite(total);

    // Weights with mean 1: each entry of the table holds 1, its own up to the threshold and another light's above.
    std::vector<double> weight(count, 1.0);
    std::vector<uint> small, large;
    for (std::size_t i = 0; i < count; ++i) {
        if (!uniform) weight[i] = powers[i] / total * static_cast<double>(count);
        (weight[i] < 1.0 ? small : large).push_back(static_cast<uint>(i));
    }
    while (!small.empty() && !large.empty()) {
        const uint s = small.back(), l = large.back();
        small.pop_back();
        lights[s].alias_threshold = static_cast<float>(weight[s]);
        lights[s].alias = l;
        weight[l] -= 1.0 - weight[s];
        if (weight[l] < 1.0) {
            large.pop_back();
            small.push_back(l);
        }
    }
    // What is left has weight 1 but for rounding. (It is never a light without power: the mean of the weights that are
    // left is 1, so beside a 0 there is one well above 1.)
    for (const std::vector<uint>* rest : {&small, &large}) {
        for (const uint i : *rest) {
            lights[i].alias_threshold = 1.0f;
            lights[i].alias = i;
        }
    }

    std::vector<double> chosen(count, 0.0);
    for (std::size_t i = 0; i < count; ++i) {
        const double kept = static_cast<double>(lights[i].alias_threshold);
        chosen[i] += kept;
        chosen[lights[i].alias] += 1.0 - kept;
    }
    for (std::size_t i = 0; i < count; ++i)
        lights[i].select_pdf = static_cast<float>(chosen[i] / static_cast<double>(count));
}

} // namespace snell
