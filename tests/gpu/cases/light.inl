// Light sources.
#ifndef TWIN_CASES
#include "tests/gpu/draw.h"
#else

TWIN(no_light_sample, 0.0f, 0.0f, 0.0f)
{
    LightSample s = no_light_sample();
    give(s.direction);
    give(s.radiance);
    give(s.target);
    give(s.pdf);
    give(s.is_delta);
    give(s.is_infinite);
}
TWIN(spot_falloff, 1e-4f, 1e-5f, 0.0f)
{
    float cosine = range(-1.0f, 1.0f);
    Light light = scene.lights.at[2];
    give(spot_falloff(light, cosine));
}
TWIN(sphere_cone, 1e-4f, 0.0f, 0.001f) // near the sphere
{
    uint i = 14u + index_below(6u);
    vec3 p = point(4.0f);
    give(sphere_cone(scene.lights.at[i], p));
}
TWIN(sample_point_light, 1e-4f, 1e-5f, 0.001f) // at the rim of the spot
{
    uint i = index_below(6u);
    vec3 p = point(4.0f);
    if (scene.lights.at[i].kind == light_directional) give_light_sample(sample_directional_light(scene.lights.at[i]));
    if (scene.lights.at[i].kind != light_directional) give_light_sample(sample_point_light(scene.lights.at[i], p));
}
TWIN(sample_triangle_light, 1e-3f, 1e-4f, 0.001f) // seen edge-on the density is huge, then 0
{
    uint i = 6u + index_below(8u);
    vec3 p = point(4.0f);
    vec2 u = unit2();
    give_light_sample(sample_triangle_light(scene.lights.at[i], p, u));
}
TWIN(sample_sphere_light, 1e-3f, 1e-4f, 0.001f) // at the rim
{
    uint i = 14u + index_below(6u);
    vec3 p = point(4.0f);
    uint near = index_below(4u);
    vec2 u = unit2();
    Light light = scene.lights.at[i];
    if (near == 0u) p = light.position + (0.2f * light.cos_inner) * p;
    give_light_sample(sample_sphere_light(light, p, u));
}
TWIN(sample_light, 1e-3f, 1e-4f, 0.001f) // as its parts
{
    uint i = index_below(scene_lights);
    vec3 p = point(4.0f);
    vec2 u = unit2();
    give_light_sample(sample_light(scene.lights.at[i], p, u));
}
TWIN(pdf_light, 1e-3f, 1e-4f, 0.001f) // seen edge-on
{
    uint i = index_below(scene_lights);
    vec3 p = point(4.0f);
    vec3 hit = point(2.0f);
    vec3 normal = direction();
    give(pdf_light(scene.lights.at[i], p, hit, normal));
}
TWIN(select_light, 0.0f, 0.0f, 0.0f)
{
    float u = unit();
    give(select_light(scene, u));
}
TWIN_BUILTIN(light_texture, 1e-3f, 1e-3f, 0.006f) // where the nearest texel changes; next to a cutoff; at a sphere's seam
{
    uint i = 6u + index_below(14u);
    vec2 u = unit2();
    Light light = scene.lights.at[i];
    vec3 target = light.position + light.cos_inner * direction();
    give(light_texture(scene, light, u, target));
}
TWIN(shadow_ray, 1e-4f, 1e-4f, 0.001f) // the direction lies in the surface: which side?
{
    SurfacePoint surface;
    surface.position = point(4.0f);
    surface.geometric_normal = direction();
    LightSample s;
    s.direction = direction();
    s.target = point(4.0f);
    s.is_infinite = index_below(2u);
    give(shadow_ray(surface, s));
}

#endif
