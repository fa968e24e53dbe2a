// Lens systems: a double Gauss of 50 mm in focus at two metres.
#ifndef TWIN_CASES
#include "tests/gpu/draw.h"
#else

TWIN(no_lens, 0.0f, 0.0f, 0.0f)
{
    give_lens_system(no_lens());
}
TWIN(lens_interface, 0.0f, 0.0f, 0.0f)
{
    uint i = index_below(scene_lens_interfaces);
    LensInterface face = lens_interface(twin_lens(scene), i);
    give(face.z);
    give(face.radius);
    give(face.eta);
    give(face.aperture);
}
TWIN(lens_pupil, 0.0f, 0.0f, 0.0f)
{
    uint ring = index_below(scene_lens_pupils);
    give(lens_pupil(twin_lens(scene), ring));
}
TWIN(cross_lens_interface, 1e-4f, 1e-3f, 0.003f) // rays at the rim of an aperture, or of total reflection
{
    LensRay ray;
    ray.origin = point(4.0f);
    vec3 to = point(4.0f);
    to.z = 30.0f;
    ray.direction = normalize(to - ray.origin);
    ray.weight = 1.0f;
    uint backwards = index_below(2u);
    if (backwards == 1u) {
        ray.origin.z = 40.0f - ray.origin.z;
        ray.direction.z = -ray.direction.z;
    }
    LensInterface face;
    face.z = range(15.0f, 25.0f);
    face.radius = range(-40.0f, 40.0f);
    uint flat_one = index_below(4u);
    if (flat_one == 0u) face.radius = 0.0f;
    face.eta = 1.0f;
    face.aperture = range(1.0f, 8.0f);
    float eta_from = range(1.0f, 1.8f);
    float eta_to = range(1.0f, 1.8f);
    give_lens_ray(cross_lens_interface(ray, face, eta_from, eta_to));
}
TWIN(sample_lens, 1e-3f, 1e-3f, 0.003f)
{
    vec2 film = point2(15.0f);
    vec2 u = unit2();
    give_lens_ray(sample_lens(twin_lens(scene), film, u));
}
TWIN(trace_lens_to_scene, 1e-3f, 1e-3f, 0.003f)
{
    LensSystem lens = twin_lens(scene);
    vec2 film = point2(10.0f);
    vec2 to = point2(9.0f);
    LensRay ray;
    ray.origin = vec3(film.x, film.y, 0.0f);
    ray.direction = normalize(vec3(to.x, to.y, lens.rear_z) - ray.origin);
    ray.weight = 1.0f;
    give_lens_ray(trace_lens_to_scene(lens, ray));
}
TWIN(trace_lens_to_film, 1e-3f, 1e-3f, 0.003f)
{
    LensSystem lens = twin_lens(scene);
    vec2 from = point2(300.0f);
    vec2 to = point2(10.0f);
    LensRay ray;
    ray.origin = vec3(from.x, from.y, 1000.0f);
    ray.direction = normalize(vec3(to.x, to.y, lens.entrance_z) - ray.origin);
    ray.weight = 1.0f;
    give_lens_ray(trace_lens_to_film(lens, ray));
}
TWIN(lens_chief_ray, 1e-3f, 1e-3f, 0.003f)
{
    float r = range(0.0f, 21.6f);
    give_lens_ray(lens_chief_ray(twin_lens(scene), r));
}
TWIN_BUILTIN(lens_film_radius, 1e-3f, 1e-2f, 0.003f)
{
    float aside = range(0.0f, 700.0f);
    float z = range(1000.0f, 3000.0f);
    give(lens_film_radius(twin_lens(scene), aside, z));
}

#endif
