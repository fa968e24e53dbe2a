// Tangent frames: which way the texture coordinates grow along a surface, for normal maps and anisotropy.
#ifndef SNELL_KERNEL_TANGENT_H
#define SNELL_KERNEL_TANGENT_H
#include "snell/kernel/surface.h"
SNELL_BEGIN

// World directions in which u and v grow, of any length; zero where the mesh does not say.
struct Tangents
{
    vec3 u, v;
};

// Those of the mesh's vertices, or else the derivatives of the texture coordinates. In object space.
SNELL_FN Tangents triangle_tangents(SNELL_IN(SceneView) scene, SNELL_IN(Hit) hit, uint uv_set)
{
    Triangle triangle = scene.triangles.at[primitive_index(hit.primitive)];
    Surface surface = scene.surfaces.at[triangle.surface];
    uint i0 = triangle.v0 - surface.first_vertex;
    uint i1 = triangle.v1 - surface.first_vertex;
    uint i2 = triangle.v2 - surface.first_vertex;
    Tangents t;
    t.u = vec3(0.0f);
    t.v = vec3(0.0f);
    if (surface.tangent_base != none && surface.normal_base != none) {
        float w = 1.0f - hit.u - hit.v;
        vec4 tangent = w * scene.tangents.at[surface.tangent_base + i0] +
                       hit.u * scene.tangents.at[surface.tangent_base + i1] +
                       hit.v * scene.tangents.at[surface.tangent_base + i2];
        vec3 n = w * scene.normals.at[surface.normal_base + i0] + hit.u * scene.normals.at[surface.normal_base + i1] +
                 hit.v * scene.normals.at[surface.normal_base + i2];
        t.u = vec3(tangent.x, tangent.y, tangent.z);
        t.v = cross(n, t.u) * (tangent.w < 0.0f ? -1.0f : 1.0f);
        return t;
    }
    uint base = uv_set == 0u ? surface.uv_base : surface.uv_1_base;
    if (base == none) return t;
    vec3 p0 = scene.positions.at[triangle.v0];
    vec3 e1 = scene.positions.at[triangle.v1] - p0;
    vec3 e2 = scene.positions.at[triangle.v2] - p0;
    vec2 uv0 = scene.uvs.at[base + i0];
    vec2 d1 = scene.uvs.at[base + i1] - uv0;
    vec2 d2 = scene.uvs.at[base + i2] - uv0;
    float determinant = d1.x * d2.y - d1.y * d2.x;
    if (determinant == 0.0f) return t;
    float s = determinant < 0.0f ? -1.0f : 1.0f; // lengths do not matter: no division that could overflow
    t.u = s * (d2.y * e1 - d1.y * e2);
    t.v = s * (d1.x * e2 - d2.x * e1);
    return t;
}

SNELL_FN Tangents surface_tangents(SNELL_IN(SceneView) scene, SNELL_IN(SurfacePoint) surface, SNELL_IN(Hit) hit,
                                   uint uv_set)
{
    Tangents t;
    uint kind = primitive_kind(hit.primitive);
    if (kind == kind_plane) {
        Frame frame = make_frame(scene.planes.at[primitive_index(hit.primitive)].normal);
        t.u = frame.s;
        t.v = frame.t;
        return t;
    }
    if (kind == kind_triangle) {
        t = triangle_tangents(scene, hit, uv_set);
    } else {
        vec3 n = surface.geometric_normal;
        if (hit.instance != none) { // normals go back by the transpose of the way there
            Transform map = scene.instances.at[hit.instance].to_world;
            n = transform_normal(map, n);
        }
        t.u = vec3(n.z, 0.0f, -n.x);
        t.v = cross(n, t.u);
    }
    if (hit.instance != none) {
        Transform map = scene.instances.at[hit.instance].to_world;
        t.u = transform_vector(map, t.u);
        t.v = transform_vector(map, t.v);
    }
    return t;
}

// An orthonormal frame around n whose s points along t.u as far as it can; any one if that is zero or along n.
SNELL_FN Frame make_tangent_frame(vec3 n, vec3 tangent)
{
    vec3 s = tangent - dot(tangent, n) * n;
    float l2 = dot(s, s);
    if (!(l2 > 1e-12f * dot(tangent, tangent))) return make_frame(n);
    Frame frame;
    frame.s = s / sqrt(l2);
    frame.t = cross(n, frame.s);
    frame.n = n;
    return frame;
}

// The normal m of a bump, turned as little as it takes to make sense for light that goes to `back`: seen from its
// front, where otherwise the surface would show its inside, and mirroring what lies above the true surface, where
// otherwise bumps of metal would have black rims. All of them have unit length; n, the normal without bumps, and the
// geometric normal are on the side of `back`.
SNELL_FN vec3 visible_normal(vec3 m, vec3 n, vec3 geometric_normal, vec3 back)
{
    vec3 facing = m;
    float cosine = dot(m, back);
    float least = min(0.01f, dot(n, back)); // as grazing as that it may become
    if (cosine < least) facing = normalize(m + (least - cosine) * back);
    vec3 mirrored = (2.0f * dot(facing, back)) * facing - back;
    float height = dot(mirrored, geometric_normal);
    float lowest = min(0.01f, 0.5f * dot(back, geometric_normal));
    if (height >= lowest) return facing;
    mirrored = normalize(mirrored + (lowest - height) * geometric_normal);
    vec3 between = mirrored + back;
    return dot(between, between) > 1e-8f ? normalize(between) : n;
}

// The normal that a normal map's slot gives, in the world; unit length, on the side of n that `back` (towards where the
// ray came from) is on.
SNELL_FN vec3 mapped_normal(SNELL_IN(SceneView) scene, SNELL_IN(SurfacePoint) surface, SNELL_IN(Hit) hit, uint slot,
                            float scale, vec3 back)
{
    vec3 n = surface.shading_normal;
    Tangents t = surface_tangents(scene, surface, hit, scene.slots.at[slot].uv_set);
    float lu = dot(t.u, t.u);
    float lv = dot(t.v, t.v);
    if (!(lu > 0.0f) || !(lv > 0.0f) || !is_finite(lu) || !is_finite(lv)) return n;
    vec4 texel = sample_texture(scene, slot, surface.uv, surface.uv_1);
    vec3 m = (scale * (2.0f * texel.x - 1.0f) / sqrt(lu)) * t.u + (scale * (2.0f * texel.y - 1.0f) / sqrt(lv)) * t.v +
             max(2.0f * texel.z - 1.0f, 0.0f) * n;
    float l2 = dot(m, m);
    if (!(l2 > 1e-12f)) return n;
    float side = dot(n, back) < 0.0f ? -1.0f : 1.0f;
    return side * visible_normal((side / sqrt(l2)) * m, side * n,
                                 dot(surface.geometric_normal, back) < 0.0f ? -surface.geometric_normal
                                                                            : surface.geometric_normal,
                                 back);
}

SNELL_END
#endif
