// Ambient occlusion, and views that show what the renderer knows about a hit instead of light.
#ifndef SNELL_KERNEL_VIEWS_H
#define SNELL_KERNEL_VIEWS_H
#include "snell/kernel/path_state.h"
SNELL_BEGIN

SNELL_CONST uint view_normals = 0u;      // shading normal, from [-1, 1] to [0, 1]
SNELL_CONST uint view_uv = 1u;           // fraction of the texture coordinates in red and green
SNELL_CONST uint view_depth = 2u;        // distance from the camera; 1 at the far side of the scene
SNELL_CONST uint view_albedo = 3u;       // colour of the material
SNELL_CONST uint view_steps = 4u;        // traversal steps as a heat map
SNELL_CONST uint view_object = 5u;       // a colour for each object; what is placed several times has one
SNELL_CONST uint view_instance = 6u;     // a colour for each instance
SNELL_CONST uint view_material = 7u;     // a colour for each material
SNELL_CONST uint view_primitive = 8u;    // a colour for each triangle or sphere
SNELL_CONST uint view_barycentrics = 9u; // weights of a triangle's vertices in red, green and blue
SNELL_CONST uint view_geometric_normals = 10u;
SNELL_CONST uint view_facing = 11u; // blue: seen from the front, the side of the normal; red: from the back
SNELL_CONST uint view_count = 12u;

// A heat map from night blue through violet and orange to light yellow; x in [0, 1], linear Rec.709. Brighter is more,
// in even steps: lightness in Oklab (Ottosson 2020) goes straight from 0.17 to 0.95 while the hue turns from 275 to 465
// degrees, and chroma stays within the gamut. This is the polynomial of degree 6 nearest to the square roots, which is
// within 0.01 of them.
SNELL_FN vec3 heat_color(float x)
{
    float t = clamp(x, 0.0f, 1.0f);
    vec3 root = vec3(-0.6188f, 7.8632f, -23.819f);
    root = root * t + vec3(6.3399f, -24.1616f, 63.8533f);
    root = root * t + vec3(-10.7305f, 25.0624f, -58.299f);
    root = root * t + vec3(3.9217f, -9.199f, 23.2276f);
    root = root * t + vec3(1.2392f, 1.2167f, -6.144f);
    root = root * t + vec3(0.7677f, 0.1177f, 1.632f);
    root = clamp(root * t + vec3(0.0491f, 0.0484f, 0.164f), 0.0f, 1.0f);
    return root * root;
}

// A colour for a number, unlike those of its neighbours; grey for none.
SNELL_FN vec3 id_color(uint id)
{
    if (id == none) return vec3(0.18f);
    uvec3 h = pcg3d(uvec3(id, id ^ 0x9e3779b9u, 0x2545f491u));
    return vec3(0.06f) + 0.94f * vec3(sqr(unit_float(h.x)), sqr(unit_float(h.y)), sqr(unit_float(h.z)));
}

// Part of the light that a material sends back, for pictures and denoisers: in [0, 1].
SNELL_FN vec3 material_albedo(SNELL_IN(MaterialPoint) m)
{
    if (is_material(m.kind, material_principled)) return principled_albedo(m.principled);
    if (m.kind == material_dielectric) return vec3(1.0f);
    if (m.kind == material_conductor) return fresnel_conductor(1.0f, m.specular, m.k);
    if (m.kind == material_mix) return clamp(m.base_color + m.specular, 0.0f, 1.0f);
    return clamp(m.base_color, 0.0f, 1.0f);
}

SNELL_FN vec3 view_value(SNELL_IN(SceneView) scene, SNELL_IN(RenderParams) params, uint view, SNELL_IN(Ray) ray,
                         SNELL_IN(Hit) hit, uint steps)
{
    if (view == view_steps) return heat_color(float(steps) / params.max_steps);
    if (!is_hit(hit)) return vec3(0.0f);
    Vertex v = make_vertex(scene, ray, hit);
    if (view == view_normals) return 0.5f * v.surface.shading_normal + 0.5f;
    if (view == view_geometric_normals) return 0.5f * v.surface.geometric_normal + 0.5f;
    if (view == view_object) return id_color(v.surface.object);
    if (view == view_instance) return id_color(hit.instance);
    if (view == view_material) return id_color(v.surface.material);
    if (view == view_primitive) return id_color(hit.primitive);
    if (view == view_barycentrics) return vec3(1.0f - hit.u - hit.v, hit.u, hit.v);
    if (view == view_facing) {
        float cosine = -dot(v.surface.geometric_normal, ray.direction);
        vec3 color = cosine > 0.0f ? vec3(0.1f, 0.3f, 0.8f) : vec3(0.8f, 0.1f, 0.05f);
        return color * (0.2f + 0.8f * abs(cosine));
    }
    if (view == view_uv) return vec3(fract(v.surface.uv.x), fract(v.surface.uv.y), 0.0f);
    if (view == view_depth)
        return vec3(hit.t / (length(scene.scene_center - params.camera.origin) + scene.scene_radius));
    return material_albedo(v.material);
}

// Ambient occlusion: is a cosine-distributed direction free up to params.distance? The surface is lit from both sides.
SNELL_FN Connection ambient_connection(SNELL_IN(SceneView) scene, SNELL_IN(RenderParams) params,
                                       SNELL_IN(PathState) state, SNELL_IN(Ray) ray, SNELL_IN(Hit) hit)
{
    SurfacePoint surface = surface_point(scene, ray, hit);
    vec3 n = dot(surface.shading_normal, ray.direction) > 0.0f ? -surface.shading_normal : surface.shading_normal;
    vec2 u = random_2d(state_key(params, state), vertex_dimension(0u, dimension_bsdf));
    vec3 direction = to_world(make_frame(n), sample_cosine_hemisphere(u));
    Connection c;
    c.ray = make_ray(offset_toward(surface.position, surface.geometric_normal, direction), direction, params.distance);
    // below the true surface there is only the surface itself
    bool above = dot(surface.geometric_normal, direction) * dot(surface.geometric_normal, n) > 0.0f;
    c.value = above ? vec3(1.0f) : vec3(0.0f);
    c.slot = state.slot;
    c.layer = layer_direct;
    c.seed = connection_seed(state);
    return c;
}

// What the pictures beside the colour record of a first hit.
struct FirstHit
{
    vec3 albedo;
    vec3 normal;
    vec3 geometric_normal;
    vec3 position;
    vec2 uv;
    float depth; // distance from the camera along the ray
    uint object, material;
};

SNELL_FN FirstHit first_hit(SNELL_IN(SceneView) scene, SNELL_IN(Ray) ray, SNELL_IN(Hit) hit)
{
    Vertex v = make_vertex(scene, ray, hit);
    FirstHit f;
    f.albedo = material_albedo(v.material);
    f.normal = v.surface.shading_normal;
    f.geometric_normal = v.surface.geometric_normal;
    f.position = v.surface.position;
    f.uv = v.surface.uv;
    f.depth = hit.t;
    f.object = v.surface.object;
    f.material = v.surface.material;
    return f;
}

// Perfect mirrors and glass that are looked through for the albedo and the normal: denoisers want to know what is seen
// in them.
SNELL_CONST uint look_through_bounces = 8u;

struct LookThrough
{
    CameraPath path; // behind the hit
    uint ok;         // 0: the surface is seen itself, or nothing is seen in it, and path means nothing
};

SNELL_FN LookThrough look_through(SNELL_IN(SceneView) scene, SNELL_IN(RenderParams) params, SNELL_IN(PathState) state,
                                  SNELL_IN(Ray) ray, SNELL_IN(Hit) hit)
{
    LookThrough seen;
    seen.ok = 0u;
    Vertex v = make_vertex(scene, ray, hit);
    if (has_smooth_part(v.material)) return seen;
    float u_lobe = random_1d(state_key(params, state), vertex_dimension(state.depth, dimension_lobe));
    BsdfSample s = sample_bsdf(v.material, v.wo, vec2(0.5f), u_lobe);
    if (s.pdf == 0.0f) return seen;
    seen.path = scatter(scene, state, v, s);
    seen.ok = 1u;
    return seen;
}

SNELL_END
#endif
