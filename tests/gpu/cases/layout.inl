// Byte for byte the same structs: every member of an element of an array in memory, where each word is another number.
// Here `scene` is pattern_scene(); RAW(Array) are 65536 such words seen as an array.
#ifndef TWIN_CASES
#include "snell/kernel/bounds.h"
#include "snell/kernel/film.h"
#include "snell/kernel/lens_system.h"
#include "snell/kernel/scene_view.h"
#include "tests/gpu/draw.h"
SNELL_BEGIN
SNELL_ARRAY(TwinRays, Ray)
SNELL_ARRAY(TwinHits, Hit)
SNELL_ARRAY(TwinTransforms, Transform)
SNELL_ARRAY(TwinKeys, SampleKey)
SNELL_ARRAY(TwinCameras, Camera)
SNELL_ARRAY(TwinLenses, LensSystem)
SNELL_ARRAY(TwinParams, RenderParams)
SNELL_ARRAY(TwinStates, PathState)
SNELL_ARRAY(TwinConnections, Connection)
SNELL_ARRAY(TwinBoxes, Aabb)
SNELL_ARRAY(TwinSlots, SampleSlot)
SNELL_ARRAY(TwinPixelSums, PixelSums)
SNELL_ARRAY(TwinPixelLights, PixelLight)
SNELL_ARRAY(TwinPixelHits, PixelHits)
SNELL_END
#else

TWIN(layout_scene_view, 0.0f, 0.0f, 0.0f)
{
    uint i = index_below(1000u);
    SceneView view = scene;
    give(view.positions.at[i]);
    give(view.normals.at[i]);
    give(view.uvs.at[i]);
    give(view.tangents.at[i]);
    give(view.colors.at[i]);
    give(view.triangles.at[i].v0);
    give(view.surfaces.at[i & 127u].material);
    give(view.spheres.at[i & 127u].center);
    give(view.planes.at[i & 127u].normal);
    give(view.instances.at[i & 127u].group);
    give(view.materials.at[i & 127u].kind);
    give(view.lights.at[i & 127u].kind);
    give(view.textures.at[i & 127u].offset);
    give(view.texels.at[i]);
    give(view.srgb.at[i]);
    give(view.slots.at[i & 63u].texture);
    give(view.principled.at[i & 15u].metallic);
    give(view.albedo.at[i]);
    give(view.environment_cdf.at[i]);
    give(view.light_count);
    give(view.plane_count);
    give(view.coverage);
    Environment e = view.environment;
    give(e.radiance);
    give(e.texture);
    give(e.row_x);
    give(e.row_y);
    give(e.row_z);
    give(e.mapping);
    give(e.is_visible);
    give(e.columns);
    give(e.rows);
    give(e.select_pdf);
    give(view.scene_radius);
    give(view.scene_center);
    give(view.delta_light_count);
}
TWIN(layout_material, 0.0f, 0.0f, 0.0f)
{
    uint i = index_below(160u);
    Material m = scene.materials.at[i];
    give(m.base_color);
    give(m.kind);
    give(m.emission);
    give(m.alpha);
    give(m.specular);
    give(m.ior);
    give(m.absorption);
    give(m.flags);
    give(m.base_slot);
    give(m.emission_slot);
    give(m.normal_slot);
    give(m.normal_scale);
    give(m.coverage);
    give(m.opacity);
    give(m.cutoff);
    give(m.opacity_slot);
    give(m.principled);
}
TWIN(layout_principled, 0.0f, 0.0f, 0.0f)
{
    uint i = index_below(97u);
    Principled p = scene.principled.at[i];
    give(p.metallic);
    give(p.roughness);
    give(p.specular);
    give(p.clearcoat);
    give(p.clearcoat_roughness);
    give(p.clearcoat_normal_scale);
    give(p.specular_color);
    give(p.sheen_color);
    give(p.sheen_roughness);
    give(p.transmission);
    give(p.thin_walled);
    give(p.anisotropy);
    give(p.anisotropy_rotation);
    give(p.iridescence);
    give(p.iridescence_ior);
    give(p.iridescence_thickness_min);
    give(p.iridescence_thickness_max);
    give(p.dispersion);
    give(p.diffuse_transmission);
    give(p.diffuse_transmission_color);
    give(p.metallic_slot);
    give(p.roughness_slot);
    give(p.specular_slot);
    give(p.specular_color_slot);
    give(p.clearcoat_slot);
    give(p.clearcoat_roughness_slot);
    give(p.clearcoat_normal_slot);
    give(p.sheen_color_slot);
    give(p.sheen_roughness_slot);
    give(p.transmission_slot);
    give(p.anisotropy_slot);
    give(p.iridescence_slot);
    give(p.iridescence_thickness_slot);
    give(p.diffuse_transmission_slot);
    give(p.diffuse_transmission_color_slot);
    give(p.glass_table);
}
TWIN(layout_light, 0.0f, 0.0f, 0.0f)
{
    uint i = index_below(170u);
    Light l = scene.lights.at[i];
    give(l.position);
    give(l.kind);
    give(l.direction);
    give(l.cos_inner);
    give(l.edge);
    give(l.cos_outer);
    give(l.emission);
    give(l.flags);
    give(l.primitive);
    give(l.instance);
    give(l.select_pdf);
    give(l.alias_threshold);
    give(l.alias);
    give(l.normal);
}
TWIN(layout_geometry, 0.0f, 0.0f, 0.0f)
{
    uint i = index_below(400u);
    Triangle t = scene.triangles.at[i];
    give(t.v0);
    give(t.v1);
    give(t.v2);
    give(t.surface);
    Surface s = scene.surfaces.at[i];
    give(s.material);
    give(s.object);
    give(s.first_vertex);
    give(s.normal_base);
    give(s.uv_base);
    give(s.color_base);
    give(s.first_triangle);
    give(s.first_light);
    give(s.uv_1_base);
    give(s.tangent_base);
    Sphere b = scene.spheres.at[i];
    give(b.center);
    give(b.radius);
    give(b.material);
    give(b.object);
    give(b.light);
    Plane p = scene.planes.at[i];
    give(p.normal);
    give(p.offset);
    give(p.material);
    give(p.object);
}
TWIN(layout_instance, 0.0f, 0.0f, 0.0f)
{
    uint i = index_below(146u);
    Instance n = scene.instances.at[i];
    give(n.to_world.x);
    give(n.to_world.y);
    give(n.to_world.z);
    give(n.to_object.x);
    give(n.to_object.y);
    give(n.to_object.z);
    give(n.group);
    give(n.light_base);
    give(n.object);
    Transform t = RAW(TwinTransforms).at[i];
    give(t.x);
    give(t.y);
    give(t.z);
}
TWIN(layout_texture, 0.0f, 0.0f, 0.0f)
{
    uint i = index_below(500u);
    Texture t = scene.textures.at[i];
    give(t.offset);
    give(t.width);
    give(t.height);
    give(t.format);
    TextureSlot s = scene.slots.at[i & 63u];
    give(s.texture);
    give(s.uv_set);
    give(s.wrap_u);
    give(s.wrap_v);
    give(s.filter_mode);
    give(s.channel);
    give(s.row_u);
    give(s.row_v);
}
TWIN(layout_ray_and_hit, 0.0f, 0.0f, 0.0f)
{
    uint i = index_below(8000u);
    give(RAW(TwinRays).at[i]);
    give(RAW(TwinHits).at[i]);
}
TWIN(layout_lens_system, 0.0f, 0.0f, 0.0f) // the address at its beginning is read by the cases of lens_system.inl
{
    uint i = index_below(1000u);
    LensSystem lens = RAW(TwinLenses).at[i];
    give_lens_system(lens);
}
TWIN(layout_camera, 0.0f, 0.0f, 0.0f)
{
    uint i = index_below(1400u);
    give_camera(RAW(TwinCameras).at[i]);
    SampleKey k = RAW(TwinKeys).at[i];
    give(k.kind);
    give(k.pixel);
    give(k.reversed_index);
}
TWIN(layout_params, 0.0f, 0.0f, 0.0f)
{
    uint i = index_below(1200u);
    RenderParams p = RAW(TwinParams).at[i];
    give_camera(p.camera);
    give(p.width);
    give(p.height);
    give(p.seed);
    give(p.sampler_kind);
    give(p.max_depth);
    give(p.flags);
    give(p.distance);
    give(p.max_steps);
}
TWIN(layout_aabb, 0.0f, 0.0f, 0.0f)
{
    uint i = index_below(10000u);
    give(RAW(TwinBoxes).at[i].lower);
    give(RAW(TwinBoxes).at[i].upper);
}
TWIN(layout_path, 0.0f, 0.0f, 0.0f)
{
    uint i = index_below(4600u);
    give_state(RAW(TwinStates).at[i]);
    give_connection(RAW(TwinConnections).at[i]);
}
TWIN(layout_film, 0.0f, 0.0f, 0.0f)
{
    uint i = index_below(800u);
    SampleSlot s = RAW(TwinSlots).at[i];
    give(s.layers[0]);
    give(s.layers[1]);
    give(s.layers[2]);
    give(s.sees_through);
    PixelSums p = RAW(TwinPixelSums).at[i];
    give(p.sum);
    give(p.square_sum);
    give(p.excess);
    give(p.sample_count);
    give(p.seen_through);
    PixelLight l = RAW(TwinPixelLights).at[i];
    give(l.emission);
    give(l.direct);
    give(l.indirect);
    PixelHits h = RAW(TwinPixelHits).at[i];
    give(h.albedo);
    give(h.normal);
    give(h.geometric_normal);
    give(h.position);
    give(h.uv);
    give(h.depth);
    give(h.steps);
    give(h.object);
    give(h.material);
    give(h.hit_count);
    give(h.sample_count);
}

#endif
