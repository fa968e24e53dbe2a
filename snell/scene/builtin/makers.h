// The built-in scenes of fixed size, one file each. The parametric ones are declared in scene/builtin.h.
#pragma once

#include "snell/scene/scene.h"

#include <string>

namespace snell {

Scene make_cornell();
Scene make_whitted();
Scene make_spheres();
Scene make_veach_mis();
Scene make_grid();

// Short forms for materials.
inline MaterialDesc diffuse(std::string name, vec3 color)
{
    MaterialDesc m;
    m.name = std::move(name);
    m.base_color = color;
    return m;
}

inline MaterialDesc emitter(std::string name, vec3 radiance)
{
    MaterialDesc m = diffuse(std::move(name), vec3(0.0f));
    m.emission = radiance;
    return m;
}

inline MaterialDesc mirror(std::string name, vec3 reflectance)
{
    MaterialDesc m = diffuse(std::move(name), reflectance);
    m.kind = material_mirror;
    return m;
}

inline MaterialDesc mix_of(std::string name, vec3 color, vec3 specular, float alpha)
{
    MaterialDesc m = diffuse(std::move(name), color);
    m.kind = material_mix;
    m.specular = specular;
    m.alpha = alpha;
    return m;
}

inline MaterialDesc glass(std::string name, float ior, float alpha = 0.0f, vec3 absorption = vec3(0.0f))
{
    MaterialDesc m = diffuse(std::move(name), vec3(1.0f));
    m.kind = material_dielectric;
    m.ior = ior;
    m.alpha = alpha;
    m.absorption = absorption;
    return m;
}

inline MaterialDesc metal(std::string name, vec3 eta, vec3 k, float alpha)
{
    MaterialDesc m = diffuse(std::move(name), vec3(1.0f));
    m.kind = material_conductor;
    m.specular = eta;
    m.absorption = k;
    m.alpha = alpha;
    return m;
}

// Optical constants of metals at about 650, 550 and 450 nm (Johnson and Christy 1972).
inline constexpr vec3 gold_eta{0.143f, 0.375f, 1.442f}, gold_k{3.983f, 2.386f, 1.603f};
inline constexpr vec3 copper_eta{0.200f, 0.924f, 1.102f}, copper_k{3.912f, 2.452f, 2.142f};

} // namespace snell
