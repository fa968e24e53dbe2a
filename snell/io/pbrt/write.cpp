#include "snell/io/pbrt/write.h"

#include "snell/core/parallel.h"
#include "snell/core/version.h"
#include "snell/io/file.h"
#include "snell/io/pbrt/write_parts.h"

#include <algorithm>
#include <cmath>
#include <fstream>

namespace fs = std::filesystem;

namespace snell {
namespace pbrt {
namespace {

constexpr std::string_view mark = "# Written by snell convert";

void check_text_output(const fs::path& file, const WriteOptions& options)
{
    if (lower_extension(file) != ".pbrt") throw Error({file.string()}, "does not end in .pbrt", "give it that ending");
    for (const char c : file.stem().string())
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
            throw Error({file.string()}, "the name has a control character in it", "choose another one");
    check_can_write(file);
    std::error_code error;
    if (options.overwrite || !fs::exists(file, error)) return;
    std::string start(mark.size(), '\0');
    std::ifstream in(file, std::ios::binary);
    in.read(start.data(), static_cast<std::streamsize>(start.size()));
    if (!in || start != mark)
        throw Error({file.string()}, "there is such a file already, and it is not one that snell convert has written",
                    "choose another name, or ask to overwrite it");
}

void say_losses(Writer& w)
{
    const Scene& scene = w.scene;
    if (!scene.animations.empty()) w.inform("the scene moves; the file has it as it stands at this moment");
    if (!scene.variants.empty()) w.inform("the scene has variants; the file has the one at hand");
    if (const std::size_t n = w.plan.unused_materials)
        w.inform(fmt::format("materials that nothing uses: {} left out", n));
    if (const std::size_t n = w.plan.empty_meshes) w.inform(fmt::format("meshes without triangles: {} left out", n));
    if (scene.cameras.empty()) w.inform("the scene has no camera; snell finds one, and pbrt looks from the origin");
}

} // namespace

std::string in_quotes(std::string_view text)
{
    std::string all = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') all += '\\';
        all += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? ' ' : c;
    }
    return all + '"';
}

std::string show(vec3 v)
{
    return fmt::format("{} {} {}", v.x, v.y, v.z);
}

std::string show(const Transform& m)
{
    return fmt::format("[ {} {} {} 0  {} {} {} 0  {} {} {} 0  {} {} {} 1 ]", m.x.x, m.y.x, m.z.x, m.x.y, m.y.y, m.z.y,
                       m.x.z, m.y.z, m.z.z, m.x.w, m.y.w, m.z.w);
}

bool is_identity(const Transform& m)
{
    const Transform one = identity_transform();
    bool same = true;
    for (int i = 0; i < 4; ++i)
        for (const auto& [a, b] :
             {std::pair(m.x[i], one.x[i]), std::pair(m.y[i], one.y[i]), std::pair(m.z[i], one.z[i])})
            same = same && floatBitsToUint(a) == floatBitsToUint(b);
    return same;
}

SideFolder::SideFolder(const fs::path* scene_file, const std::string& kind)
{
    name_ = (scene_file != nullptr ? scene_file->stem().string() : "scene") + "_" + kind;
    if (scene_file == nullptr) return;
    path_ = scene_file->parent_path() / name_;
    std::error_code error;
    if (fs::exists(path_, error) && !fs::is_directory(path_, error))
        throw Error({path_.string()}, "is no folder, and one of this name is needed for " + kind,
                    "move it, or write the scene under another name");
}

SideFolder::Slot SideFolder::next(const std::string& ending)
{
    std::error_code error;
    if (count_ == 0 && !path_.empty() && !fs::exists(path_, error)) {
        fs::create_directory(path_, error);
        if (error) throw Error({path_.string()}, "cannot make this folder: " + error.message(), "choose another place");
    }
    const std::string file = fmt::format("{:03}{}", count_++, ending);
    return {path_ / file, name_ + "/" + file};
}

// The text of the scene's file.
static void write_text(Writer& w)
{
    w.line("{} (snell {})", mark, version());
    w.line("# scene {}", in_quotes(w.scene.name));
    write_options(w);
    w.line("\nWorldBegin");
    write_lights(w);
    write_materials(w);
    write_shapes(w);
}

} // namespace pbrt

std::string pbrt_text(const Scene& scene)
{
    pbrt::Writer w(scene, nullptr);
    pbrt::write_text(w);
    return std::move(w.text);
}

std::string pbrt_text(const Scene& scene, Index<MaterialDesc> material)
{
    Scene alone;
    alone.images = scene.images;
    alone.materials = {scene.materials.at(material.value)};
    pbrt::Writer w(alone, nullptr);
    w.plan.is_used[0] = true;
    w.plan.material[0] = alone.materials[0].name.empty() ? "material" : alone.materials[0].name;
    pbrt::write_materials(w);
    return std::move(w.text);
}

std::string pbrt_text(const LightDesc& light)
{
    Scene alone;
    alone.lights = {light};
    pbrt::Writer w(alone, nullptr);
    pbrt::write_lights(w);
    return std::move(w.text);
}

std::string pbrt_text(const CameraDesc& camera)
{
    Scene alone;
    alone.cameras = {camera};
    pbrt::Writer w(alone, nullptr);
    pbrt::write_cameras(w);
    return std::move(w.text);
}

std::string pbrt_text(const Scene& scene, const EnvironmentDesc& environment)
{
    Scene alone;
    alone.images = scene.images;
    alone.environment = environment;
    pbrt::Writer w(alone, nullptr);
    pbrt::write_lights(w);
    return std::move(w.text);
}

void check_pbrt_output(const std::filesystem::path& file, const WriteOptions& options)
{
    using namespace pbrt;
    check_text_output(file, options);
    SideFolder(&file, "meshes");
    SideFolder(&file, "textures");
}

std::vector<Note> write_pbrt(const Scene& scene, const std::filesystem::path& file, const WriteOptions& options)
{
    using namespace pbrt;
    check_text_output(file, options);
    Writer w(scene, &file); // checks the folders
    write_text(w);
    parallel_for(w.files.size(), [&](std::size_t i) { w.files[i](); });
    write_atomically(file, w.text); // last, when all it refers to is there
    say_losses(w);
    return std::move(w.notes);
}

} // namespace snell
