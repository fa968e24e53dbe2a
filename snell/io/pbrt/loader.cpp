#include "snell/io/pbrt/loader.h"

#include "snell/io/file.h"
#include "snell/io/pbrt/environment.h"
#include "snell/io/pbrt/pbrt.h"

namespace snell {
namespace pbrt {

Loader::Loader(const std::filesystem::path& file, const LoadOptions& load_options)
    : options(load_options), main_file(file), notes(scene), references(file, load_options.sandbox, scene),
      spectra(notes, [this](const std::string& reference, const Spot& spot, std::string& file_name) {
          const std::filesystem::path path = resolve(reference, spot);
          file_name = path.string();
          return read_file(path);
      })
{
    state.space = find_color_space("srgb");
    state.material = std::make_shared<MaterialEntry>();
    state.material->desc.name = "default";
    state.material->desc.base_color = vec3(0.5f);
    coordinate_systems["world"] = state.ctm;
}

std::filesystem::path Loader::resolve(const std::string& reference, const Spot& spot)
{
    const std::filesystem::path path = references.resolve(reference, spot.prefix());
    std::error_code error;
    if (folder.empty() || std::filesystem::exists(path, error)) return path;
    // pbrt looks only in the folder of the scene; some exporters mean that of the included file.
    const std::filesystem::path beside = references.resolve(reference, spot.prefix(), folder);
    return std::filesystem::exists(beside, error) ? beside : path;
}

} // namespace pbrt

Scene load_pbrt(const std::filesystem::path& file, const LoadOptions& options)
{
    using namespace pbrt;
    Loader loader(file, options);
    if (!options.variant.empty()) throw Error({file.string()}, "a pbrt file has no variants", "leave the variant out");
    loader.scene.name = inner_stem(file);
    if (options.progress) options.progress({"reading " + file.filename().string(), 0.0});
    read_file_into(loader, file, {});
    finish_options(loader);
    finish_environment(loader);
    for (const auto& [name, entry] : loader.materials)
        if (!entry->is_defined)
            note(loader.scene, Note::Kind::warning,
                 fmt::format("{}: the material '{}' is used but not made; grey stands in for it", file.string(),
                             name.substr(0, 60)));
    if (options.progress) options.progress({"reading meshes", 0.2});
    load_all_plys(loader);
    if (options.progress) options.progress({"decoding textures", 0.7});
    load_all_images(loader);
    if (loader.exposure != 1.0f) {
        for (LightDesc& light : loader.scene.lights) light.emission *= loader.exposure;
        for (MaterialDesc& material : loader.scene.materials) material.emission *= loader.exposure;
        loader.scene.environment.radiance *= loader.exposure;
    }
    if (options.progress) options.progress({"checking", 0.9});
    return std::move(loader.scene);
}

} // namespace snell
