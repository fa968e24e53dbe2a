// A principled material at a hit: looked up, resolved and dispersed.
#ifndef TWIN_CASES
#include "snell/kernel/path_state.h"
#include "tests/gpu/draw_principled.h"
#else

TWIN(choose_color_channel, 0.0f, 0.0f, 0.0f)
{
    uint pixel = word();
    uint reversed_index = word();
    give(choose_color_channel(pixel, reversed_index));
}
TWIN_BUILTIN(look_up_anisotropy, 1e-4f, 1e-3f, 0.002f) // see slot_color; the direction where the texture has none
{
    uint index = index_below(scene_principled);
    uint mirrored = index_below(2u);
    PrincipledPoint p = plain_principled_point(0.25f);
    look_up_anisotropy(scene, scene.principled.at[index], draw_textured_point(), mirrored != 0u, p);
    give(p.anisotropy);
    give(p.anisotropy_direction);
}
TWIN_BUILTIN(principled_point, 1e-3f, 1e-3f, 0.005f) // see slot_color and mapped_normal
{
    Ray ray = draw_ray();
    Hit hit = draw_hit();
    uint index = 4u * index_below(scene_materials / 4u) + 3u;
    vec3 base_color = color();
    vec3 n = direction();
    SurfacePoint surface = surface_point(scene, ray, hit);
    give_principled_parameters(principled_point(scene, scene.materials.at[index], surface, hit, base_color,
                                                make_frame(n), -normalize(ray.direction)));
}
TWIN_BUILTIN(vertex_principled, 1e-3f, 1e-3f, 0.005f) // the same; see resolve_principled
{
    Ray ray = draw_ray();
    Hit hit = draw_hit();
    uint index = 4u * index_below(scene_materials / 4u) + 3u;
    vec3 base_color = color();
    vec3 n = direction();
    vec3 wo = draw_outgoing();
    SurfacePoint surface = surface_point(scene, ray, hit);
    surface.material = index;
    Frame frame = make_frame(n);
    give_resolved(vertex_principled(scene, surface, hit, base_color, frame, to_world(frame, wo), wo));
}
TWIN_BUILTIN(disperse, 1e-3f, 1e-4f, 0.003f) // see resolve_principled
{
    PathState state = draw_state();
    float dispersion = range(0.0f, 20.0f);
    Vertex v;
    v.material = draw_material_point(material_principled, 0.5f);
    v.material.principled = draw_principled_point();
    v.wo = draw_outgoing();
    disperse(scene, dispersion, state, v);
    give_state(state);
    give(v.material.principled.ior);
    give_resolved(v.material.principled);
}

#endif
