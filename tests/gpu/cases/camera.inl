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
TWIN_BUILTIN(camera_ray_through, 1e-3f, 1e-3f, 0.001f) // near the edge of the picture's circle one side may see nothing
{
    RenderParams params = draw_params();
    Camera camera = draw_camera_model(scene, params.camera);
    vec2 u = unit2();
    vec2 lens = unit2();
    uint channel = index_below(3u);
    Ray ray = camera_ray_through(camera, vec2(u.x * camera.width, u.y * camera.height), lens, channel);
    give(camera_sees(ray));
    if (camera_sees(ray)) give(ray);
    give(camera_eye(camera, u.x * camera.width));
    give(camera_has_lens(camera));
    give(camera_disperses(camera));
}
TWIN_BUILTIN(sample_camera, 1e-3f, 1e-3f, 0.001f)
{
    RenderParams params = draw_params();
    Camera camera = draw_camera_model(scene, params.camera);
    vec2 at = unit2();
    vec2 u = unit2();
    uint channel = index_below(3u);
    CameraSample s = sample_camera(camera, vec2(at.x * camera.width, at.y * camera.height), u, channel);
    give(s.weight);
    if (s.weight > 0.0f) give(s.ray);
}
TWIN_BUILTIN(camera_project_eye, 1e-3f, 2e-2f, 0.001f)
{
    RenderParams params = draw_params();
    Camera camera = draw_camera_model(scene, params.camera);
    vec3 p = point(8.0f);
    uint eye = index_below(2u);
    if (camera.model != camera_hmd) eye = 0u;
    uint channel = index_below(3u);
    give(camera_project_eye(camera, p, eye, channel));
}
TWIN_BUILTIN(camera_lens, 1e-3f, 2e-2f, 0.001f) // the parts that the model "lens" is made of; a lens sees points before it
{
    RenderParams params = draw_params();
    Camera camera = params.camera;
    camera.model = camera_lens;
    camera.right = normalize(camera.right);
    camera.up = normalize(camera.up);
    camera.focal = vec2(20.0f, 20.0f);
    camera.lens = twin_lens(scene);
    vec2 u = unit2();
    vec2 film = camera_film_point(camera, vec2(u.x * camera.width, u.y * camera.height));
    give(film);
    vec2 near = point2(12.0f);
    LensRay chief = camera_chief_ray(camera, near);
    give_lens_ray(chief);
    Ray ray = camera_ray_of_lens(camera, chief);
    give(camera_sees(ray));
    if (camera_sees(ray)) give(ray);
    vec2 aside = point2(0.3f);
    vec3 d = camera.forward + aside.x * camera.right + aside.y * camera.up;
    float way = range(0.5f, 4.0f);
    give(camera_find_in_lens(camera, way * d));
}
TWIN_BUILTIN(camera_look, 1e-3f, 1e-3f, 0.001f)
{
    RenderParams params = draw_params();
    Camera camera = draw_camera_model(scene, params.camera);
    uint which = index_below(7u);
    camera.model = camera_equirectangular + which;
    vec2 u = unit2();
    uint channel = index_below(3u);
    give(camera_look(camera, vec2(u.x * camera.width, u.y * camera.height), channel));
    vec3 to = direction();
    give(camera_find(camera, to, channel));
    vec4 kannala = kannala_of(camera);
    give(kannala);
    give(hmd_of(camera, channel));
    BrownConrady b = brown_of(camera);
    give(vec4(b.k1, b.k2, b.k3, b.k4));
    give(vec4(b.k5, b.k6, b.p1, b.p2));
}
TWIN(one_color, 0.0f, 0.0f, 0.0f)
{
    uint channel = index_below(3u);
    give(one_color(channel));
}

#endif
