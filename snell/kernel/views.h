// Ambient occlusion, and views that show what the renderer knows about a hit instead of light.
#ifndef SNELL_KERNEL_VIEWS_H
#define SNELL_KERNEL_VIEWS_H
#include "snell/kernel/path_state.h"
SNELL_BEGIN

SNELL_CONST uint view_normals = 0u; // shading normal, from [-1, 1] to [0, 1]
SNELL_CONST uint view_uv = 1u;      // fraction of the texture coordinates in red and green
SNELL_CONST uint view_depth = 2u;   // distance from the camera; 1 at the far side of the scene
SNELL_CONST uint view_albedo = 3u;  // colour of the material
SNELL_CONST uint view_steps = 4u;   // traversal steps as a heat map

// A heat map from blue through green and yellow to red; x in [0, 1].
SNELL_FN vec3 heat_color(float x)
{
    float t = clamp(x, 0.0f, 1.0f);
    return clamp(vec3(1.5f - abs(4.0f * t - 3.0f), 1.5f - abs(4.0f * t - 2.0f), 1.5f - abs(4.0f * t - 1.0f)), 0.0f,
                 1.0f);
}

// Part of the light that a material sends back, for pictures and denoisers: in [0, 1].
SNELL_FN vec3 material_albedo(SNELL_IN(MaterialPoint) m)
{
    if (m.kind == material_principled) return principled_albedo(m.principled);
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

SNELL_END
#endif
