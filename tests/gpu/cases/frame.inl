// Frames and affine maps.
#ifndef TWIN_CASES
#include "snell/kernel/frame.h"
#include "snell/kernel/scene_view.h"
SNELL_BEGIN
SNELL_FN_COLD vec4 draw_row()
{
    vec3 v = point(4.0f);
    float w = range(-10.0f, 10.0f);
    return vec4(v, w);
}
SNELL_END
#else

TWIN(make_frame, 1e-5f, 1e-6f, 0.0f)
{
    vec3 n = direction();
    Frame frame = make_frame(n);
    give(frame.s);
    give(frame.t);
    give(frame.n);
}
TWIN(to_local, 1e-5f, 1e-6f, 0.0f)
{
    vec3 n = direction();
    vec3 v = direction();
    give(to_local(make_frame(n), v));
    give(to_world(make_frame(n), v));
}
TWIN(transform, 1e-6f, 1e-5f, 0.0f) // terms up to 16 cancel
{
    Transform m;
    m.x = draw_row();
    m.y = draw_row();
    m.z = draw_row();
    vec3 p = point(4.0f);
    give(transform_point(m, p));
    give(transform_vector(m, p));
    give(transform_normal(m, p));
}

#endif
