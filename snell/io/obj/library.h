// The material libraries of one OBJ file.
#pragma once

#include "snell/io/obj/material.h"
#include "snell/io/reference.h"

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <unordered_map>

namespace snell::obj {

// Materials come into the scene, and their textures are read, when first asked for. What is missing is noted once for
// each file's name: a library's materials are grey, a picture of colours is a magenta checkerboard, a map of numbers is
// left out.
class MaterialLibrary
{
  public:
    // obj_file: where relative names start. sandbox: names that lead out of its folder are an Error.
    MaterialLibrary(Scene& scene, const std::filesystem::path& obj_file, bool sandbox);

    // names: what `mtllib` says, one name with spaces or several. place: of that line, "file:line".
    void load(std::string_view names, const std::string& place);

    // A name that no library has gives a grey material of that name and a note.
    Index<MaterialDesc> find(const std::string& name, const std::string& obj_file);

  private:
    // How a texture's numbers are to be understood.
    enum class Use
    {
        color,
        number,
        normal
    };

    void load_file(const std::filesystem::path& file);
    void add_textures(const MtlMaterial& m, MaterialDesc& material);
    void note_unused(const MtlMaterial& m, const MaterialDesc& material);
    TextureRef texture(const MtlMaterial& m, const char* keyword, Use use);
    Index<Image> image(const MtlMaterial& m, const MtlMap& map, Use use);
    std::filesystem::path locate(const std::string& name, const std::string& place);
    const std::unordered_map<std::string, std::string>& names_in(const std::filesystem::path& folder);
    void warn(std::string text);

    Scene& scene_;
    std::filesystem::path folder_;
    References references_;
    bool sandbox_;
    std::set<std::string, std::less<>> asked_; // what `mtllib` lines said
    std::set<std::filesystem::path> loaded_;
    std::unordered_map<std::string, MtlMaterial> materials_;
    std::unordered_map<std::string, std::unordered_map<std::string, std::string>> folders_;
    std::map<std::pair<std::string, std::string>, Index<Image>> images_; // by name and use
    std::set<std::string> missing_;                                      // names of pictures
    std::set<std::pair<std::string, std::string>> wrong_;                // statements, by file and keyword
    bool misses_library_ = false;
    bool noted_maps_ = false, noted_options_ = false;
};

} // namespace snell::obj
