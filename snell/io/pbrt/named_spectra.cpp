#include "snell/io/pbrt/named_spectra.h"

#include "snell/io/pbrt/color.h"

namespace snell::pbrt {
namespace {

// Refractive indices near 630, 532 and 465 nm. Silver, gold, copper: Johnson and Christy 1972; aluminium: Rakic 1995;
// brass: Querry 1985; magnesia: Stephens and Malitson 1952; rutile, ordinary ray: DeVore 1951.
struct NamedMetal
{
    std::string_view name;
    vec3 eta, k;
};
constexpr int metal_count = 7;
const NamedMetal metals[metal_count] = {
    {"Ag", {0.155f, 0.117f, 0.138f}, {4.83f, 3.12f, 2.15f}},  {"Al", {1.66f, 0.880f, 0.521f}, {9.22f, 6.27f, 4.84f}},
    {"Au", {0.143f, 0.375f, 1.44f}, {3.98f, 2.39f, 1.60f}},   {"Cu", {0.200f, 0.924f, 1.10f}, {3.91f, 2.45f, 2.14f}},
    {"CuZn", {0.444f, 0.527f, 1.09f}, {3.70f, 2.77f, 1.83f}}, {"MgO", {1.73f, 1.74f, 1.75f}, {0.0f, 0.0f, 0.0f}},
    {"TiO2", {2.57f, 2.65f, 2.81f}, {0.0f, 0.0f, 0.0f}}};

// Indices at the d line, from the makers' data sheets. pbrt calls SF5, SF10 and SF11 F5, F10 and F11.
struct NamedGlass
{
    std::string_view name;
    float index;
};
const NamedGlass glasses[] = {{"BK7", 1.5168f}, {"BAF10", 1.6700f}, {"FK51A", 1.4866f}, {"LASF9", 1.8503f},
                              {"F5", 1.6727f},  {"SF5", 1.6727f},   {"F10", 1.7283f},   {"SF10", 1.7283f},
                              {"F11", 1.7847f}, {"SF11", 1.7847f}};

// Chromaticities of the CIE's standard illuminants (CIE 15, 2-degree observer).
struct NamedLight
{
    std::string_view name;
    double x, y;
};
const NamedLight lights[] = {
    {"stdillum-A", 0.44757, 0.40745},   {"stdillum-D50", 0.34567, 0.35850}, {"stdillum-D65", 0.3127, 0.3290},
    {"stdillum-F1", 0.3131, 0.3371},    {"stdillum-F2", 0.3721, 0.3751},    {"stdillum-F3", 0.4091, 0.3941},
    {"stdillum-F4", 0.4402, 0.4031},    {"stdillum-F5", 0.3138, 0.3452},    {"stdillum-F6", 0.3779, 0.3882},
    {"stdillum-F7", 0.3129, 0.3292},    {"stdillum-F8", 0.3458, 0.3586},    {"stdillum-F9", 0.3741, 0.3727},
    {"stdillum-F10", 0.3458, 0.3588},   {"stdillum-F11", 0.3805, 0.3769},   {"stdillum-F12", 0.4370, 0.4042},
    {"illum-acesD60", 0.32168, 0.33767}};

} // namespace

std::optional<NamedSpectrum> find_named_spectrum(std::string_view name)
{
    for (const NamedLight& light : lights)
        if (name == light.name) return NamedSpectrum{vec3(rec709_from_xyz(xyz_of(light.x, light.y))), true};
    if (name.starts_with("glass-"))
        for (const NamedGlass& glass : glasses)
            if (name.substr(6) == glass.name) return NamedSpectrum{vec3(glass.index)};
    if (name.starts_with("metal-")) {
        name.remove_prefix(6);
        const bool is_eta = name.ends_with("-eta"), is_k = name.ends_with("-k");
        if (!is_eta && !is_k) return {};
        name.remove_suffix(is_eta ? 4 : 2);
        for (const NamedMetal& metal : metals)
            if (name == metal.name) return NamedSpectrum{is_eta ? metal.eta : metal.k};
    }
    return {};
}

} // namespace snell::pbrt
