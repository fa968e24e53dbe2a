#include "snell/io/obj/obj.h"

#include "snell/core/error.h"
#include "snell/io/byte_window.h"
#include "snell/io/file.h"
#include "snell/io/obj/build.h"
#include "snell/io/obj/library.h"
#include "snell/io/obj/parse.h"
#include "snell/io/progress.h"

#include <algorithm>

namespace snell {
namespace {

using namespace obj;

void scale_colors(Scene& scene, const std::string& name, std::vector<vec3>& colors)
{
    float largest = 0.0f;
    for (const vec3 color : colors) largest = max(largest, max3(color));
    if (largest <= 1.0f) return;
    for (vec3& color : colors) color /= 255.0f;
    note(scene, Note::Kind::info, fmt::format("{}: vertex colours up to {} are taken as 0 to 255", name, largest));
}

} // namespace

Scene load_obj(const std::filesystem::path& file, const LoadOptions& options)
{
    const std::string name = file.string();
    ByteWindow window(file, 2 * ByteWindow::usual_size);
    Document document = parse(window, reading_progress(options, file));
    if (document.face_count == 0)
        throw Error({name},
                    document.positions.empty()
                        ? "contains neither vertices nor faces"
                        : fmt::format("contains {} points, but no faces", document.positions.size()),
                    "choose a file with a surface in it");
    // The indices of normals share a word with where they come from.
    if (document.normals.size() >= (1u << 30) || document.corners.size() >= none)
        throw Error({name}, "more than 1073741823 normals or 4294967294 corners", "split the file");

    Scene scene;
    scene.name = inner_stem(file);
    for (std::string& warning : document.warnings) note(scene, Note::Kind::warning, std::move(warning));
    scale_colors(scene, name, document.colors);

    MaterialLibrary library(scene, file, options.sandbox);
    for (const Library& wanted : document.libraries)
        library.load(wanted.names, fmt::format("{}:{}", name, wanted.line));
    std::vector<Index<MaterialDesc>> materials(document.materials.size());
    std::vector<std::vector<uint>> runs_of(document.objects.size());
    std::size_t last = 0;
    for (uint r = 0; r < document.runs.size(); ++r) {
        const Run& run = document.runs[r];
        runs_of[run.object].push_back(r);
        last = std::max<std::size_t>(last, run.object);
        Index<MaterialDesc>& material = materials[run.material];
        if (material.valid()) continue;
        material = library.find(document.materials[run.material], name);
        const bool is_default = document.materials[run.material].empty();
        if (is_default && !document.colors.empty()) scene.materials[material.value].base_color = vec3(1.0f);
    }

    Builder builder(document);
    Group group;
    group.name = scene.name;
    for (std::size_t i = 0; i < runs_of.size(); ++i) {
        if (runs_of[i].empty()) continue;
        Mesh mesh = builder.build(runs_of[i], materials, i == last);
        mesh.name = document.objects[i].empty() ? scene.name : document.objects[i];
        group.meshes.push_back(add(scene, std::move(mesh)));
    }
    const Index<Group> index = add(scene, std::move(group));
    InstanceDesc instance;
    instance.name = scene.name;
    instance.group = index;
    add(scene, std::move(instance));
    return scene;
}

} // namespace snell
