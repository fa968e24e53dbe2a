// Photographic lenses: their glass as patents list it, focused on a distance and made ready for kernels.
#pragma once

#include "snell/kernel/lens_system.h"

#include <string>
#include <vector>

namespace snell {

// A line of a lens prescription; lengths in millimetres.
struct LensSurface
{
    float radius = 0.0f;    // of curvature, > 0 if convex towards the scene; 0: a plane, as the aperture stop is
    float thickness = 0.0f; // to the next surface; behind the last one: to the film, when focused at infinity
    float eta = 1.0f;       // index of refraction behind it; at most 4
    float diameter = 0.0f;  // that lets light pass
    bool operator==(const LensSurface&) const = default;
};

// From the scene to the film. There is one stop: the first surface of radius 0 between equal indices.
struct LensPrescription
{
    std::string name;
    std::vector<LensSurface> surfaces;
    bool operator==(const LensPrescription&) const = default;
};

// Of rays near the axis, by ray transfer matrices (Kogelnik and Li 1966); all from the front vertex, towards the film.
struct Cardinal
{
    double focal_length = 0;    // < 0: the lens diverges; infinite: it has none
    double back_focus = 0;      // from the rear vertex to where parallel light meets
    double length = 0;          // from front to rear vertex
    double entrance_pupil = 0;  // where the stop is seen to be from the scene
    double entrance_radius = 0; // and how large
    double f_number() const;    // focal length over the entrance pupil's diameter
};

Cardinal cardinal(const LensPrescription& lens);

// Of the aperture stop, fully open: millimetres.
float stop_diameter(const LensPrescription& lens);

// Where the film must be, behind the rear vertex, for what lies at `distance` from the entrance pupil to be sharp near
// the axis. Infinity is a distance. Throws Error if no place behind the lens makes it sharp.
double focused_film_distance(const LensPrescription& lens, double distance);

// A lens in focus. Kernels read it through view(), as long as it lives.
struct FocusedLens
{
    std::string name;
    std::vector<vec4> table; // LensSystem::table
    LensSystem system{};     // but for the address of the table

    LensSystem view() const;
};

// distance: as above, in millimetres. film_diagonal > 0. stop_diameter: of the aperture stop, 0: as wide as it is.
// unit: a millimetre in the scene's lengths. Throws Error if the lens cannot be focused so, or if no light arrives in
// the middle of the film.
FocusedLens focus_lens(const LensPrescription& lens, double distance, double film_diagonal, double stop_diameter = 0,
                       double unit = 0.001);

// The lenses that come with snell: "double-gauss" and "fisheye" (also in lenses/*.txt). Null if there is none such.
const LensPrescription* find_lens(const std::string& name);
const std::vector<LensPrescription>& known_lenses();

} // namespace snell
