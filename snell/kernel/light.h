// Light sources: emission and sampling.
#ifndef SNELL_KERNEL_LIGHT_H
#define SNELL_KERNEL_LIGHT_H
#include "snell/kernel/frame.h"
#include "snell/kernel/surface.h"
#include "snell/kernel/warp.h"
SNELL_BEGIN

// A direction in which a point may be lit.
struct LightSample
{
    vec3 direction; // unit length, from the point to the light
    vec3 radiance;  // that arrives from there if nothing is in between; intensity / d^2 or irradiance if is_delta
    vec3 target;    // where the light is; with t_max of the shadow ray 1 it ends there. Unused if is_infinite
    float pdf;      // per steradian, selection included; probability of the selection if is_delta; 0: no sample
    uint is_delta;
    uint is_infinite;
};

SNELL_FN LightSample no_light_sample()
{
    LightSample s;
    s.direction = vec3(0.0f, 0.0f, 1.0f);
    s.radiance = vec3(0.0f);
    s.target = vec3(0.0f);
    s.pdf = 0.0f;
    s.is_delta = 0u;
    s.is_infinite = 0u;
    return s;
}

// Smooth falloff between the two cones of a spot light.
SNELL_FN float spot_falloff(Light light, float cos_angle)
{
    if (cos_angle <= light.cos_outer) return 0.0f;
    if (cos_angle >= light.cos_inner) return 1.0f;
    float x = (cos_angle - light.cos_outer) / (light.cos_inner - light.cos_outer);
    return x * x * (3.0f - 2.0f * x);
}

// 1 - cos of the cone in which a sphere light is seen from a point outside; negative if the point is inside. Points on
// the sphere itself count as inside, however they are rounded: one on the inner wall of a sphere that shines inwards
// must not be taken for one outside. Where only the outside shines, the margin is as thin as floats allow, for a floor
// that the sphere touches lies in it.
SNELL_FN float sphere_cone(Light light, vec3 point)
{
    vec3 d = light.position - point;
    float d2 = dot(d, d);
    float r2 = light.cos_inner * light.cos_inner;
    float margin = (light.flags & light_two_sided) != 0u ? 1.0001f : 1.000002f;
    if (d2 <= r2 * margin) return -1.0f;
    float sin2 = r2 / d2;
    return sin2 / (1.0f + sqrt(1.0f - sin2));
}

SNELL_FN LightSample sample_point_light(Light light, vec3 point)
{
    LightSample s = no_light_sample();
    vec3 d = light.position - point;
    float d2 = dot(d, d);
    if (!(d2 > 0.0f)) return s;
    s.direction = d / sqrt(d2);
    s.radiance = light.emission / d2;
    if (light.kind == light_spot) s.radiance = s.radiance * spot_falloff(light, -dot(s.direction, light.direction));
    s.target = light.position;
    s.pdf = 1.0f;
    s.is_delta = 1u;
    return s;
}

SNELL_FN LightSample sample_directional_light(Light light)
{
    LightSample s = no_light_sample();
    s.direction = -light.direction;
    s.radiance = light.emission;
    s.pdf = 1.0f;
    s.is_delta = 1u;
    s.is_infinite = 1u;
    return s;
}

SNELL_FN LightSample sample_triangle_light(Light light, vec3 point, vec2 u)
{
    LightSample s = no_light_sample();
    vec2 b = sample_triangle(u);
    vec3 q = light.position + b.x * light.direction + b.y * light.edge;
    vec3 n = light.normal;
    vec3 d = q - point;
    float d2 = dot(d, d);
    if (!(d2 > 0.0f)) return s;
    s.direction = d / sqrt(d2);
    float cosine = -dot(s.direction, n);
    if (cosine < 0.0f && (light.flags & light_two_sided) != 0u) {
        cosine = -cosine;
        n = -n;
    }
    if (cosine <= 0.0f) return s;
    s.radiance = light.emission;
    s.target = offset_point(q, n);
    s.pdf = d2 / (cosine * light.cos_outer);
    return s;
}

SNELL_FN LightSample sample_sphere_light(Light light, vec3 point, vec2 u)
{
    LightSample s = no_light_sample();
    float radius = light.cos_inner;
    vec3 d = light.position - point;
    float cone = sphere_cone(light, point);
    if (cone > 0.0f) {
        float distance2 = dot(d, d);
        Frame frame = make_frame(d / sqrt(distance2));
        vec3 w = sample_uniform_cone(u, cone);
        s.direction = to_world(frame, w);
        // The nearer point of the sphere on that ray, put back onto the sphere, which the sum misses from far away.
        float sin2 = w.x * w.x + w.y * w.y;
        float along = sqrt(distance2) * w.z - safe_sqrt(radius * radius - distance2 * sin2);
        vec3 n = normalize(along * s.direction - d);
        s.target = offset_point(light.position + radius * n, n);
        s.radiance = light.emission;
        s.pdf = pdf_uniform_cone(cone);
        return s;
    }
    // Inside: any point of the sphere; only a two-sided one shines inwards.
    if ((light.flags & light_two_sided) == 0u) return s;
    vec3 n = sample_uniform_sphere(u);
    vec3 to = light.position + radius * n - point;
    float d2 = dot(to, to);
    if (!(d2 > 0.0f)) return s;
    s.direction = to / sqrt(d2);
    float cosine = abs(dot(s.direction, n));
    if (cosine <= 0.0f) return s;
    s.target = offset_toward(light.position + radius * n, n, -s.direction);
    s.radiance = light.emission;
    s.pdf = d2 / (cosine * 4.0f * pi * radius * radius);
    return s;
}

// A sample of the given light, as if it were the only one.
SNELL_FN LightSample sample_light(Light light, vec3 point, vec2 u)
{
    if (light.kind == light_triangle) return sample_triangle_light(light, point, u);
    if (light.kind == light_sphere) return sample_sphere_light(light, point, u);
    if (light.kind == light_directional) return sample_directional_light(light);
    return sample_point_light(light, point);
}

// Density per steradian, seen from `point`, with which sample_light draws a direction that meets the light at `hit`
// with the light's geometric normal there. The choice of the light is not included.
SNELL_FN float pdf_light(Light light, vec3 point, vec3 hit, vec3 normal)
{
    if (light.kind == light_sphere) {
        float cone = sphere_cone(light, point);
        if (cone > 0.0f) return pdf_uniform_cone(cone);
        if ((light.flags & light_two_sided) == 0u) return 0.0f; // as in sample_sphere_light
    } else if (light.kind != light_triangle) {
        return 0.0f;
    }
    vec3 d = hit - point;
    float d2 = dot(d, d);
    float area = light.kind == light_triangle ? light.cos_outer : 4.0f * pi * sqr(light.cos_inner);
    float cosine = abs(dot(d, normal)) / sqrt(d2);
    return cosine > 0.0f ? d2 / (cosine * area) : 0.0f;
}

// Chooses a light with probability select_pdf (alias method). light_count > 0.
SNELL_FN uint select_light(SNELL_IN(SceneView) scene, float u)
{
    float x = u * float(scene.light_count);
    uint i = min(uint(x), scene.light_count - 1u);
    return x - float(i) < scene.lights.at[i].alias_threshold ? i : scene.lights.at[i].alias;
}

// What the material's textures leave of the emission at the point that a sample with these random numbers has found;
// for lights that are light_textured. Where the surface has holes, nothing shines.
SNELL_FN_COLD vec3 light_texture(SNELL_IN(SceneView) scene, Light light, vec2 u, vec3 target)
{
    SurfacePoint surface;
    if (light.kind == light_triangle) {
        vec2 b = sample_triangle(u);
        Hit hit = miss(0.0f);
        hit.primitive = light.primitive;
        hit.u = (light.flags & light_mirrored) != 0u ? b.y : b.x;
        hit.v = (light.flags & light_mirrored) != 0u ? b.x : b.y;
        surface = triangle_point(scene, hit);
    } else {
        vec3 n = target - light.position;
        if (light.instance != none) n = transform_vector(scene.instances.at[light.instance].to_object, n);
        surface.uv = sphere_uv(normalize(n));
        surface.uv_1 = surface.uv;
        surface.color = vec4(1.0f);
        surface.material = scene.spheres.at[primitive_index(light.primitive)].material;
    }
    Material material = scene.materials.at[surface.material];
    return emission_texture(scene, material, surface) * surface_coverage(scene, material, surface);
}

// The ray that asks whether a light sample reaches the surface.
SNELL_FN Ray shadow_ray(SurfacePoint surface, LightSample light)
{
    vec3 origin = offset_toward(surface.position, surface.geometric_normal, light.direction);
    if (light.is_infinite != 0u) return make_ray(origin, light.direction, infinity());
    return make_ray(origin, light.target - origin, 1.0f);
}

SNELL_END
#endif
