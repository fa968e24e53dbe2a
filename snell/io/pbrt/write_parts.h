// What the parts of the pbrt writer share while one scene is written.
#pragma once

#include "snell/core/error.h"
#include "snell/scene/scene.h"

#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace snell::pbrt {

// ---- text ----

// A string in quotes, on one line: control characters become blanks.
std::string in_quotes(std::string_view text);
// Numbers with a blank between them, in the fewest digits that say exactly these floats.
std::string show(vec3 v);
// "[ ... ]" of the 16 numbers of the directive Transform.
std::string show(const Transform& m);
bool is_identity(const Transform& m); // to the sign of each 0

// ---- what is placed how ----

struct Plan
{
    explicit Plan(const Scene& scene);

    std::vector<std::size_t> uses;             // of each group, by instances
    std::vector<bool> is_object;               // of each group: ObjectBegin and ObjectInstance; else plain shapes
    std::vector<std::vector<uint>> of_mesh;    // materials of each mesh that is placed, ascending
    std::vector<bool> is_used, is_lamp;        // of each material; a lamp's emission is written with its shapes
    std::vector<std::string> material, object; // names in the file
    std::size_t unused_materials = 0, empty_meshes = 0;
};

// ---- files ----

// The folder for files of one kind beside the scene's, made when the first one is written.
class SideFolder
{
  public:
    // kind: "meshes". Throws Error if something else has the folder's name. No file: there are only names.
    SideFolder(const std::filesystem::path* scene_file, const std::string& kind);

    // Where the next file goes, and its name as the scene's file refers to it.
    struct Slot
    {
        std::filesystem::path path;
        std::string reference;
    };
    Slot next(const std::string& ending);

  private:
    std::filesystem::path path_; // empty: there is none
    std::string name_;
    std::size_t count_ = 0;
};

struct Writer
{
    // to: null for the text alone, without any file.
    Writer(const Scene& from, const std::filesystem::path* to)
        : scene(from), plan(from), writes_files(to != nullptr), meshes(to, "meshes"), textures(to, "textures"),
          lenses(to, "lenses")
    {
    }

    const Scene& scene;
    Plan plan;
    const bool writes_files;
    SideFolder meshes, textures, lenses;
    std::string text;
    std::vector<Note> notes;
    std::vector<std::function<void()>> files;         // to write, in any order
    std::map<uint, std::string> pictures;             // files of the images, by number
    std::map<std::string, std::string> texture_names; // by what is behind the name

    // One line of the file.
    template <class... Args>
    void line(fmt::format_string<Args...> format, Args&&... args)
    {
        fmt::format_to(std::back_inserter(text), format, std::forward<Args>(args)...);
        text += '\n';
    }
    void inform(std::string what) { notes.push_back({Note::Kind::info, std::move(what)}); }
};

// An image of the scene as a file (once, and when `files` are written), and the name for the scene's file to use.
// as_light: an environment's, which is read in floats.
std::string write_picture_file(Writer& writer, Index<Image> image, bool as_light);
// The name of a texture that is `factor` times what `ref` looks up; the directives that make it are written first.
std::string write_texture(Writer& writer, const TextureRef& ref, bool is_number, vec3 factor = vec3(1.0f));
void write_materials(Writer& writer);
void write_options(Writer& writer); // film, sampler, integrator, cameras
void write_cameras(Writer& writer);
void write_lights(Writer& writer);
void write_shapes(Writer& writer);

} // namespace snell::pbrt
