#include "snell/io/obj/material.h"

#include <cmath>

namespace snell::obj {
namespace {

bool is_reflecting(int illum)
{
    return illum == 3 || illum == 5 || illum == 8;
}

bool is_glass(int illum)
{
    return illum == 4 || illum == 6 || illum == 7 || illum == 9;
}

bool is_principled(const MtlMaterial& m)
{
    for (const std::string keyword : {"Pr", "Pm", "Ps", "Pc", "Pcr", "aniso"})
        if (m.has(keyword) || m.has_map("map_" + keyword)) return true;
    return false;
}

float opacity_of(const MtlMaterial& m)
{
    const float opacity = m.has("d") ? m.number("d", 1) : 1.0f - m.number("Tr", 0);
    return m.has_map("map_d") && !(opacity > 0.0f) ? 1.0f : clamp(opacity, 0.0f, 1.0f);
}

// Of highlights, by the exponent of Phong's (Walter et al. 2007).
float alpha_of(const MtlMaterial& m)
{
    return std::sqrt(2.0f / (max(m.number("Ns", 1), 0.0f) + 2.0f));
}

// A number in [0, 1]; one that its map would multiply to nothing counts as 1.
float factor(const MtlMaterial& m, const std::string& keyword)
{
    const float value = clamp(m.number(keyword, 0), 0.0f, 1.0f);
    return value == 0.0f && m.has_map("map_" + keyword) ? 1.0f : value;
}

void make_principled(const MtlMaterial& m, vec3 base_color, bool glass, MaterialDesc& out)
{
    out.kind = material_principled;
    out.base_color = base_color;
    const float ior = m.number("Ni", 1);
    out.ior = ior > 1.0f ? ior : 1.5f;
    PrincipledDesc& p = out.principled;
    p.metallic = factor(m, "Pm");
    p.roughness = m.has("Pr") || m.has_map("map_Pr") ? factor(m, "Pr") : std::sqrt(alpha_of(m));
    const float specular = max3(m.color("Ks"));
    p.specular = specular > 0.0f ? min(2.0f * specular, 1.0f) : 1.0f;
    p.clearcoat = factor(m, "Pc");
    p.clearcoat_roughness = factor(m, "Pcr");
    p.sheen_color = vec3(factor(m, "Ps"));
    constexpr float cloth = 0.3f, turn = 6.28318531f;
    if (p.sheen_color.x > 0.0f) p.sheen_roughness = cloth;
    p.anisotropy = factor(m, "aniso");
    p.anisotropy_rotation = turn * m.number("anisor", 0);
    if (glass) {
        p.transmission = 1.0f;
        p.thin_walled = false;
    }
    out.opacity = opacity_of(m);
    if (out.opacity < 1.0f) out.coverage = coverage_blend;
}

} // namespace

MaterialDesc to_material(const MtlMaterial& m)
{
    const vec3 none(0.0f), all(1.0f);
    MaterialDesc out;
    out.name = m.name;
    out.emission = max(m.color("Ke"), none);
    if (m.has_map("map_Ke") && is_black(out.emission)) out.emission = all;

    vec3 diffuse = clamp(m.color("Kd"), none, all);
    if (m.has_map("map_Kd") && is_black(diffuse))
        diffuse = all;
    else if (!m.has("Kd"))
        diffuse = vec3(is_black(out.emission) ? 0.8f : 0.0f);
    const vec3 specular = clamp(m.color("Ks"), none, all);
    const int illum = static_cast<int>(clamp(m.number("illum", 0), 0.0f, 10.0f));
    const float ior = m.number("Ni", 1);

    if (is_principled(m)) {
        make_principled(m, diffuse, is_glass(illum), out);
        return out;
    }
    const float opacity = opacity_of(m);
    const bool has_opacity_map = m.has_map("map_d");
    if (is_glass(illum) || (opacity < 1.0f && !has_opacity_map)) {
        const vec3 filter = max(m.has("Tf") ? m.color("Tf") : m.color("Kt"), none);
        vec3 tint = max3(filter) > 0.0f ? filter / max3(filter) : all;
        if (!is_glass(illum)) tint *= mix(all, diffuse, opacity);
        out.kind = material_dielectric;
        out.base_color = sqrt(tint);
        out.ior = ior > 0.0f ? ior : 1.0f;
        if (is_glass(illum) && !(ior > 1.0f)) out.ior = 1.5f;
        return out;
    }
    out.opacity = opacity;
    if (is_reflecting(illum) && max3(specular) > 0.0f && max3(diffuse) < 0.1f * max3(specular)) {
        out.kind = material_mirror;
        out.base_color = specular;
        return out;
    }
    out.base_color = diffuse;
    if (max3(specular) > 0.0f && illum != 1) {
        out.kind = material_mix;
        out.specular = specular;
        out.alpha = is_reflecting(illum) ? 0.0f : alpha_of(m);
    }
    const float sum = max3(out.base_color + out.specular);
    if (sum > 1.0f) out.base_color /= sum, out.specular /= sum;
    return out;
}

} // namespace snell::obj
