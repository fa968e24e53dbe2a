// The aperture of a thin lens.
#ifndef SNELL_KERNEL_CAMERA_LENS_H
#define SNELL_KERNEL_CAMERA_LENS_H
#include "snell/kernel/warp.h"
SNELL_BEGIN

// A point of the aperture, uniform by area, in radii from its centre: of the disk (blades < 3), or of the regular
// polygon with that many corners on its rim. turn: of the first corner from +x, in full turns counter-clockwise, in
// [0, 1).
SNELL_FN vec2 sample_aperture(uint blades, float turn, vec2 u)
{
    if (blades < 3u) return sample_disk(u);
    float n = float(blades);
    float piece = min(floor(u.x * n), n - 1.0f); // one of the triangles around the centre
    float across = u.x * n - piece;
    float along = sqrt(u.y); // uniform in the triangle: its width grows with the distance from the centre
    vec2 a = unit_circle(fract(piece / n + turn));
    vec2 b = unit_circle(fract((piece + 1.0f) / n + turn));
    return along * (a + across * (b - a));
}

SNELL_END
#endif
