// MTL material libraries.
#pragma once

#include "snell/scene/scene.h"

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <unordered_map>

namespace tinyobj {
struct material_t;
}

namespace snell::obj {

// Which statements a material has: tinyobjloader's material does not tell a default from a value that was written.
using Statements = std::set<std::string, std::less<>>;

// What an MTL material means here. MTL is from the time of Phong shading, and writers disagree; the rules, of which the
// first that applies counts:
//
//   glass     illum 4, 6, 7 or 9: a smooth dielectric of index Ni (1.5 if Ni is not above 1). Tf is taken for its hue
//             only (divided by its largest component), for some writers mean what passes and others what does not; half
//             of it acts at each surface, so that a body shows Tf's hue once.
//   see-through  d below 1 (or Tr above 0): as glass, of index Ni as it is written (1 if not: light passes straight),
//             tinted with Kd as far as it is opaque: by 1 - d + d Kd.
//   metal     Pm above 0: a mix of diffuse (1 - Pm) Kd and specular reflection coloured from Ks (or 0.04) to Kd by Pm,
//             of roughness alpha = Pr^2.
//   mirror    illum 3, 5 or 8 and Kd less than a tenth of Ks: a perfect mirror of reflectance Ks.
//   mix       Ks above 0 and illum not 1: diffuse Kd and specular Ks, scaled down where they exceed 1 together. alpha
//             is 0 with illum 3, 5 or 8, else Pr^2 if there is a Pr, else sqrt(2 / (Ns + 2)) (Walter et al. 2007).
//   diffuse   Kd.
//
// Ke is emitted radiance, on the front only. Without Kd: 0.8, or 0 for an emitter; with map_Kd a Kd of 0 counts as 1.
MaterialDesc to_material(const tinyobj::material_t& m, const Statements& has);

// The libraries of one OBJ file. Materials come into the scene, and their textures are read, when first asked for.
class MaterialLibrary
{
  public:
    // folder: of the OBJ file, where relative names start.
    MaterialLibrary(Scene& scene, std::filesystem::path folder) : scene_(scene), folder_(std::move(folder)) {}

    // names: what `mtllib` says, one name with spaces or several. place: of that line, "file:line". What is not found
    // is noted.
    void load(std::string_view names, const std::string& place);

    // A name that no library has gives a grey material of that name and a note.
    Index<MaterialDesc> find(const std::string& name, const std::string& obj_file);

  private:
    struct Source
    {
        std::string file;
        int line = 0;     // of its newmtl
        std::string text; // its statements
    };

    bool load_file(const std::filesystem::path& file);
    std::string sanitize(const Source& source, Statements& has);
    Index<Image> texture(std::string name, bool clamps, const Source& source);
    std::filesystem::path locate(const std::string& name);
    const std::unordered_map<std::string, std::string>& names_in(const std::filesystem::path& folder);
    void warn(std::string text);

    Scene& scene_;
    std::filesystem::path folder_;
    std::set<std::string, std::less<>> asked_; // what `mtllib` lines said
    std::set<std::filesystem::path> loaded_;
    std::unordered_map<std::string, Source> sources_;
    std::unordered_map<std::string, std::unordered_map<std::string, std::string>> folders_;
    std::map<std::pair<std::string, bool>, Index<Image>> textures_;
    bool misses_library_ = false;
    bool noted_maps_ = false;
};

} // namespace snell::obj
