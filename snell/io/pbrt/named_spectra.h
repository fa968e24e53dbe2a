// The spectra that pbrt-v4 knows by name, as few numbers.
#pragma once

#include "snell/core/vec.h"

#include <optional>
#include <string_view>

namespace snell::pbrt {

struct NamedSpectrum
{
    vec3 rgb; // eta or k of a metal, index of a glass, or a light's colour of luminance 1
    bool is_light = false;
};

// "metal-Cu-eta", "glass-BK7", "stdillum-D65", ...; empty for unknown names.
std::optional<NamedSpectrum> find_named_spectrum(std::string_view name);

} // namespace snell::pbrt
