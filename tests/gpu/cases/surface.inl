// What is at a hit.
#ifndef TWIN_CASES
#include "snell/kernel/surface.h"
#include "tests/gpu/draw.h"
#else

TWIN(offset_point, 1e-6f, 1e-7f, 0.0f)
{
    vec3 p = point(8.0f);
    vec3 n = direction();
    vec3 w = direction();
    give(offset_point(p, n));
    give(offset_point(0.01f * p, n));
    give(offset_toward(p, n, w));
}
TWIN(triangle_point, 1e-4f, 1e-5f, 0.0f)
{
    Hit hit = draw_hit();
    hit.primitive = pack_primitive(kind_triangle, primitive_index(hit.primitive));
    give_surface_point(triangle_point(scene, hit));
}
TWIN_BUILTIN(sphere_point, 1e-4f, 1e-4f, 0.0f)
{
    uint index = index_below(scene_spheres);
    Ray ray = draw_ray();
    Hit hit = draw_hit();
    hit.primitive = pack_primitive(kind_sphere, index);
    give_surface_point(sphere_point(scene, ray, hit));
}
TWIN(plane_point, 1e-4f, 1e-4f, 0.0f)
{
    uint index = index_below(scene_planes);
    Ray ray = draw_ray();
    Hit hit = draw_hit();
    hit.primitive = pack_primitive(kind_plane, index);
    give_surface_point(plane_point(scene, ray, hit));
}
TWIN_BUILTIN(surface_point, 1e-4f, 1e-4f, 0.001f) // the normals switch sides
{
    Ray ray = draw_ray();
    Hit hit = draw_hit();
    give_surface_point(surface_point(scene, ray, hit));
}
TWIN_BUILTIN(sphere_uv, 1e-4f, 1e-5f, 0.0f)
{
    vec3 n = direction();
    give(sphere_uv(n));
    give(longitude(n.x, n.z));
}
TWIN(slot_color, 1e-5f, 1e-4f, 0.002f) // where the nearest texel changes
{
    uint slot = index_below(2u * scene_slots);
    SurfacePoint s = draw_textured_point();
    if (slot >= scene_slots) slot = none;
    give(slot_color(scene, slot, s));
    give(slot_value(scene, slot, s));
}
TWIN(emission_texture, 1e-5f, 1e-4f, 0.002f) // the same
{
    uint index = index_below(scene_materials);
    SurfacePoint s = draw_textured_point();
    give(emission_texture(scene, scene.materials.at[index], s));
}
TWIN(surface_coverage, 1e-5f, 1e-4f, 0.002f) // the same, and next to the cutoff
{
    uint index = index_below(scene_materials);
    SurfacePoint s = draw_textured_point();
    give(surface_coverage(scene, scene.materials.at[index], s));
}
TWIN(material_point, 1e-5f, 1e-4f, 0.002f) // the same
{
    uint index = index_below(scene_materials);
    SurfacePoint s = draw_textured_point();
    give_material_point(material_point(scene, scene.materials.at[index], s));
}

#endif
