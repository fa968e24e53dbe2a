// Cameras.
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
TWIN(sample_aperture, 1e-6f, 1e-6f, 0.0f)
{
    uint blades = index_below(12u);
    float turn = unit();
    vec2 u = unit2();
    give(sample_aperture(blades, turn, u));
}
TWIN(camera_ray_through, 1e-4f, 1e-4f, 0.002f) // near the edge of the picture's circle one side may see nothing
{
    RenderParams params = draw_params();
    Camera camera = draw_camera_model(params.camera);
    vec2 u = unit2();
    vec2 lens = unit2();
    uint channel = index_below(3u);
    give(camera_ray_through(camera, vec2(u.x * camera.width, u.y * camera.height), lens, channel));
}
TWIN(camera_project_eye, 1e-4f, 1e-2f, 0.005f)
{
    RenderParams params = draw_params();
    Camera camera = draw_camera_model(params.camera);
    vec3 p = point(8.0f);
    uint eye = camera.model == camera_hmd ? index_below(2u) : 0u;
    uint channel = index_below(3u);
    give(camera_project_eye(camera, p, eye, channel));
}

#endif
