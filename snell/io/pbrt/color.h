// Colours: the CIE 1931 observer, and the spaces of RGB values that a file may choose.
#pragma once

#include "snell/core/vec.h"

#include <string_view>

namespace snell::pbrt {

// The CIE 1931 2-degree matching functions at a wavelength in nanometres, by the fits of Wyman, Sloan and Shirley 2013
// (Simple Analytic Approximations to the CIE XYZ Color Matching Functions, JCGT 2(2), multi-lobe).
glm::dvec3 cie_1931(double nanometres);

// CIE XYZ, with Y 1 for white, to linear Rec.709.
glm::dvec3 rec709_from_xyz(glm::dvec3 xyz);

// X/Y, 1, Z/Y of a chromaticity.
glm::dvec3 xyz_of(double x, double y);

// An RGB space, given as the maps to linear Rec.709.
struct ColorSpace
{
    mat3 light{1.0f};       // of lights: the space's white keeps its own colour
    mat3 reflectance{1.0f}; // of reflectances: white stays white
};

// "srgb", "rec2020", "aces2065-1" or "dci-p3", in any case; null for others.
const ColorSpace* find_color_space(std::string_view name);

} // namespace snell::pbrt
