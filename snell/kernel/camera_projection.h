// How lenses map angles to their picture plane: theta from the axis, r from the centre in focal lengths (or in the
// units of the model). Angles that are negative, and radii that are, mean "none".
#ifndef SNELL_KERNEL_CAMERA_PROJECTION_H
#define SNELL_KERNEL_CAMERA_PROJECTION_H
#include "snell/kernel/lang.h"
SNELL_BEGIN

// asin(x) for x in [0, 1]. GLSL's own may be off by 1e-3.
SNELL_FN float arc_sine(float x)
{
    return atan(x, safe_sqrt((1.0f - x) * (1.0f + x)));
}

// Fisheyes (Miyamoto 1964, Fish Eye Lens).
SNELL_FN float equidistant_angle(float r)
{
    return r <= pi ? r : -1.0f;
}
SNELL_FN float equisolid_angle(float r)
{
    return r <= 2.0f ? 2.0f * arc_sine(0.5f * r) : -1.0f;
}
SNELL_FN float stereographic_angle(float r)
{
    return 2.0f * atan(0.5f * r);
}
// Straight back is infinitely far out.
SNELL_FN float stereographic_radius(float theta)
{
    return theta < 3.1415f ? 2.0f * tan(0.5f * theta) : -1.0f;
}
SNELL_FN float fisheye_orthographic_angle(float r)
{
    return r <= 1.0f ? arc_sine(r) : -1.0f;
}
SNELL_FN float fisheye_orthographic_radius(float theta)
{
    return theta <= 0.5f * pi ? sin(theta) : -1.0f;
}

// Solves p(x) = y for a p that grows from p(0) = 0, by Newton's method from x = y: p(x) = x (1 + k.x x^2 + k.y x^4 +
// k.z x^6 + k.w x^8). -1: there is none up to `largest`, or p no longer grows there.
SNELL_FN_COLD float invert_odd_polynomial(vec4 k, float y, float largest)
{
    float x = min(y, largest);
    for (uint i = 0u; i < 20u; ++i) {
        float q = x * x;
        float p = x * (1.0f + q * (k.x + q * (k.y + q * (k.z + q * k.w))));
        float slope = 1.0f + q * (3.0f * k.x + q * (5.0f * k.y + q * (7.0f * k.z + q * 9.0f * k.w)));
        if (!(slope > 0.0f)) {
            x = 0.5f * x; // beyond the turn: back to where it grows
            continue;
        }
        float step = (p - y) / slope;
        x = clamp(x - step, 0.0f, largest);
        if (abs(step) < 1e-7f * (1.0f + x)) break;
    }
    float q = x * x;
    float p = x * (1.0f + q * (k.x + q * (k.y + q * (k.z + q * k.w))));
    float slope = 1.0f + q * (3.0f * k.x + q * (5.0f * k.y + q * (7.0f * k.z + q * 9.0f * k.w)));
    return slope > 0.0f && abs(p - y) <= 1e-5f * (1.0f + y) ? x : -1.0f;
}

// p(x) of invert_odd_polynomial where p grows all the way from 0 to x; else -1. Looked at in 16 places.
SNELL_FN_COLD float odd_polynomial(vec4 k, float x)
{
    for (uint i = 1u; i <= 16u; ++i) {
        float t = x * (float(i) / 16.0f);
        float q = t * t;
        if (!(1.0f + q * (3.0f * k.x + q * (5.0f * k.y + q * (7.0f * k.z + q * 9.0f * k.w))) > 0.0f)) return -1.0f;
    }
    float q = x * x;
    return x * (1.0f + q * (k.x + q * (k.y + q * (k.z + q * k.w))));
}

// Kannala and Brandt 2006 (A Generic Camera Model), as OpenCV's fisheye module has it: r = theta (1 + k1 theta^2 + k2
// theta^4 + k3 theta^6 + k4 theta^8).
SNELL_FN float kannala_brandt_angle(vec4 k, float r)
{
    return invert_odd_polynomial(k, r, pi);
}
SNELL_FN float kannala_brandt_radius(vec4 k, float theta)
{
    return odd_polynomial(k, theta);
}

// The lens of a head-mounted display magnifies its screen the more the farther out: what the screen shows at r appears
// at tan(theta) = r (1 + k1 r^2 + k2 r^4 + k3 r^6). Drawn in this way, the picture is distorted against the lens.
SNELL_FN float hmd_angle(vec3 k, float r)
{
    float t = odd_polynomial(vec4(k.x, k.y, k.z, 0.0f), r);
    return t < 0.0f ? -1.0f : atan(t);
}
SNELL_FN float hmd_radius(vec3 k, float theta)
{
    if (!(theta < 1.5707f)) return -1.0f;
    return invert_odd_polynomial(vec4(k.x, k.y, k.z, 0.0f), tan(theta), 100.0f);
}

// Brown 1966 (Decentering Distortion of Lenses) and Conrady 1919, with the rational terms of OpenCV. Its y points down.
struct BrownConrady
{
    float k1, k2, k3, k4, k5, k6, p1, p2;
};

// Where a point m of the undistorted picture plane (y up) lies in the distorted one.
SNELL_FN vec2 brown_conrady_point(BrownConrady b, vec2 m)
{
    float x = m.x;
    float y = -m.y;
    float q = x * x + y * y;
    float radial = (1.0f + q * (b.k1 + q * (b.k2 + q * b.k3))) / (1.0f + q * (b.k4 + q * (b.k5 + q * b.k6)));
    float u = x * radial + 2.0f * b.p1 * x * y + b.p2 * (q + 2.0f * x * x);
    float v = y * radial + b.p1 * (q + 2.0f * y * y) + 2.0f * b.p2 * x * y;
    return vec2(u, -v);
}

// Whether the radial part turns back between the centre and m: what lies beyond would be seen twice. Looked at in 16
// places.
SNELL_FN_COLD bool brown_conrady_folds(BrownConrady b, vec2 m)
{
    float before = 0.0f;
    for (uint i = 1u; i <= 16u; ++i) {
        float t = float(i) / 16.0f;
        float q = t * t * (m.x * m.x + m.y * m.y);
        float radial = t * (1.0f + q * (b.k1 + q * (b.k2 + q * b.k3))) / (1.0f + q * (b.k4 + q * (b.k5 + q * b.k6)));
        if (!(radial > before)) return true;
        before = radial;
    }
    return false;
}

// The inverse, by Newton's method with differences; the direction with unit length. (0, 0, 0): there is none, or the
// picture is folded there.
SNELL_FN_COLD vec3 brown_conrady_look(BrownConrady b, vec2 point)
{
    vec2 m = point;
    float det = 1.0f;
    vec2 miss = vec2(0.0f, 0.0f);
    for (uint i = 0u; i < 12u; ++i) {
        vec2 at = brown_conrady_point(b, m);
        miss = at - point;
        float h = 1e-3f * (1.0f + abs(m.x) + abs(m.y));
        vec2 dx = (brown_conrady_point(b, vec2(m.x + h, m.y)) - at) / h;
        vec2 dy = (brown_conrady_point(b, vec2(m.x, m.y + h)) - at) / h;
        det = dx.x * dy.y - dx.y * dy.x;
        if (!(det > 1e-6f)) return vec3(0.0f);
        m = m - vec2(dy.y * miss.x - dy.x * miss.y, dx.x * miss.y - dx.y * miss.x) / det;
    }
    miss = brown_conrady_point(b, m) - point;
    if (!(abs(miss.x) + abs(miss.y) < 1e-5f * (1.0f + length(point)))) return vec3(0.0f);
    return brown_conrady_folds(b, m) ? vec3(0.0f) : normalize(vec3(m.x, m.y, 1.0f));
}

SNELL_END
#endif
