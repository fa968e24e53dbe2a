// What is at a hit: position, normals, material.
#ifndef SNELL_KERNEL_SURFACE_H
#define SNELL_KERNEL_SURFACE_H
#include "snell/kernel/bsdf.h"
#include "snell/kernel/frame.h"
#include "snell/kernel/ray.h"
#include "snell/kernel/texture.h"
SNELL_BEGIN

struct SurfacePoint
{
    vec3 position;         // in world space, as close to the surface as floats allow
    vec3 geometric_normal; // unit length, outward
    vec3 shading_normal;   // unit length, on the side of the geometric normal
    vec2 uv;
    vec2 uv_1;     // second texture coordinates; the first where there are none
    vec4 color;    // interpolated vertex colour and opacity; 1 where there is none
    uint material; // index
    uint object;   // number in the Scene: meshes, then spheres, then planes
    uint light;    // index of the light that this point belongs to, or none
};

// Moves a point off the surface to the side of n, far enough that a ray from there does not hit the surface again.
// Waechter and Binder, Ray Tracing Gems, chapter 6: a distance in units of the last place, with a fixed one near 0.
SNELL_FN vec3 offset_point(vec3 p, vec3 n)
{
    int ix = int(256.0f * n.x);
    int iy = int(256.0f * n.y);
    int iz = int(256.0f * n.z);
    vec3 far_from_0 = vec3(intBitsToFloat(floatBitsToInt(p.x) + (p.x < 0.0f ? -ix : ix)),
                           intBitsToFloat(floatBitsToInt(p.y) + (p.y < 0.0f ? -iy : iy)),
                           intBitsToFloat(floatBitsToInt(p.z) + (p.z < 0.0f ? -iz : iz)));
    float near_0 = 1.0f / 32.0f;
    float small = 1.0f / 65536.0f;
    return vec3(abs(p.x) < near_0 ? p.x + small * n.x : far_from_0.x,
                abs(p.y) < near_0 ? p.y + small * n.y : far_from_0.y,
                abs(p.z) < near_0 ? p.z + small * n.z : far_from_0.z);
}

// The same for a ray that leaves along `direction`: to the side of the surface that it goes to.
SNELL_FN vec3 offset_toward(vec3 p, vec3 normal, vec3 direction)
{
    return offset_point(p, dot(normal, direction) < 0.0f ? -normal : normal);
}

SNELL_FN SurfacePoint triangle_point(SNELL_IN(SceneView) scene, Hit hit)
{
    Triangle triangle = scene.triangles.at[primitive_index(hit.primitive)];
    Surface surface = scene.surfaces.at[triangle.surface];
    vec3 p0 = scene.positions.at[triangle.v0];
    vec3 e1 = scene.positions.at[triangle.v1] - p0;
    vec3 e2 = scene.positions.at[triangle.v2] - p0;
    float w = 1.0f - hit.u - hit.v;

    SurfacePoint s;
    s.position = p0 + hit.u * e1 + hit.v * e2;
    s.geometric_normal = normalize(cross(e1, e2));
    s.shading_normal = s.geometric_normal;
    uint i0 = triangle.v0 - surface.first_vertex;
    uint i1 = triangle.v1 - surface.first_vertex;
    uint i2 = triangle.v2 - surface.first_vertex;
    if (surface.normal_base != none) {
        vec3 n = w * scene.normals.at[surface.normal_base + i0] + hit.u * scene.normals.at[surface.normal_base + i1] +
                 hit.v * scene.normals.at[surface.normal_base + i2];
        float l2 = dot(n, n);
        if (l2 > 1e-12f) s.shading_normal = n / sqrt(l2);
    }
    s.uv = vec2(hit.u, hit.v);
    if (surface.uv_base != none)
        s.uv = w * scene.uvs.at[surface.uv_base + i0] + hit.u * scene.uvs.at[surface.uv_base + i1] +
               hit.v * scene.uvs.at[surface.uv_base + i2];
    s.uv_1 = s.uv;
    if (surface.uv_1_base != none)
        s.uv_1 = w * scene.uvs.at[surface.uv_1_base + i0] + hit.u * scene.uvs.at[surface.uv_1_base + i1] +
                 hit.v * scene.uvs.at[surface.uv_1_base + i2];
    s.color = vec4(1.0f);
    if (surface.color_base != none)
        s.color = w * scene.colors.at[surface.color_base + i0] + hit.u * scene.colors.at[surface.color_base + i1] +
                  hit.v * scene.colors.at[surface.color_base + i2];
    s.material = surface.material;
    s.object = surface.object;
    s.light = surface.first_light == none
                  ? none
                  : surface.first_light + primitive_index(hit.primitive) - surface.first_triangle;
    return s;
}

// The angle from +Z towards +X around the axis +Y; 0 on the axis, where GLSL's atan has no value.
SNELL_FN float longitude(float x, float z)
{
    return x == 0.0f && z == 0.0f ? 0.0f : atan(x, z);
}

// Longitude and latitude of a point of the unit sphere, from 0 to 1; +Z is in the middle.
SNELL_FN vec2 sphere_uv(vec3 n)
{
    // not asin: near the poles it loses digits, and GPUs compute it to three places only
    return vec2(0.5f + longitude(n.x, n.z) * (0.5f * inv_pi), 0.5f + atan(n.y, sqrt(n.x * n.x + n.z * n.z)) * inv_pi);
}

// ray: in the space of the sphere.
SNELL_FN SurfacePoint sphere_point(SNELL_IN(SceneView) scene, Ray ray, Hit hit)
{
    Sphere sphere = scene.spheres.at[primitive_index(hit.primitive)];
    SurfacePoint s;
    vec3 n = normalize(ray_at(ray, hit.t) - sphere.center);
    s.position = sphere.center + sphere.radius * n;
    s.geometric_normal = n;
    s.shading_normal = n;
    s.uv = sphere_uv(n);
    s.uv_1 = s.uv;
    s.color = vec4(1.0f);
    s.material = sphere.material;
    s.object = sphere.object;
    s.light = sphere.light;
    return s;
}

SNELL_FN SurfacePoint plane_point(SNELL_IN(SceneView) scene, Ray ray, Hit hit)
{
    Plane plane = scene.planes.at[primitive_index(hit.primitive)];
    SurfacePoint s;
    vec3 p = ray_at(ray, hit.t);
    s.position = p - (dot(plane.normal, p) - plane.offset) * plane.normal;
    s.geometric_normal = plane.normal;
    s.shading_normal = plane.normal;
    Frame frame = make_frame(plane.normal);
    s.uv = vec2(dot(s.position, frame.s), dot(s.position, frame.t)); // world units
    s.uv_1 = s.uv;
    s.color = vec4(1.0f);
    s.material = plane.material;
    s.object = plane.object;
    s.light = none;
    return s;
}

// The surface at a hit (hit.primitive != none) of a world-space ray.
SNELL_FN SurfacePoint surface_point(SNELL_IN(SceneView) scene, Ray ray, Hit hit)
{
    uint kind = primitive_kind(hit.primitive);
    SurfacePoint s;
    if (!may_have(feature_instances) || hit.instance == none) {
        if (may_have(feature_spheres) && kind == kind_sphere)
            s = sphere_point(scene, ray, hit);
        else if (may_have(feature_planes) && kind == kind_plane)
            s = plane_point(scene, ray, hit);
        else
            s = triangle_point(scene, hit);
    } else {
        Instance instance = scene.instances.at[hit.instance];
        if (!may_have(feature_spheres) || kind == kind_triangle) {
            s = triangle_point(scene, hit);
        } else {
            Ray local = ray;
            local.origin = transform_point(instance.to_object, ray.origin);
            local.direction = transform_vector(instance.to_object, ray.direction);
            s = sphere_point(scene, local, hit);
        }
        s.position = transform_point(instance.to_world, s.position);
        s.geometric_normal = normalize(transform_normal(instance.to_object, s.geometric_normal));
        s.shading_normal = normalize(transform_normal(instance.to_object, s.shading_normal));
        if (s.light != none) s.light += instance.light_base;
    }
    // vertex normals say where outside is, the winding only where they are missing
    if (dot(s.geometric_normal, s.shading_normal) < 0.0f) s.geometric_normal = -s.geometric_normal;
    // Seen from the other side of the shading normal than of the surface, a point would scatter into the surface only;
    // take it as flat there.
    if (dot(s.geometric_normal, ray.direction) * dot(s.shading_normal, ray.direction) <= 0.0f)
        s.shading_normal = s.geometric_normal;
    return s;
}

// A texture slot's colour, or one channel; 1 without a texture.
SNELL_FN vec3 slot_color(SNELL_IN(SceneView) scene, uint slot, SNELL_IN(SurfacePoint) surface)
{
    if (!may_have(feature_textures) || slot == none) return vec3(1.0f);
    vec4 texel = sample_texture(scene, slot, surface.uv, surface.uv_1);
    return vec3(texel.x, texel.y, texel.z);
}
SNELL_FN float slot_value(SNELL_IN(SceneView) scene, uint slot, SNELL_IN(SurfacePoint) surface)
{
    if (!may_have(feature_textures) || slot == none) return 1.0f;
    vec4 texel = sample_texture(scene, slot, surface.uv, surface.uv_1);
    return texel[scene.slots.at[slot].channel];
}

SNELL_FN vec3 emission_texture(SNELL_IN(SceneView) scene, SNELL_IN(Material) material, SNELL_IN(SurfacePoint) surface)
{
    return slot_color(scene, material.emission_slot, surface);
}

// Probability with which a ray finds the surface there instead of passing through.
SNELL_FN float surface_coverage(SNELL_IN(SceneView) scene, SNELL_IN(Material) material, SNELL_IN(SurfacePoint) surface)
{
    if (material.coverage == coverage_opaque) return 1.0f;
    float opacity = material.opacity * surface.color.w * slot_value(scene, material.opacity_slot, surface);
    if (material.coverage == coverage_mask) return opacity < material.cutoff ? 0.0f : 1.0f;
    return clamp(opacity, 0.0f, 1.0f);
}

SNELL_FN MaterialPoint material_point(SNELL_IN(SceneView) scene, Material material, SurfacePoint surface)
{
    MaterialPoint m;
    m.kind = material.kind;
    m.base_color = material.base_color * vec3(surface.color.x, surface.color.y, surface.color.z);
    m.specular = material.specular;
    if (may_have(feature_textures) && material.base_slot != none) {
        vec4 texel = sample_texture(scene, material.base_slot, surface.uv, surface.uv_1);
        vec3 color = vec3(texel.x, texel.y, texel.z);
        m.base_color = m.base_color * color;
        if ((material.flags & material_texture_tints_specular) != 0u) m.specular = m.specular * color;
    }
    m.alpha = material.alpha;
    // between equal media there is nothing to scatter at, however rough it is
    if (m.kind == material_dielectric && abs(material.ior - 1.0f) < 1e-3f) m.alpha = 0.0f;
    m.k = material.absorption;
    m.ior = material.ior;
    return m;
}

SNELL_END
#endif
