#include "snell/io/load.h"

#include "snell/core/error.h"
#include "snell/core/text.h"
#include "snell/io/file.h"
#include "snell/io/gltf/gltf.h"
#include "snell/io/obj/obj.h"
#include "snell/io/pbrt/pbrt.h"
#include "snell/io/ply/ply.h"
#include "snell/io/stl/stl.h"
#include "snell/scene/builtin.h"

#include <algorithm>

namespace snell {

static constexpr const char* formats =
    "give a file that ends in .gltf, .glb, .pbrt, .obj, .ply or .stl (the last three also as .gz)";

// The ending without a .gz behind it: ".ply" of "bunny.ply.gz".
static std::string scene_extension(const std::filesystem::path& file)
{
    const std::string last = lower_extension(file);
    return last == ".gz" ? lower_extension(file.stem()) : last;
}

Scene load_scene(const std::filesystem::path& file, const LoadOptions& options)
{
    const std::string extension = scene_extension(file);
    Scene scene;
    if (extension == ".gltf" || extension == ".glb")
        scene = load_gltf(file, options);
    else if (extension == ".pbrt")
        scene = load_pbrt(file, options);
    else if (extension == ".obj")
        scene = load_obj(file, options);
    else if (extension == ".ply")
        scene = load_ply(file, options);
    else if (extension == ".stl")
        scene = load_stl(file, options);
    else {
        std::error_code error;
        if (!std::filesystem::exists(file, error)) throw Error({file.string()}, "no such file", "check the path");
        if (std::filesystem::is_directory(file, error)) throw Error({file.string()}, "is a folder", formats);
        throw Error({file.string()},
                    extension.empty() ? "has no ending that tells its format"
                                      : fmt::format("scenes of format '{}' cannot be read", extension),
                    formats);
    }
    if (!options.variant.empty() &&
        std::find(scene.variants.begin(), scene.variants.end(), options.variant) == scene.variants.end())
        throw Error({file.string()}, fmt::format("there is no variant '{}'", options.variant),
                    scene.variants.empty() ? "the file offers none"
                                           : fmt::format("the file offers {}", fmt::join(scene.variants, ", ")));
    validate(scene);
    return scene;
}

Scene open_scene(const std::string& name_or_file, const LoadOptions& options)
{
    if (std::optional<Scene> scene = make_builtin_scene(name_or_file)) {
        validate(*scene);
        return std::move(*scene);
    }
    std::error_code error;
    const std::filesystem::path file = name_or_file;
    if (std::filesystem::exists(file, error) || !lower_extension(file).empty()) return load_scene(file, options);

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
