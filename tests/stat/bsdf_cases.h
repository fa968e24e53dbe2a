// The materials and directions that the tests of scattering go through.
#pragma once

#include "snell/kernel/bsdf.h"
#include "tests/stat/chi_square.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>

namespace snell::test {

struct BsdfCase
{
    std::string name;
    MaterialPoint material;
};

inline MaterialPoint material_point_of(uint kind, float alpha)
{
    MaterialPoint m{};
    m.kind = kind;
    m.alpha = alpha;
    m.base_color = vec3(0.8f, 0.5f, 0.3f);
    m.specular = vec3(0.15f, 0.3f, 0.5f); // mix: reflectance
    m.ior = 1.5f;
    if (kind == material_conductor) {
        m.specular = vec3(0.2f, 0.92f, 1.1f); // eta
        m.k = vec3(3.9f, 2.45f, 2.14f);
    }
    return m;
}

inline std::vector<BsdfCase> smooth_cases()
{
    return {{"diffuse", material_point_of(material_diffuse, 0.0f)},
            {"mirror", material_point_of(material_mirror, 0.0f)},
            {"mix", material_point_of(material_mix, 0.0f)},
            {"dielectric", material_point_of(material_dielectric, 0.0f)},
            {"conductor", material_point_of(material_conductor, 0.0f)}};
}

inline std::vector<BsdfCase> rough_cases()
{
    std::vector<BsdfCase> cases;
    for (const float alpha : {0.02f, 0.1f, 0.3f, 0.7f, 1.0f}) {
        for (const auto& [kind, name] : {std::pair{material_mix, "mix"}, std::pair{material_dielectric, "dielectric"},
                                         std::pair{material_conductor, "conductor"}})
            cases.push_back({fmt::format("{} with alpha {}", name, alpha), material_point_of(kind, alpha)});
        // light from a denser medium into a thinner one, and strong refraction
        for (const float ior : {1.0f / 1.33f, 2.4f}) {
            cases.push_back({fmt::format("dielectric of {} with alpha {}", ior, alpha),
                             material_point_of(material_dielectric, alpha)});
            cases.back().material.ior = ior;
        }
    }
    return cases;
}

inline std::vector<BsdfCase> all_cases()
{
    std::vector<BsdfCase> cases = smooth_cases();
    for (BsdfCase& c : rough_cases()) cases.push_back(c);
    return cases;
}

// Steep, slanted and grazing, above and below the surface.
inline std::vector<vec3> outgoing_directions()
{
    std::vector<vec3> result;
    float azimuth = 0.3f;
    for (const float z : {1.0f, 0.8f, 0.4f, 0.1f, 0.02f, -0.95f, -0.6f, -0.2f, -0.05f}) {
        const float r = std::sqrt(1.0f - z * z);
        result.emplace_back(r * std::cos(azimuth), r * std::sin(azimuth), z);
        azimuth += 1.7f;
    }
    return result;
}

inline std::string describe(const BsdfCase& c, vec3 wo)
{
    return fmt::format("{}, wo {} {} {}", c.name, wo.x, wo.y, wo.z);
}

// What a sample returns to the camera of light of 1 from everywhere; refraction's scaling of radiance by 1 / eta^2
// taken back, for it is no loss of energy.
inline vec3 returned_energy(const BsdfSample& s)
{
    return s.pdf > 0.0f ? s.weight * (s.eta * s.eta) : vec3(0.0f);
}

} // namespace snell::test
