// The scene as people edit it: plain structs in vectors that refer to each other by typed index. Nobody owns anybody.
//
// Conventions: right-handed, +Y up; lengths in scene units; angles in degrees (they become radians inside); colours and
// radiances in linear Rec.709.
#pragma once

#include "snell/core/vec.h"
#include "snell/kernel/scene_view.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace snell {

// An index into the vector of T of one Scene.
template <class T>
struct Index
{
    uint value = none;

    bool valid() const { return value != none; }
    bool operator==(const Index&) const = default;
};

// A picture that a material looks up. Row 0 is the top; texture coordinate v points up.
struct Image
{
    std::string name;
    uint width = 0, height = 0;
    uint format = texels_rgba8_srgb; // texels_*
    uint wrap = wrap_repeat;         // wrap_*
    std::vector<std::uint8_t> bytes; // 4 a texel, for the rgba8 formats
    std::vector<float> floats;       // 4 a texel, for texels_rgba32f
};

// A surface's scattering model; fields mean what they mean in the packed Material.
struct MaterialDesc
{
    std::string name;
    uint kind = material_diffuse;
    vec3 base_color{0.8f};
    vec3 emission{0.0f};
    bool two_sided_emission = false;
    float alpha = 0.0f;
    vec3 specular{0.0f};
    float ior = 1.5f;
    vec3 absorption{0.0f};
    Index<Image> base_texture;           // multiplies base_color
    bool texture_tints_specular = false; // and specular
};

// A triangle mesh. Attributes are per vertex and either empty or as long as positions.
struct Mesh
{
    std::string name;
    std::vector<vec3> positions;
    std::vector<vec3> normals;
    std::vector<vec2> uvs;
    std::vector<vec3> colors; // linear Rec.709
    std::vector<uvec3> triangles;
    std::vector<Index<MaterialDesc>> triangle_materials; // one a triangle, or empty: all have `material`
    Index<MaterialDesc> material;
};

struct SphereDesc
{
    std::string name;
    vec3 center{0.0f};
    float radius = 1.0f;
    Index<MaterialDesc> material;
};

struct PlaneDesc
{
    std::string name;
    vec3 point{0.0f};
    vec3 normal{0.0f, 1.0f, 0.0f}; // any length but 0
    Index<MaterialDesc> material;
};

// Meshes and spheres that are placed together, once or a million times.
struct Group
{
    std::string name;
    std::vector<Index<Mesh>> meshes;
    std::vector<Index<SphereDesc>> spheres;
};

struct InstanceDesc
{
    std::string name;
    Index<Group> group;
    Transform transform{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}; // object to world; must be invertible
};

struct LightDesc
{
    std::string name;
    uint kind = light_point;           // light_point, light_directional or light_spot
    vec3 position{0.0f};               // point, spot
    vec3 direction{0.0f, -1.0f, 0.0f}; // directional, spot: the way the light travels
    vec3 emission{1.0f};               // point, spot: W/sr; directional: W/m2 on a facing surface
    float inner_degrees = 30.0f;       // spot: half angle of the cone of full intensity
    float outer_degrees = 45.0f;       // spot: half angle beyond which nothing is lit
};

// A pinhole camera. fov is the full angle of the picture's shorter side.
struct CameraDesc
{
    std::string name;
    vec3 eye{0.0f, 0.0f, 5.0f};
    vec3 target{0.0f};
    vec3 up{0.0f, 1.0f, 0.0f};
    float fov_degrees = 40.0f;
};

// What loading, repairing and completing a scene has to say.
struct Note
{
    enum class Kind
    {
        info,
        warning
    };
    Kind kind = Kind::info;
    std::string text; // begins with "file:line: " where it has a place
};

struct Scene
{
    std::string name;
    std::vector<Image> images;
    std::vector<MaterialDesc> materials;
    std::vector<Mesh> meshes;
    std::vector<SphereDesc> spheres;
    std::vector<PlaneDesc> planes;
    std::vector<Group> groups;
    std::vector<InstanceDesc> instances;
    std::vector<LightDesc> lights;
    std::vector<CameraDesc> cameras;
    vec3 environment{0.0f}; // constant radiance from everywhere
    std::vector<Note> notes;
};

// Append to the scene and say where it went.
Index<Image> add(Scene& scene, Image image);
Index<MaterialDesc> add(Scene& scene, MaterialDesc material);
Index<Mesh> add(Scene& scene, Mesh mesh);
Index<SphereDesc> add(Scene& scene, SphereDesc sphere);
Index<Group> add(Scene& scene, Group group);
void add(Scene& scene, PlaneDesc plane);
void add(Scene& scene, InstanceDesc instance);
void add(Scene& scene, LightDesc light);
void add(Scene& scene, CameraDesc camera);

// Put one mesh or sphere into the world, in a group of its own. The mesh or sphere is appended as well.
void place(Scene& scene, Mesh mesh, const Transform& transform = InstanceDesc{}.transform);
void place(Scene& scene, SphereDesc sphere);

void note(Scene& scene, Note::Kind kind, std::string text);

// Maps for InstanceDesc::transform. compose(a, b) applies b first.
Transform identity_transform();
Transform translation(vec3 offset);
Transform scaling(vec3 factors);
Transform rotation(vec3 axis, float degrees);
Transform compose(const Transform& a, const Transform& b);
// The inverse map; empty if the transform is singular or not finite.
std::optional<Transform> inverse(const Transform& m);
// By how much the map scales volumes; negative if it mirrors.
float determinant(const Transform& m);
// The factor by which the map scales all lengths; 0 if that depends on the direction.
float uniform_scale(const Transform& m);

struct Bounds
{
    vec3 lower{1e30f}, upper{-1e30f};
    bool empty() const { return !(lower.x <= upper.x && lower.y <= upper.y && lower.z <= upper.z); }
    void extend(vec3 p) { lower = min(lower, p), upper = max(upper, p); }
    vec3 center() const { return 0.5f * lower + 0.5f * upper; }
    vec3 extent() const { return upper - lower; }
};

// World bounds of all instances (planes are infinite and left out). Non-finite vertices are ignored.
Bounds scene_bounds(const Scene& scene);

// Mend what can be mended and note it: triangles with a NaN or infinite vertex or without area are dropped,
// zero or non-finite normals are replaced, non-finite materials and lights reset, colours above 1 scaled.
// Throws Error on what has no meaning: an index out of range, attributes of the wrong length, a singular transform.
void validate(Scene& scene);

// A scene without camera gets one that frames it: at level into a room that is open in front, else a little from above,
// looking along -Z (with another `up`: as one would after turning the scene that way). aspect: width over height.
void complete_camera(Scene& scene, float aspect, vec3 up = vec3(0.0f, 1.0f, 0.0f));

// A scene without any light gets white light from everywhere and a directional one from above the left of its first
// camera; it must have one.
void complete_light(Scene& scene);

// Both of them. What was added is noted.
void complete(Scene& scene, float aspect);

} // namespace snell
