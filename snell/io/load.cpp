#include "snell/io/load.h"

#include "snell/core/error.h"
#include "snell/core/text.h"
#include "snell/io/file.h"
#include "snell/io/obj/obj.h"
#include "snell/io/ply/ply.h"
#include "snell/io/stl/stl.h"
#include "snell/scene/builtin.h"

namespace snell {

static constexpr const char* formats = "give a file that ends in .obj, .ply or .stl";

Scene load_scene(const std::filesystem::path& file)
{
    const std::string extension = lower_extension(file);
    Scene scene;
    if (extension == ".obj")
        scene = load_obj(file);
    else if (extension == ".ply")
        scene = load_ply(file);
    else if (extension == ".stl")
        scene = load_stl(file);
    else {
        std::error_code error;
        if (!std::filesystem::exists(file, error)) throw Error({file.string()}, "no such file", "check the path");
        if (std::filesystem::is_directory(file, error)) throw Error({file.string()}, "is a folder", formats);
        throw Error({file.string()},
                    extension.empty() ? "has no ending that tells its format"
                                      : fmt::format("scenes of format '{}' cannot be read", extension),
                    formats);
    }
    validate(scene);
    return scene;
}

Scene open_scene(const std::string& name_or_file)
{
    if (std::optional<Scene> scene = make_builtin_scene(name_or_file)) {
        validate(*scene);
        return std::move(*scene);
    }
    std::error_code error;
    const std::filesystem::path file = name_or_file;
    if (std::filesystem::exists(file, error) || !lower_extension(file).empty()) return load_scene(file);

    std::vector<std::string> names;
    std::string list;
    for (const BuiltinScene& builtin : builtin_scenes()) {
        names.emplace_back(builtin.name);
        list += (list.empty() ? "" : ", ") + names.back();
        if (builtin.make_with != nullptr) list += fmt::format(" (or {}:{})", builtin.name, builtin.parameter);
    }
    const std::string guess = nearest(name_or_file.substr(0, name_or_file.find(':')), names);
    throw Error(fmt::format("'{}' is neither a built-in scene nor a file", name_or_file),
                guess.empty() ? fmt::format("the built-in scenes are: {}", list)
                              : fmt::format("did you mean '{}'? The built-in scenes are: {}", guess, list));
}

} // namespace snell
