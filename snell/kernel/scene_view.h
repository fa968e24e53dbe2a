// The scene as kernels see it: flat arrays of small structs, byte for byte the same on CPU and GPU.
#ifndef SNELL_KERNEL_SCENE_VIEW_H
#define SNELL_KERNEL_SCENE_VIEW_H
#include "snell/kernel/lang.h"
SNELL_BEGIN

// Kinds of material: which scattering model a surface has.
SNELL_CONST uint material_diffuse = 0u; // Lambert
SNELL_CONST uint material_mirror = 1u;  // perfect mirror of reflectance base_color
SNELL_CONST uint material_mix = 2u;     // diffuse base_color plus specular reflection (a mirror, or GGX if alpha > 0)
SNELL_CONST uint material_dielectric = 3u; // Fresnel reflection and refraction; smooth, or GGX if alpha > 0
SNELL_CONST uint material_conductor = 4u;  // Fresnel reflection of a metal; smooth, or GGX if alpha > 0
SNELL_CONST uint material_unlit = 5u;      // shines with base_color on both sides and scatters nothing
SNELL_CONST uint material_principled = 6u; // metallic-roughness and the layers around it: see principled.h
SNELL_CONST uint material_kinds = 7u;

// Flags of a material.
SNELL_CONST uint material_two_sided_emission = 1u;     // emits from the back as well
SNELL_CONST uint material_texture_tints_specular = 2u; // base_texture multiplies specular too, as a metal's does
SNELL_CONST uint material_needs_tangents = 4u;         // has a normal map or is anisotropic

SNELL_CONST uint material_single_sided = 8u;           // camera rays see nothing of it from behind

// How much of a surface is there.
SNELL_CONST uint coverage_opaque = 0u;
SNELL_CONST uint coverage_mask = 1u;  // nothing where opacity is below the cutoff
SNELL_CONST uint coverage_blend = 2u; // opacity is the probability of a ray to find it

// "slot": index of a texture slot, or none.
struct Material
{
    vec3 base_color;    // diffuse albedo, mirror reflectance, or tint of a dielectric, each in [0, 1]
    uint kind;          // material_*
    vec3 emission;      // radiance emitted on the side of the normal, >= 0
    float alpha;        // GGX roughness alpha; 0 is perfectly smooth
    vec3 specular;      // mix: specular reflectance in [0, 1]; conductor: eta
    float ior;          // dielectric: index of refraction inside over outside
    vec3 absorption;    // dielectric: Beer-Lambert coefficient inside, per scene unit; conductor: k
    uint flags;         // material_* flags
    uint base_slot;     // multiplies base_color
    uint emission_slot; // multiplies emission
    uint normal_slot;   // normal map
    float normal_scale; // of its x and y
    uint coverage;      // coverage_*
    float opacity;      // times opacity_slot and the vertex colours' fourth number
    float cutoff;       // of coverage_mask
    uint opacity_slot;
    uint principled; // index into the principled parameters, for material_principled
};
SNELL_LAYOUT(Material, 100)

// The parameters of material_principled beyond those of Material; what they mean: PrincipledDesc in scene.h.
struct Principled
{
    float metallic;
    float roughness;
    float specular;
    float clearcoat;
    float clearcoat_roughness;
    float clearcoat_normal_scale;
    vec3 specular_color;
    vec3 sheen_color;
    float sheen_roughness;
    float transmission;
    uint thin_walled;
    float anisotropy;
    float anisotropy_rotation;
    float iridescence;
    float iridescence_ior;
    float iridescence_thickness_min;
    float iridescence_thickness_max;
    float dispersion;
    float diffuse_transmission;
    vec3 diffuse_transmission_color;
    uint metallic_slot;
    uint roughness_slot;
    uint specular_slot;
    uint specular_color_slot;
    uint clearcoat_slot;
    uint clearcoat_roughness_slot;
    uint clearcoat_normal_slot;
    uint sheen_color_slot;
    uint sheen_roughness_slot;
    uint transmission_slot;
    uint anisotropy_slot;
    uint iridescence_slot;
    uint iridescence_thickness_slot;
    uint diffuse_transmission_slot;
    uint diffuse_transmission_color_slot;
    uint glass_table; // where the albedos of rough glass of this ior begin in SceneView::albedo, or none
};
SNELL_LAYOUT(Principled, 168)

// Kinds of light source.
SNELL_CONST uint light_point = 0u;       // intensity [W/sr] at position
SNELL_CONST uint light_directional = 1u; // irradiance on a facing surface; direction points from the light
SNELL_CONST uint light_spot = 2u;        // intensity on the axis, falling off smoothly between two cone angles
SNELL_CONST uint light_triangle = 3u;    // an emissive triangle
SNELL_CONST uint light_sphere = 4u;      // an emissive sphere

// Flags of a light.
SNELL_CONST uint light_two_sided = 1u; // triangle, sphere: emits on both sides
SNELL_CONST uint light_textured = 2u;  // triangle, sphere: emission is multiplied by what light_texture() looks up
SNELL_CONST uint light_mirrored = 4u;  // triangle: the last two vertices are exchanged against the packed primitive

struct Light
{
    vec3 position;    // point, spot: where; sphere: world centre; triangle: first vertex in world space
    uint kind;        // light_*
    vec3 direction;   // directional, spot: unit axis along which light travels; triangle: edge to the second vertex
    float cos_inner;  // spot: full intensity inside this cosine; sphere: world radius
    vec3 edge;        // triangle: edge to the third vertex
    float cos_outer;  // spot: nothing outside this cosine; triangle: area
    vec3 emission;    // intensity, irradiance or radiance
    uint flags;       // light_* flags
    uint primitive;   // triangle, sphere: packed primitive as in Hit; else none
    uint instance;    // as in Hit
    float select_pdf; // probability with which the light sampler chooses this light
    float alias_threshold; // alias method (Vose 1991): keep this entry if the fraction is below, else take alias
    uint alias;
    vec3 normal; // triangle: unit length, on the side that shines
};
SNELL_LAYOUT(Light, 96)

// A triangle of a mesh: three indices into positions, and the surface it belongs to.
struct Triangle
{
    uint v0, v1, v2;
    uint surface;
};
SNELL_LAYOUT(Triangle, 16)

// What the triangles of one mesh with one material have in common. They are consecutive in the triangle array. An
// attribute of vertex v is found at (v - first_vertex + base) of its array; a base of none: the mesh has no such thing.
struct Surface
{
    uint material;
    uint object;         // number of the mesh in the Scene, for the ObjectID picture
    uint first_vertex;   // of the mesh, in positions
    uint normal_base;    // shading normals
    uint uv_base;        // texture coordinates
    uint color_base;     // vertex colours, linear Rec.709 and opacity; they multiply base_color and opacity
    uint first_triangle; // of this surface
    uint first_light;    // light of first_triangle; none: not emissive. Relative to the instance's light base
    uint uv_1_base;      // second texture coordinates
    uint tangent_base;   // tangents and the sign of the bitangent
};
SNELL_LAYOUT(Surface, 40)

struct Sphere
{
    vec3 center;
    float radius;
    uint material;
    uint object;
    uint light; // as Surface::first_light
    uint pad0;
};
SNELL_LAYOUT(Sphere, 32)

// The points p with dot(normal, p) == offset.
struct Plane
{
    vec3 normal; // unit length
    float offset;
    uint material;
    uint object;
    uint pad0, pad1;
};
SNELL_LAYOUT(Plane, 32)

// Three rows of an affine map: p -> (dot(x, (p, 1)), dot(y, (p, 1)), dot(z, (p, 1))).
struct Transform
{
    vec4 x, y, z;
};
SNELL_LAYOUT(Transform, 48)

struct Instance
{
    Transform to_world;
    Transform to_object;
    uint group;      // index into the packed groups
    uint light_base; // first light of this instance; added to Surface::first_light and Sphere::light
    uint object;     // number of the instance in the Scene
    uint pad0;
};
SNELL_LAYOUT(Instance, 112)

// Texel formats, and how coordinates outside [0, 1] are taken.
SNELL_CONST uint texels_rgba8_linear = 0u;
SNELL_CONST uint texels_rgba8_srgb = 1u;
SNELL_CONST uint texels_rgba32f = 2u;
SNELL_CONST uint wrap_repeat = 0u;
SNELL_CONST uint wrap_mirror = 1u;
SNELL_CONST uint wrap_clamp = 2u;
SNELL_CONST uint filter_bilinear = 0u;
SNELL_CONST uint filter_nearest = 1u;

struct Texture
{
    uint offset; // of the first texel, in words of the texel array; row 0 is the top row (v = 1)
    uint width, height;
    uint format; // texels_*
};
SNELL_LAYOUT(Texture, 16)

// How a material looks up a texture.
struct TextureSlot
{
    uint texture;
    uint uv_set;         // 0 or 1: which of the surface's texture coordinates
    uint wrap_u, wrap_v; // wrap_*
    uint filter_mode;    // filter_*
    uint channel;        // where one number is wanted
    vec3 row_u, row_v;   // the texture is read at (dot(row_u, (u, v, 1)), dot(row_v, (u, v, 1)))
};
SNELL_LAYOUT(TextureSlot, 48)

// Where the texels of an environment lie.
SNELL_CONST uint environment_equirectangular = 0u; // rows are latitudes; +Y is up, -Z in the middle, +X right of it
SNELL_CONST uint environment_octahedral = 1u;      // equal areas (Clarberg 2008), as pbrt has them; +Z in the middle

// Light from infinitely far away.
struct Environment
{
    vec3 radiance;            // constant, or what the texture is multiplied with
    uint texture;             // or none
    vec3 row_x, row_y, row_z; // world to environment: its coordinates are the dot products with a direction
    uint mapping;             // environment_*
    uint is_visible;          // 0: camera rays do not see it
    uint columns, rows;       // of the cells that it is sampled by; 0 if it is constant
    float select_pdf;         // probability with which the light sampler chooses the environment
};
SNELL_LAYOUT(Environment, 72)

SNELL_ARRAY(Vec3Array, vec3)
SNELL_ARRAY(Vec4Array, vec4)
SNELL_ARRAY(Vec2Array, vec2)
SNELL_ARRAY(FloatArray, float)
SNELL_ARRAY(WordArray, uint)
SNELL_ARRAY(TriangleArray, Triangle)
SNELL_ARRAY(SurfaceArray, Surface)
SNELL_ARRAY(SphereArray, Sphere)
SNELL_ARRAY(PlaneArray, Plane)
SNELL_ARRAY(InstanceArray, Instance)
SNELL_ARRAY(MaterialArray, Material)
SNELL_ARRAY(LightArray, Light)
SNELL_ARRAY(TextureArray, Texture)
SNELL_ARRAY(TextureSlotArray, TextureSlot)
SNELL_ARRAY(PrincipledArray, Principled)

// What SceneView::coverage says of a scene; 0: rays meet all that lies in their way.
SNELL_CONST uint scene_has_holes = 1u;        // some material is not coverage_opaque
SNELL_CONST uint scene_has_single_sided = 2u; // some material is material_single_sided

// Everything a kernel may look up. Primitives of one group (and those in world space) are consecutive.
struct SceneView
{
    Vec3Array positions;
    Vec3Array normals;
    Vec2Array uvs;
    Vec4Array tangents;
    Vec4Array colors;
    TriangleArray triangles;
    SurfaceArray surfaces;
    SphereArray spheres;
    PlaneArray planes;
    InstanceArray instances;
    MaterialArray materials;
    LightArray lights;
    TextureArray textures;
    WordArray texels;
    FloatArray srgb; // 256 entries: sRGB byte to linear value
    TextureSlotArray slots;
    PrincipledArray principled;
    FloatArray albedo;          // tables of directional albedos, see albedo.h
    FloatArray environment_cdf; // of the environment's cells, see environment.h
    uint light_count;
    uint plane_count;
    uint delta_light_count; // point, directional and spot lights come first in `lights`
    uint coverage;          // scene_has_* flags
    Environment environment;
    vec3 scene_center;
    float scene_radius; // of a sphere around all bounded primitives
};
SNELL_LAYOUT(SceneView, 256)

SNELL_FN vec3 transform_point(Transform m, vec3 p)
{
    return vec3(m.x.x * p.x + m.x.y * p.y + m.x.z * p.z + m.x.w, m.y.x * p.x + m.y.y * p.y + m.y.z * p.z + m.y.w,
                m.z.x * p.x + m.z.y * p.y + m.z.z * p.z + m.z.w);
}

SNELL_FN vec3 transform_vector(Transform m, vec3 d)
{
    return vec3(m.x.x * d.x + m.x.y * d.y + m.x.z * d.z, m.y.x * d.x + m.y.y * d.y + m.y.z * d.z,
                m.z.x * d.x + m.z.y * d.y + m.z.z * d.z);
}

// A normal transforms by the transpose of the inverse; give the inverse map. The result has no unit length.
SNELL_FN vec3 transform_normal(Transform inverse_map, vec3 n)
{
    return vec3(inverse_map.x.x * n.x + inverse_map.y.x * n.y + inverse_map.z.x * n.z,
                inverse_map.x.y * n.x + inverse_map.y.y * n.y + inverse_map.z.y * n.z,
                inverse_map.x.z * n.x + inverse_map.y.z * n.y + inverse_map.z.z * n.z);
}

SNELL_END
#endif
