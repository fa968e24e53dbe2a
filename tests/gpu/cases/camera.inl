// The pinhole camera.
#ifndef TWIN_CASES
#include "tests/gpu/draw.h"
#else

TWIN(make_pinhole, 1e-5f, 1e-5f, 0.0f)
{
    RenderParams params = draw_params();
    give_camera(params.camera);
}
TWIN(camera_ray, 1e-5f, 1e-5f, 0.0f)
{
    RenderParams params = draw_params();
    vec2 u = unit2();
    give(camera_ray(params.camera, vec2(u.x * float(params.width), u.y * float(params.height))));
}
TWIN(camera_project, 1e-4f, 1e-2f, 0.001f) // in pixels; points near the plane of the lens fly off
{
    RenderParams params = draw_params();
    vec3 p = point(8.0f);
    give(camera_project(params.camera, p));
}

#endif
