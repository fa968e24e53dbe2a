// Orthonormal frames around a normal.
#ifndef SNELL_KERNEL_FRAME_H
#define SNELL_KERNEL_FRAME_H
#include "snell/kernel/lang.h"
SNELL_BEGIN

struct Frame
{
    vec3 s, t, n; // right-handed, unit length
};

// Duff et al. 2017, Building an Orthonormal Basis, Revisited. n has unit length.
SNELL_FN Frame make_frame(vec3 n)
{
    float s = n.z < 0.0f ? -1.0f : 1.0f;
    float a = -1.0f / (s + n.z);
    float b = n.x * n.y * a;
    Frame frame;
    frame.s = vec3(1.0f + s * n.x * n.x * a, s * b, -s * n.x);
    frame.t = vec3(b, s + n.y * n.y * a, -n.y);
    frame.n = n;
    return frame;
}

SNELL_FN vec3 to_local(Frame frame, vec3 v)
{
    return vec3(dot(v, frame.s), dot(v, frame.t), dot(v, frame.n));
}
SNELL_FN vec3 to_world(Frame frame, vec3 v)
{
    return v.x * frame.s + v.y * frame.t + v.z * frame.n;
}

SNELL_END
#endif
