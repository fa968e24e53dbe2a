// Cameras measured: what they do to angles, how exactly their inverse undoes it, how lenses darken the corners.
#pragma once

#include "snell/kernel/camera.h"
#include "snell/scene/lens.h"

#include <optional>
#include <vector>

namespace snell {

struct CurvePoint
{
    float radius = 0;           // pixels from where the axis meets the picture
    std::optional<float> angle; // degrees between the ray there and the axis; empty: the picture sees nothing there
};

// The distortion curve: `count` points (at least 2), evenly from the axis towards the lower right corner. Orthographic
// cameras have an angle of 0 everywhere.
std::vector<CurvePoint> distortion_curve(const Camera& camera, int count);

// Full angles in degrees, measured by rays: from the left edge over the axis to the right one, likewise down and
// across. Where the picture sees nothing at its edge, to the last point where it does.
struct FieldOfView
{
    float horizontal = 0, vertical = 0, diagonal = 0;
};
FieldOfView field_of_view(const Camera& camera);

// Pixel to ray to point to pixel, over a grid of the picture and points at several distances.
struct RoundTrip
{
    float worst = 0;          // pixels
    float mean = 0;           // pixels
    std::size_t points = 0;   // that were compared
    std::size_t lost = 0;     // that the inverse did not find
    std::size_t unseeing = 0; // places of the grid where the picture sees nothing
};

// side > 0: of the grid. size: of the scene; the points lie one to a hundred times as far away. (Nearer ones would
// measure how points are rounded, not the camera.)
RoundTrip round_trip(const Camera& camera, int side, float size);

// Along the way of distortion_curve(): radius and worst error of each point, both in pixels. Points that see nothing or
// are not found are left out.
std::vector<vec2> round_trip_curve(const Camera& camera, int count, float size);

// What the film of a lens gets from surroundings of radiance 1, against the middle of the film.
struct VignettingPoint
{
    float radius = 0;           // on the film, millimetres
    std::optional<float> angle; // degrees, of the chief ray in the scene; empty: it is blocked
    float light = 0;            // mean weight of the samples
    float cos4 = 0;             // what a small pupil at the same distance would leave of it
};

// `count` points (at least 2) from the axis to the corner, `side` times `side` rays each.
std::vector<VignettingPoint> vignetting(const LensSystem& lens, int count, int side = 64);

} // namespace snell
