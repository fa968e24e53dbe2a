// The scene as people edit it: plain structs in vectors that refer to each other by typed index. Nobody owns anybody.
//
// Conventions: right-handed, +Y up; lengths in scene units; angles in degrees (they become radians inside); colours and
// radiances in linear Rec.709.
#pragma once

#include "snell/core/vec.h"
#include "snell/kernel/camera.h"
#include "snell/kernel/scene_view.h"
#include "snell/scene/animation.h"
#include "snell/scene/index.h"
#include "snell/scene/lens.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace snell {

// A picture that materials or the environment look up. Row 0 is the top; texture coordinate v points up.
struct Image
{
    std::string name;
    uint width = 0, height = 0;
    uint format = texels_rgba8_srgb; // texels_*
    std::vector<std::uint8_t> bytes; // 4 a texel, for the rgba8 formats
    std::vector<float> floats;       // 4 a texel, for texels_rgba32f
};

// How an image is looked up: packed as a TextureSlot. The image is read at (dot(row_u, (u, v, 1)), dot(row_v, (u, v,
// 1))).
struct TextureRef
{
    Index<Image> image;                              // not valid: no texture, a factor of 1
    uint uv_set = 0;                                 // 0: Mesh::uvs, 1: Mesh::uvs_1
    uint wrap_u = wrap_repeat, wrap_v = wrap_repeat; // wrap_*
    uint filter = filter_bilinear;                   // filter_*
    uint channel = 0;                                // where one number is wanted: red 0, green 1, blue 2, alpha 3
    vec3 row_u{1, 0, 0}, row_v{0, 1, 0};

    bool valid() const { return image.valid(); }
    bool operator==(const TextureRef&) const = default;
};

// What material_principled has beyond base colour, ior and absorption: the parameters of glTF 2.0's extensions, with
// their defaults. Textures multiply the number above them unless said otherwise.
struct PrincipledDesc
{
    float metallic = 0.0f; // in [0, 1]
    TextureRef metallic_texture;
    float roughness = 0.5f; // perceptual, in [0, 1]: GGX alpha is its square
    TextureRef roughness_texture;
    float specular = 1.0f; // strength of the dielectric reflection, in [0, 1]
    TextureRef specular_texture;
    vec3 specular_color{1.0f}; // of that at normal incidence, >= 0
    TextureRef specular_color_texture;
    float clearcoat = 0.0f;
    TextureRef clearcoat_texture;
    float clearcoat_roughness = 0.0f;
    TextureRef clearcoat_roughness_texture;
    TextureRef clearcoat_normal_texture;
    float clearcoat_normal_scale = 1.0f;
    vec3 sheen_color{0.0f}; // in [0, 1]
    TextureRef sheen_color_texture;
    float sheen_roughness = 0.0f;
    TextureRef sheen_roughness_texture;
    float transmission = 0.0f; // in [0, 1]
    TextureRef transmission_texture;
    bool thin_walled = true; // light goes straight through; false: the surface of a solid that refracts and absorbs
    float anisotropy = 0.0f; // strength in [0, 1]
    float anisotropy_rotation = 0.0f; // radians, from the tangent counter-clockwise
    TextureRef anisotropy_texture;    // red and green: a direction as in a normal map; blue: strength
    float iridescence = 0.0f;
    TextureRef iridescence_texture;
    float iridescence_ior = 1.3f;
    float iridescence_thickness_min = 100.0f, iridescence_thickness_max = 400.0f; // nanometres
    TextureRef iridescence_thickness_texture; // chooses between minimum and maximum, which is without texture
    float dispersion = 0.0f;                  // 20 / Abbe number
    float diffuse_transmission = 0.0f;        // in [0, 1]
    TextureRef diffuse_transmission_texture;
    vec3 diffuse_transmission_color{1.0f};
    TextureRef diffuse_transmission_color_texture;
};

// A surface's scattering model; fields mean what they mean in the packed Material.
struct MaterialDesc
{
    std::string name;
    uint kind = material_diffuse;
    vec3 base_color{0.8f};
    vec3 emission{0.0f};
    bool two_sided_emission = false;
    float alpha = 0.0f; // GGX; principled materials have a roughness instead
    vec3 specular{0.0f};
    float ior = 1.5f;
    vec3 absorption{0.0f};
    TextureRef base_texture;             // multiplies base_color
    bool texture_tints_specular = false; // and specular
    TextureRef emission_texture;         // multiplies emission
    TextureRef normal_texture;           // tangent space, green up
    float normal_scale = 1.0f;           // of the normal's x and y
    // How much of the surface is there. opacity times one channel of opacity_texture times the vertex colours' fourth
    // number is a probability (coverage_blend) or compared with the cutoff (coverage_mask: below, there is nothing).
    uint coverage = coverage_opaque;
    float opacity = 1.0f, cutoff = 0.5f;
    TextureRef opacity_texture;
    bool single_sided = false; // camera rays see nothing of it from behind
    PrincipledDesc principled; // for material_principled
};

// A triangle mesh. Attributes are per vertex and either empty or as long as positions.
struct Mesh
{
    std::string name;
    std::vector<vec3> positions;
    std::vector<vec3> normals;
    std::vector<vec4> tangents; // xyz unit length, the way u grows; w: -1 if the bitangent is cross(tangent, normal)
    std::vector<vec2> uvs, uvs_1;
    std::vector<vec4> colors; // linear Rec.709, and opacity
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
    Index<Node> node{}; // if valid, pose() keeps transform equal to that node's
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
    Index<Node> node{};                // if valid, pose() puts the light at its origin, shining along its -Z
};

// How a camera maps directions to its picture: docs/cameras.md.
struct CameraModel
{
    uint kind = camera_pinhole;          // camera_*
    float lens_radius = 0.0f;            // of a thin lens (pinhole); 0: everything is sharp
    float focus_distance = 0.0f;         // of thin and traced lenses; 0: as far as the target
    uint blades = 0;                     // of the aperture; fewer than 3: a circle
    float blade_rotation_degrees = 0.0f; // counter-clockwise, seen from behind the camera
    float half_side = 0.0f;      // orthographic: of what the picture's shorter side shows; 0: as CameraDesc has it
    float eye_distance = 0.064f; // between the pupils, of an HMD: in the scene's units, which should be metres
    std::array<float, 9> k{};    // Camera::k
    // What a calibration has measured, in pixels of a picture of calibrated_width times calibrated_height, in place of
    // the field of view. calibrated_width 0: nothing. Kannala-Brandt and Brown-Conrady only.
    vec2 focal{0.0f}, center{0.0f}; // center: (0.5, 0.5) is the middle of the upper left pixel
    float calibrated_width = 0.0f, calibrated_height = 0.0f;
    // Of a traced lens. It sees what it sees: the field of view is that of lens and film.
    LensPrescription lens;
    float film_diagonal = 43.2666f; // millimetres, which the picture's diagonal has on the film; 36 mm x 24 mm
    float stop_diameter = 0.0f;     // of the aperture stop, millimetres; 0: fully open
    float millimetre = 0.001f;      // in the scene's units
    bool operator==(const CameraModel&) const = default;
};

// A camera. fov is the full angle of the picture's shorter side (of an HMD: of one eye's half). An orthographic one
// without a size of its own shows as much as a pinhole would at the target.
struct CameraDesc
{
    std::string name;
    vec3 eye{0.0f, 0.0f, 5.0f};
    vec3 target{0.0f};
    vec3 up{0.0f, 1.0f, 0.0f};
    float fov_degrees = 40.0f;
    bool mirrored = false; // the picture's left and right are exchanged
    Index<Node> node{};    // if valid, pose() puts the eye at its origin, looking along its -Z with +Y up
    CameraModel model{};
};

// Light from infinitely far away, in all directions.
struct EnvironmentDesc
{
    vec3 radiance{0.0f};                        // of a constant environment; else what the image is multiplied with
    Index<Image> image;                         // a latitude-longitude map or an octahedral one
    uint mapping = environment_equirectangular; // environment_*, says where its texels lie
    Transform to_world{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}; // of directions: a rotation, perhaps with a mirror
    bool visible = true; // false: camera rays see black with an alpha of 0 instead
};

// What a file asks its renderer for. The command line's own options go first.
struct RenderHints
{
    std::optional<int> width, height;
    std::optional<std::array<float, 4>> crop_window; // x0 x1 y0 y1, parts of the picture
    std::optional<uint> spp, seed;
    std::optional<std::string> sampler, integrator, output;
    std::optional<uint> max_depth;
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
    EnvironmentDesc environment;
    std::vector<Node> nodes; // what moves, see animation.h
    std::vector<Skin> skins;
    std::vector<Rig> rigs;
    std::vector<Animation> animations;
    std::vector<std::string> variants; // names of the sets of materials that the file offers
    RenderHints hints;
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

// A scene without any light of its own (see lit.h) gets a neutral studio around it (see studio.h), turned for its first
// camera; it must have one.
void complete_light(Scene& scene);

// Both of them. What was added is noted.
void complete(Scene& scene, float aspect);

} // namespace snell
