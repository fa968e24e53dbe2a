// Random structs for cases, and their results given away member by member. In the kernel dialect: both compilers read
// this. Each draw stands in a statement of its own.
#ifndef SNELL_TESTS_GPU_DRAW_H
#define SNELL_TESTS_GPU_DRAW_H
#include "snell/kernel/bsdf.h"
#include "snell/kernel/environment.h"
#include "snell/kernel/path_state.h"
#include "tests/gpu/scene_sizes.h"
SNELL_BEGIN

SNELL_FN_COLD Ray draw_ray()
{
    vec3 origin = point(4.0f);
    vec3 target = point(2.0f);
    float t_max = magnitude(0.5f, 1e6f);
    return make_ray(origin, target - origin, t_max);
}

// A hit on the random scene; t and the ray do not really lead there, which no kernel minds.
SNELL_FN_COLD Hit draw_hit()
{
    uint kind = index_below(3u);
    uint index =
        index_below(kind == kind_triangle ? scene_triangles : (kind == kind_sphere ? scene_spheres : scene_planes));
    uint instance = index_below(2u * scene_instances);
    float a = unit();
    float b = unit();
    Hit hit;
    hit.t = range(0.2f, 4.0f);
    hit.u = a + b > 1.0f ? 1.0f - a : a;
    hit.v = a + b > 1.0f ? 1.0f - b : b;
    hit.primitive = pack_primitive(kind, index);
    hit.instance = instance < scene_instances && kind != kind_plane ? instance : none;
    return hit;
}

// A point of the random scene with no more than what textures are looked up by.
SNELL_FN_COLD SurfacePoint draw_textured_point()
{
    SurfacePoint s;
    s.uv = point2(4.0f);
    s.uv_1 = point2(4.0f);
    vec3 rgb = color();
    float opacity = range(0.0f, 1.0f);
    s.color = vec4(rgb.x, rgb.y, rgb.z, opacity);
    return s;
}

// The random scene with an environment of either mapping, one in eight a constant one.
SNELL_FN_COLD SceneView draw_environment(SNELL_IN(SceneView) scene)
{
    SceneView s = scene;
    uint constant = index_below(8u);
    s.environment.mapping = index_below(2u);
    s.environment.is_visible = index_below(2u);
    if (constant == 0u) {
        s.environment.texture = none;
        s.environment.columns = 0u;
        s.environment.rows = 0u;
    }
    return s;
}

// alpha: 0 for the smooth variants. Of material_principled without a resolved point: see draw_resolved_point.
SNELL_FN_COLD MaterialPoint draw_material_point(uint kind, float alpha)
{
    MaterialPoint m;
    m.kind = kind;
    m.alpha = alpha;
    m.base_color = color();
    m.specular = color();
    m.k = 6.0f * color();
    m.ior = range(0.5f, 3.0f);
    if (kind == material_conductor) m.specular = 3.0f * m.specular + vec3(0.05f);
    m.principled = plain_principled_point(alpha);
    return m;
}

// What moving on from a vertex reads of it, but for the material.
SNELL_FN_COLD Vertex draw_vertex()
{
    Vertex v;
    v.surface.position = point(4.0f);
    v.surface.geometric_normal = direction();
    v.surface.material = index_below(scene_materials);
    v.frame = make_frame(direction());
    v.wo = direction();
    return v;
}

// A double Gauss of 50 mm in focus at two metres.
SNELL_FN_COLD LensSystem twin_lens(SNELL_IN(SceneView) scene)
{
    vec4 rest = scene.colors.at[scene_lens_first + scene_lens_interfaces + scene_lens_pupils];
    LensSystem lens;
    lens.table = scene.colors;
    lens.first = scene_lens_first;
    lens.interface_count = scene_lens_interfaces;
    lens.pupil_count = scene_lens_pupils;
    lens.rear_z = rest.x;
    lens.entrance_z = rest.y;
    lens.gain = rest.z;
    lens.film_radius = rest.w;
    lens.unit = 0.001f;
    return lens;
}

// Any model, with distortions that do not fold the picture.
SNELL_FN_COLD Camera draw_camera_model(SNELL_IN(SceneView) scene, Camera pinhole)
{
    Camera c = pinhole;
    c.model = index_below(camera_model_count);
    float lens_radius = magnitude(1e-3f, 1.0f);
    c.lens_radius = c.model == camera_pinhole ? lens_radius : 0.0f;
    c.focus_distance = magnitude(0.1f, 100.0f);
    c.blades = index_below(9u);
    c.blade_turn = unit();
    c.eye_offset = magnitude(0.01f, 0.1f);
    if (c.model != camera_pinhole && c.model != camera_orthographic) {
        c.right = normalize(c.right);
        c.up = normalize(c.up);
    }
    if (c.model == camera_hmd) c.center.x = 0.5f * c.center.x;
    float size = 0.25f * min(c.width, c.height);
    float fx = range(0.3f, 1.0f);
    float fy = range(0.3f, 1.0f);
    c.focal = size * vec2(fx, fy);
    float k = c.model == camera_hmd ? 0.2f : 0.02f;
    for (uint i = 0u; i < 9u; ++i) c.k[i] = range(0.0f, k);
    if (c.model == camera_lens) {
        float per_mm = sqrt(c.width * c.width + c.height * c.height) / 43.2f;
        c.focal = vec2(per_mm, per_mm);
        c.lens = twin_lens(scene);
    }
    return c;
}

SNELL_FN_COLD RenderParams draw_params()
{
    vec3 eye = point(5.0f);
    vec3 target = point(5.0f);
    float tangent = range(0.1f, 2.0f);
    RenderParams p;
    p.width = 1u + index_below(2000u);
    p.height = 1u + index_below(2000u);
    if (abs(target.x - eye.x) < 0.1f) target.x = eye.x + 1.0f; // not above each other
    p.camera = make_pinhole(eye, target, vec3(0.0f, 1.0f, 0.0f), tangent, float(p.width), float(p.height));
    p.seed = word();
    p.sampler_kind = index_below(2u);
    p.max_depth = index_below(6u);
    p.flags = index_below(32u);
    p.distance = magnitude(0.1f, 100.0f);
    p.max_steps = magnitude(1.0f, 200.0f);
    return p;
}

SNELL_FN_COLD PathState draw_state()
{
    PathState s;
    s.throughput = color();
    s.slot = word();
    s.pdf = index_below(3u) == 0u ? 0.0f : 1.0f;
    s.pdf = s.pdf * magnitude(1e-3f, 100.0f);
    s.eta_scale = magnitude(0.25f, 4.0f);
    s.depth = index_below(6u);
    s.medium = index_below(2u * scene_materials);
    if (s.medium >= scene_materials) s.medium = none;
    s.key_pixel = word();
    s.key_reversed_index = word();
    s.channel = index_below(4u);
    if (s.channel == 3u) s.channel = none;
    return s;
}

SNELL_FN void give_surface_point(SurfacePoint s)
{
    give(s.position);
    give(s.geometric_normal);
    give(s.shading_normal);
    give(s.uv);
    give(s.uv_1);
    give(s.color);
    give(s.material);
    give(s.object);
    give(s.light);
}
SNELL_FN void give_material_point(MaterialPoint m)
{
    give(m.base_color);
    give(m.kind);
    give(m.specular);
    give(m.alpha);
    give(m.k);
    give(m.ior);
}
SNELL_FN void give_bsdf_sample(BsdfSample s)
{
    give(s.pdf);
    if (s.pdf == 0.0f) return; // no sample: the rest has no meaning
    give(s.wi);
    give(s.weight);
    give(s.eta);
    give(s.is_delta);
}
SNELL_FN void give_light_sample(LightSample s)
{
    give(s.pdf);
    if (s.pdf == 0.0f) return;
    give(s.direction);
    give(s.radiance);
    give(s.is_delta);
    give(s.is_infinite);
    if (s.is_infinite == 0u) give(s.target);
}
SNELL_FN void give_connection(Connection c)
{
    give(c.ray);
    give(c.value);
    give(c.slot);
    give(c.layer);
    give(c.seed);
}
SNELL_FN void give_state(PathState s)
{
    give(s.throughput);
    give(s.slot);
    give(s.pdf);
    give(s.eta_scale);
    give(s.depth);
    give(s.medium);
    give(s.key_pixel);
    give(s.key_reversed_index);
    give(s.channel);
}
SNELL_FN void give_camera_path(CameraPath p)
{
    give(p.ray);
    give_state(p.state);
}
// But for the address of its table.
SNELL_FN void give_lens_system(LensSystem lens)
{
    give(lens.first);
    give(lens.interface_count);
    give(lens.pupil_count);
    give(lens.film_radius);
    give(lens.rear_z);
    give(lens.entrance_z);
    give(lens.gain);
    give(lens.unit);
}
// A ray that has been blocked says no more than that: where it was is of no use.
SNELL_FN void give_lens_ray(LensRay ray)
{
    give(ray.weight);
    if (ray.weight == 0.0f) return;
    give(ray.origin);
    give(ray.direction);
}
SNELL_FN void give_camera(Camera c)
{
    give(c.origin);
    give(c.width);
    give(c.right);
    give(c.height);
    give(c.up);
    give(c.model);
    give(c.forward);
    give(c.lens_radius);
    give(c.focus_distance);
    give(c.blades);
    give(c.blade_turn);
    give(c.eye_offset);
    give(c.focal);
    give(c.center);
    for (uint i = 0u; i < 9u; ++i) give(c.k[i]);
    give_lens_system(c.lens);
}

SNELL_END
#endif
