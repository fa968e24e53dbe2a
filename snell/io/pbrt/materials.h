// Helpers that the materials of pbrt-v4, those of v3 and ours share.
#pragma once

#include "snell/io/pbrt/loader.h"

namespace snell::pbrt {

// One material while it is made: its loader, its parameters and what comes out.
struct Making
{
    Loader& loader;
    const ParameterList& parameters;
    MaterialEntry& entry;
    std::string type;

    MaterialDesc& desc() { return entry.desc; }
    // A colour or number that may be a texture.
    TextureValue color(std::string_view name, vec3 otherwise);
    TextureValue number(std::string_view name, float otherwise);
    // The same where no texture can be had: its mean, with a note.
    vec3 plain_color(std::string_view name, vec3 otherwise);
    float plain_number(std::string_view name, float otherwise);
    // An index of refraction: a number, or a spectrum at the d line.
    float index(std::string_view name, float otherwise);
    // eta and k, or reflectance, as a metal.
    Metal metal(const std::string& prefix, std::string_view default_name);

    void warn(const std::string& key, const std::string& text);
    void inform(const std::string& key, const std::string& text);
};

// How rough a surface is, along u and v, as GGX alphas; below 0.001 it is smooth.
struct Roughness
{
    float u = 0.0f, v = 0.0f;
    std::optional<TextureValue> texture; // of alpha itself; the numbers are its means

    bool is_even() const;
    float alpha() const; // of both directions
};
// prefix: "", "interface." or "conductor.".
Roughness read_roughness(Making& making, const std::string& prefix, float otherwise);

void set_base(MaterialDesc& desc, const TextureValue& value);
// Alpha, or where the roughness varies or has a direction, the principled model's.
void set_principled_roughness(Making& making, const Roughness& roughness);

// The reflectance of a metal at normal incidence.
vec3 normal_reflectance(const Metal& metal);

// A copy of a texture with a function applied to its values.
TextureValue map_texture(Loader& loader, const TextureValue& value, float (*f)(float));

// False if the type is none of theirs.
bool make_material_v3(Making& making);
bool make_own_material(Making& making);
// Ours that any material may have: emission, opacity, normal.
void read_common_parameters(Making& making);

// A surface that is `amount` of b and the rest of a. amount: a texture.
void mix_materials(Making& making, const MaterialEntry& a, const MaterialEntry& b, const TextureValue& amount);

} // namespace snell::pbrt
