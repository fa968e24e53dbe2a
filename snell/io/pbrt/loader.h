// What the parts of the pbrt reader share while one file is read.
#pragma once

#include "snell/io/load.h"
#include "snell/io/pbrt/notes.h"
#include "snell/io/pbrt/parameters.h"
#include "snell/io/pbrt/spectrum.h"
#include "snell/io/pbrt/transform.h"
#include "snell/io/reference.h"

#include <array>
#include <deque>
#include <map>
#include <memory>
#include <tuple>

namespace snell::pbrt {

// A number or colour over a surface: a constant, or a constant times a picture.
struct TextureValue
{
    vec3 factor{1.0f};
    TextureRef ref;

    bool is_constant() const { return !ref.valid(); }
};

// A named texture as the file has it. Inputs are numbers of other textures that came before.
struct TextureNode
{
    enum class Kind
    {
        value,
        scale, // input 0 times input 1
        mix,   // from input 0 to input 1 by input 2
        checkerboard,
        bilerp
    };
    Kind kind = Kind::value;
    TextureValue value;
    std::array<uint, 3> input{none, none, none};
    std::array<vec3, 4> corners{}; // bilerp: at (u, v) = (0, 0), (0, 1), (1, 0), (1, 1)
    vec3 row_u{1, 0, 0}, row_v{0, 1, 0};
    uint cost = 1; // textures that are looked up for one value
    bool is_baked = false;
    Spot spot;
};

// A material as the file has it; what stands in the scene also depends on the light, the medium and the opacity that a
// shape has.
struct MaterialUse
{
    uint area_light = none;
    float light_scale = 1.0f;
    uint medium = none;
    float opacity = 1.0f;
    uint alpha = none; // a texture instead
    bool keeps_light = true;
    auto operator<=>(const MaterialUse&) const = default;
};
struct MaterialEntry
{
    MaterialDesc desc;
    bool is_interface = false; // scatters nothing: only the border of a medium
    bool is_defined = true;    // false: it has been named, and its definition may follow
    std::map<MaterialUse, Index<MaterialDesc>> uses;
};

struct AreaLight
{
    vec3 radiance{1.0f};
    TextureRef image;
    bool two_sided = false;
    float power = 0.0f; // of each shape, W; 0: the radiance is meant as it is
};

struct Medium
{
    vec3 absorption{0.0f};
    bool scatters = false;
    std::string name;
};

// What a LookAt said.
struct Look
{
    glm::dvec3 eye, target, up;
};

using Defaults = std::shared_ptr<const std::vector<Parameter>>;

struct GraphicsState
{
    std::array<Matrix, 2> ctm{Matrix(1.0), Matrix(1.0)}; // object to world when the shutter opens, and when it closes
    uint active = 3;                                     // bits of those that directives change
    bool reverse_orientation = false;
    std::shared_ptr<MaterialEntry> material;
    uint area_light = none;
    uint inside = none, outside = none; // media
    const ColorSpace* space = nullptr;
    std::map<std::string, Defaults, std::less<>> defaults; // of the directive Attribute, by its target
};

// A picture that is decoded when somebody needs its texels, at last all together.
struct PendingImage
{
    std::filesystem::path path;
    bool is_color = true;   // else the values are as they are in the file
    bool is_number = false; // three channels become their mean
    bool is_inverted = false;
    float gamma = 0.0f; // to decode 8-bit values with; 0: not that way
    Spot spot;
    bool is_loaded = true;
    std::string trouble;
};

// A .ply file and the meshes that are to come of it.
struct PlyUse
{
    Index<Mesh> mesh;
    std::optional<Matrix> baked;
    bool is_flipped = false;
};
struct PlyFile
{
    std::filesystem::path path;
    Spot spot;
    std::vector<PlyUse> uses;
};

// CoordinateSystem "camera:front" names the camera behind it; pbrt passes over that.
inline constexpr std::string_view camera_mark = "camera:";

struct Loader
{
    Loader(const std::filesystem::path& file, const LoadOptions& load_options);

    const LoadOptions& options;
    std::filesystem::path main_file;
    Scene scene;
    Notes notes;
    References references;
    SpectrumReader spectra;

    bool is_v3 = false;
    bool in_world = false;
    std::filesystem::path folder; // of the file that is being read
    GraphicsState state;
    std::map<std::string, std::array<Matrix, 2>> coordinate_systems;
    std::map<std::string, std::shared_ptr<MaterialEntry>> materials;
    std::map<std::string, uint> number_textures, color_textures; // by name, into `textures`
    std::deque<TextureNode> textures;
    std::vector<PendingImage> images; // by number in the scene
    std::map<std::tuple<std::string, bool, bool, bool, float>, Index<Image>> known_images;
    std::map<std::tuple<uint, float, float (*)(float)>, Index<Image>> mapped_images;
    std::optional<Look> look; // the last one
    std::string camera_name;  // of the camera to come
    std::vector<AreaLight> area_lights;
    std::map<std::tuple<float, float, float, uint, bool, float>, uint> known_area_lights;
    std::vector<Medium> media;
    std::map<std::string, uint> medium_names;
    std::map<std::string, Index<Group>> objects;
    Index<Group> object; // the one whose definition is being read
    std::string object_name;
    std::vector<PlyFile> plys;
    std::map<std::string, std::size_t> ply_numbers;
    std::map<std::string, Index<Group>> shared_groups; // shapes of equal description
    std::optional<Parameter> screen_window;            // of the camera; it needs the film's shape
    float frame_aspect = 0.0f;
    float film_diagonal = 35.0f;            // millimetres; pbrt's default
    vec3 even_light{0.0f};                  // sum of the constant infinite lights
    float exposure = 1.0f;                  // of the film
    std::size_t triangles_left = 4'000'000; // that shapes may be cut into beyond what the file spells out
    std::size_t texels_left = 1 << 26;      // look-ups for textures that are computed
    std::shared_ptr<void> included;         // the names of the files that places refer to

    // What is wrong at a place, for the user; once a key.
    void warn(const Spot& spot, const std::string& key, const std::string& text) { notes.warn(spot, key, text); }
    void inform(const Spot& spot, const std::string& key, const std::string& text) { notes.inform(spot, key, text); }

    // The file that a parameter names.
    std::filesystem::path resolve(const std::string& reference, const Spot& spot);

    const Matrix& ctm() const { return state.ctm[0]; }
};

// Each of these does one directive, and reports parameters that it does not know.
void read_file_into(Loader& loader, const std::filesystem::path& file, const Spot& from);
void set_camera(Loader& loader, const std::string& type, const ParameterList& parameters);
void finish_options(Loader& loader); // when all has been read
void set_film(Loader& loader, const std::string& type, const ParameterList& parameters);
void set_sampler(Loader& loader, const std::string& type, const ParameterList& parameters);
void set_option(Loader& loader, const ParameterList& parameters);
void set_filter(Loader& loader, const std::string& type, const ParameterList& parameters);
void set_accelerator(Loader& loader, const std::string& type, const ParameterList& parameters);
void set_integrator(Loader& loader, const std::string& type, const ParameterList& parameters);
void add_texture(Loader& loader, const std::string& name, const std::string& value_type, const std::string& type,
                 const ParameterList& parameters);
void make_material(Loader& loader, MaterialEntry& entry, const std::string& type, const ParameterList& parameters);
void add_medium(Loader& loader, const std::string& name, const ParameterList& parameters);
void add_light(Loader& loader, const std::string& type, const ParameterList& parameters);
void set_area_light(Loader& loader, const std::string& type, const ParameterList& parameters);
void add_shape(Loader& loader, const std::string& type, const ParameterList& parameters);

// ---- materials ----

std::shared_ptr<MaterialEntry> named_material(Loader& loader, const std::string& name);
// The scene's material for a shape.
Index<MaterialDesc> use_material(Loader& loader, const std::shared_ptr<MaterialEntry>& entry, const MaterialUse& use);
// When a definition came after its first use.
void update_uses(Loader& loader, MaterialEntry& entry);

// ---- textures ----

// A parameter that may be a texture, as something that a material can have; empty if it is missing.
std::optional<TextureValue> color_parameter(Loader& loader, const ParameterList& parameters, std::string_view name,
                                            Use use = Use::reflectance);
std::optional<TextureValue> number_parameter(Loader& loader, const ParameterList& parameters, std::string_view name);
// The same as a number of a texture, for textures of textures and for opacity; none if missing.
uint texture_parameter(Loader& loader, const ParameterList& parameters, std::string_view name, bool is_number);
// What a texture is as one picture, which is computed first where it has to be.
TextureValue texture_value(Loader& loader, uint texture);
// The mean, where a picture cannot be used.
vec3 mean_of(Loader& loader, const TextureValue& value);
Index<Image> add_image(Loader& loader, PendingImage image, const std::string& name);
void load_image(Loader& loader, Index<Image> image);
void load_all_images(Loader& loader);

// ---- lights ----

// The colour of a parameter of lights: spectrum, scale and v3's colour scale.
vec3 light_parameter(Loader& loader, const ParameterList& parameters, std::string_view name, vec3 otherwise);

// ---- shapes ----

// Puts a mesh in object space into the world or the object that is being read, with the material, the light and the
// orientation of the state. key: meshes of equal key, material and orientation are one; empty: this one is alone.
// lights: how many lights the mesh is to pbrt if it shines with a given power; 0: as many as it has triangles.
void place_mesh(Loader& loader, Mesh mesh, const ParameterList& parameters, const std::string& key = {},
                std::size_t lights = 0);
// How the current state's material is used by a shape. Empty if nothing is to be seen of it.
std::optional<MaterialUse> current_use(Loader& loader, const ParameterList& parameters);
void add_ply(Loader& loader, const ParameterList& parameters);

void load_all_plys(Loader& loader);

} // namespace snell::pbrt
