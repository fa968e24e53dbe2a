// The principled surfaces and directions that the tests of scattering go through.
#pragma once

#include "snell/kernel/principled.h"
#include "snell/scene/albedo_tables.h"
#include "tests/stat/chi_square.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <string>

namespace snell::test {

struct PrincipledCase
{
    std::string name;
    PrincipledPoint point;
    bool white = true; // absorbs nothing
};

// The indices of rough glass in these tests.
inline constexpr std::array<float, 4> glass_iors = {1.05f, 1.33f, 1.5f, 2.4f};

inline const AlbedoTables& tables()
{
    static const AlbedoTables all = albedo_tables(glass_iors, true);
    return all;
}

inline PrincipledPoint resolve(const PrincipledPoint& p, vec3 wo)
{
    return resolve_principled(FloatArray{tables().values.data()}, p, wo);
}

inline uint glass_table_of(float ior)
{
    for (std::size_t i = 0; i < glass_iors.size(); ++i)
        if (glass_iors[i] == ior) return tables().glass_table[i];
    return none;
}

inline PrincipledPoint glass_point(float ior, float roughness)
{
    PrincipledPoint p = plain_principled_point(roughness * roughness);
    p.transmission = 1.0f;
    p.thin_walled = 0u;
    p.ior = ior;
    p.glass_table = glass_table_of(ior);
    return p;
}

inline vec3 direction_of(float z, float azimuth)
{
    const float r = std::sqrt(1.0f - z * z);
    return vec3(r * std::cos(azimuth), r * std::sin(azimuth), z);
}

// Isotropic surfaces of that roughness (perceptual, in [0, 1]) that lose no light.
inline std::vector<PrincipledCase> white_cases(float roughness)
{
    const PrincipledPoint plain = plain_principled_point(roughness * roughness);
    std::vector<PrincipledCase> cases;
    const auto add = [&](const std::string& name) -> PrincipledPoint& {
        cases.push_back({fmt::format("{} of roughness {}", name, roughness), plain, true});
        return cases.back().point;
    };
    add("metal").metallic = 1.0f;
    add("opaque");
    add("opaque that mirrors all").ior = 0.0f;
    add("half a metal").metallic = 0.5f;
    add("thin glass").transmission = 1.0f;
    {
        PrincipledPoint& p = add("part of each");
        p.metallic = 0.3f;
        p.transmission = 0.4f;
        p.diffuse_transmission = 0.3f;
    }
    {
        PrincipledPoint& p = add("rough clearcoat");
        p.clearcoat = 1.0f;
        p.clearcoat_alpha = p.alpha;
    }
    {
        PrincipledPoint& p = add("smooth clearcoat on metal");
        p.clearcoat = 1.0f;
        p.metallic = 1.0f;
    }
    {
        PrincipledPoint& p = add("sheen");
        p.sheen_color = vec3(1.0f);
        p.sheen_alpha = p.alpha;
    }
    {
        PrincipledPoint& p = add("clearcoat and sheen");
        p.clearcoat = 0.8f;
        p.clearcoat_alpha = 0.25f;
        p.sheen_color = vec3(0.7f);
        p.sheen_alpha = p.alpha;
    }
    for (const float ior : glass_iors) {
        add(fmt::format("glass of {}", ior)) = glass_point(ior, roughness);
    }
    {
        PrincipledPoint& p = add("glass with half a reflection");
        p = glass_point(1.5f, roughness);
        p.specular = 0.5f;
    }
    {
        PrincipledPoint& p = add("glass under a film");
        p = glass_point(1.5f, roughness);
        p.iridescence = 1.0f;
        p.iridescence_thickness = 350.0f;
    }
    {
        PrincipledPoint& p = add("half of solid glass under a clearcoat");
        p = glass_point(1.33f, roughness);
        p.transmission = 0.5f;
        p.clearcoat = 1.0f;
    }
    return cases;
}

// Surfaces with colours and with lobes of different width, each lobe at least in one.
inline std::vector<PrincipledCase> coloured_cases(float roughness)
{
    std::vector<PrincipledCase> cases = white_cases(roughness);
    for (PrincipledCase& c : cases) {
        c.point.base_color = vec3(0.8f, 0.5f, 0.3f);
        c.point.specular_color = vec3(0.6f, 0.9f, 1.0f);
        c.point.sheen_color *= vec3(0.4f, 0.6f, 0.9f);
        c.white = false;
    }
    const auto add = [&](const std::string& name) -> PrincipledPoint& {
        PrincipledPoint p = plain_principled_point(roughness * roughness);
        p.base_color = vec3(0.8f, 0.5f, 0.3f);
        cases.push_back({fmt::format("{} of roughness {}", name, roughness), p, false});
        return cases.back().point;
    };
    for (const float strength : {0.4f, 0.9f}) {
        PrincipledPoint& p = add(fmt::format("metal with anisotropy {}", strength));
        p.metallic = 1.0f;
        p.anisotropy = strength;
        p.anisotropy_direction = vec2(0.6f, 0.8f);
    }
    {
        PrincipledPoint& p = add("anisotropic glass");
        p = glass_point(1.5f, roughness);
        p.anisotropy = 0.5f;
        p.anisotropy_direction = vec2(-0.8f, 0.6f);
    }
    {
        PrincipledPoint& p = add("tilted clearcoat");
        p.clearcoat = 1.0f;
        p.clearcoat_alpha = 0.1f;
        p.clearcoat_normal = normalize(vec3(0.2f, -0.1f, 1.0f));
    }
    {
        PrincipledPoint& p = add("soap film on thin glass");
        p.transmission = 0.9f;
        p.iridescence = 0.8f;
        p.iridescence_thickness = 420.0f;
    }
    {
        PrincipledPoint& p = add("glass of index 1");
        p = glass_point(1.0f, roughness);
        p.transmission = 0.7f;
    }
    {
        PrincipledPoint& p = add("all at once");
        p.metallic = 0.3f;
        p.transmission = 0.5f;
        p.thin_walled = 0u;
        p.glass_table = glass_table_of(1.5f);
        p.diffuse_transmission = 0.4f;
        p.diffuse_transmission_color = vec3(0.2f, 0.9f, 0.4f);
        p.clearcoat = 0.5f;
        p.clearcoat_alpha = 0.2f;
        p.sheen_color = vec3(0.3f, 0.2f, 0.1f);
        p.sheen_alpha = 0.3f;
        p.iridescence = 0.5f;
        p.iridescence_thickness = 300.0f;
    }
    return cases;
}

// Any numbers that a file could bring, within what validation lets through and somewhat beyond.
inline PrincipledPoint random_principled_point(Draw& draw)
{
    const auto number = [&] {
        const float x = draw.next();
        return x < 0.15f ? 0.0f : x > 0.85f ? 1.0f : draw.next();
    };
    const auto color = [&] {
        const float r = number(), g = number();
        return vec3(r, g, number());
    };
    PrincipledPoint p = plain_principled_point(std::pow(number(), 6.0f));
    p.base_color = color();
    p.metallic = number();
    p.anisotropy = number();
    const float turn = draw.next() * 6.2831853f;
    p.anisotropy_direction = vec2(std::cos(turn), std::sin(turn));
    const float kind = draw.next();
    p.ior = kind < 0.1f ? 0.0f : kind < 0.2f ? 1.0f : kind < 0.6f ? 1.5f : 0.4f + 3.0f * draw.next();
    p.specular = number();
    p.specular_color = 1.5f * color();
    p.clearcoat = number();
    p.clearcoat_alpha = std::pow(number(), 6.0f);
    p.clearcoat_normal = draw.direction();
    p.clearcoat_normal.z = std::abs(p.clearcoat_normal.z);
    p.sheen_color = color();
    p.sheen_alpha = number();
    p.transmission = number();
    p.thin_walled = draw.bits() & 1u;
    p.glass_table = glass_table_of(1.5f);
    p.iridescence = number();
    p.iridescence_ior = 1.0f + 1.5f * number();
    p.iridescence_thickness = 1000.0f * number();
    p.diffuse_transmission = number();
    p.diffuse_transmission_color = color();
    return p;
}

} // namespace snell::test
