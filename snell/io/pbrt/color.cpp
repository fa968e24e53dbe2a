#include "snell/io/pbrt/color.h"

#include <array>
#include <cmath>
#include <string>

namespace snell::pbrt {
namespace {

double lobe(double x, double center, double left, double right)
{
    const double t = (x - center) / (x < center ? left : right);
    return std::exp(-0.5 * t * t);
}

// The map from an RGB space to XYZ that its primaries and its white define.
glm::dmat3 xyz_from_rgb(glm::dvec2 red, glm::dvec2 green, glm::dvec2 blue, glm::dvec2 white)
{
    const glm::dmat3 primaries(xyz_of(red.x, red.y), xyz_of(green.x, green.y), xyz_of(blue.x, blue.y));
    const glm::dvec3 strengths = glm::inverse(primaries) * xyz_of(white.x, white.y);
    return {primaries[0] * strengths.x, primaries[1] * strengths.y, primaries[2] * strengths.z};
}

constexpr glm::dvec2 d65{0.3127, 0.3290};

const glm::dmat3& rec709()
{
    static const glm::dmat3 to_xyz = xyz_from_rgb({0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}, d65);
    static const glm::dmat3 from_xyz = glm::inverse(to_xyz);
    return from_xyz;
}

ColorSpace make_space(glm::dvec2 red, glm::dvec2 green, glm::dvec2 blue, glm::dvec2 white)
{
    const glm::dmat3 light = rec709() * xyz_from_rgb(red, green, blue, white);
    const glm::dvec3 white_there = light * glm::dvec3(1.0);
    glm::dmat3 reflectance = light;
    for (int column = 0; column < 3; ++column) reflectance[column] /= white_there;
    return {mat3(light), mat3(reflectance)};
}

} // namespace

glm::dvec3 cie_1931(double nm)
{
    return {1.056 * lobe(nm, 599.8, 37.9, 31.0) + 0.362 * lobe(nm, 442.0, 16.0, 26.7) -
                0.065 * lobe(nm, 501.1, 20.4, 26.2),
            0.821 * lobe(nm, 568.8, 46.9, 40.5) + 0.286 * lobe(nm, 530.9, 16.3, 31.1),
            1.217 * lobe(nm, 437.0, 11.8, 36.0) + 0.681 * lobe(nm, 459.0, 26.0, 13.8)};
}

glm::dvec3 rec709_from_xyz(glm::dvec3 xyz)
{
    return rec709() * xyz;
}

glm::dvec3 xyz_of(double x, double y)
{
    return {x / y, 1.0, (1.0 - x - y) / y};
}

const ColorSpace* find_color_space(std::string_view name)
{
    static const ColorSpace srgb;
    static const ColorSpace rec2020 = make_space({0.708, 0.292}, {0.170, 0.797}, {0.131, 0.046}, d65);
    static const ColorSpace p3 = make_space({0.680, 0.320}, {0.265, 0.690}, {0.150, 0.060}, d65);
    static const ColorSpace aces = make_space({0.7347, 0.2653}, {0.0, 1.0}, {0.0001, -0.0770}, {0.32168, 0.33767});
    std::string lower;
    for (const char c : name.substr(0, 20)) lower += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    if (lower == "srgb") return &srgb;
    if (lower == "rec2020") return &rec2020;
    if (lower == "dci-p3") return &p3;
    if (lower == "aces2065-1") return &aces;
    return nullptr;
}

} // namespace snell::pbrt
