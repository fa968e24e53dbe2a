// Shape "plymesh": files are read at the end, in parallel, each once.
#include "snell/core/parallel.h"
#include "snell/io/pbrt/loader.h"
#include "snell/io/ply/ply.h"
#include "snell/io/text_cursor.h"

namespace snell::pbrt {
namespace {

// What one file brought.
struct Loaded
{
    Mesh mesh;
    std::vector<Note> notes;
    std::string missing;
};

Loaded read(const PlyFile& file, bool sandbox)
{
    Loaded loaded;
    std::error_code error;
    if (!std::filesystem::exists(file.path, error)) {
        loaded.missing = fmt::format("{}: no such file; what it holds is left out", file.path.string());
        return loaded;
    }
    LoadOptions options;
    options.sandbox = sandbox;
    Scene scene = load_ply(file.path, options);
    loaded.notes = std::move(scene.notes);
    if (!scene.meshes.empty()) loaded.mesh = std::move(scene.meshes[0]);
    return loaded;
}

// The mesh that a shape wants, made of the file's.
void fill(Scene& scene, const PlyUse& use, Mesh mesh)
{
    Mesh& target = scene.meshes[use.mesh.value];
    mesh.name = target.name;
    mesh.material = target.material;
    mesh.triangle_materials.clear();
    if (use.is_flipped) flip_mesh(mesh);
    if (use.baked) transform_mesh(mesh, *use.baked);
    target = std::move(mesh);
}

} // namespace

void add_ply(Loader& loader, const ParameterList& parameters)
{
    const std::string name = parameters.text("filename");
    parameters.ignore({"displacement.edgelength"});
    if (name.empty()) throw Error(parameters.spot.place(), "a plymesh needs a \"string filename\"", "add it");
    if (parameters.find("displacement") != nullptr)
        loader.warn(parameters.spot, "displacement", "displacement of meshes is left out");
    const std::optional<MaterialUse> found_use = current_use(loader, parameters);
    if (!found_use) return;
    const std::filesystem::path path = loader.resolve(name, parameters.spot);

    MaterialUse use = *found_use;
    if (use.area_light != none && loader.area_lights[use.area_light].power > 0.0f) {
        loader.warn(parameters.spot, "power of ply",
                    "an area light that is a plymesh has a radiance of its power over pi");
        use.light_scale = loader.area_lights[use.area_light].power / 3.14159265f;
    }
    const Index<MaterialDesc> material = use_material(loader, loader.state.material, use);
    const std::string file_key = path.string();
    const auto [number, is_new] = loader.ply_numbers.emplace(file_key, loader.plys.size());
    if (is_new) loader.plys.push_back({path, parameters.spot, {}});
    PlyFile& file = loader.plys[number->second];

    const bool is_flipped = loader.state.reverse_orientation;
    const auto make = [&](std::optional<Matrix> baked) {
        Mesh mesh;
        mesh.name = parameters.text("name", path.stem().string());
        mesh.material = material;
        const Index<Mesh> index = add(loader.scene, std::move(mesh));
        file.uses.push_back({index, baked, is_flipped});
        return index;
    };
    if (loader.object.valid()) {
        const Index<Mesh> mesh = make(loader.ctm());
        loader.scene.groups[loader.object.value].meshes.push_back(mesh);
        return;
    }
    Index<Group>& group = loader.shared_groups[fmt::format("ply {} {} {}", file_key, material.value, is_flipped)];
    if (!group.valid()) {
        Group fresh;
        fresh.name = parameters.text("name", path.stem().string());
        fresh.meshes.push_back(make({}));
        group = add(loader.scene, fresh);
    }
    InstanceDesc instance;
    instance.name = parameters.text("instance", loader.scene.groups[group.value].name);
    instance.group = group;
    instance.transform = to_transform(loader.ctm());
    add(loader.scene, instance);
}

void load_all_plys(Loader& loader)
{
    std::vector<std::string> missing(loader.plys.size());
    std::vector<std::vector<Note>> notes(loader.plys.size());
    parallel_for(loader.plys.size(), [&](std::size_t i) {
        const PlyFile& file = loader.plys[i];
        Loaded loaded = read(file, loader.options.sandbox);
        missing[i] = std::move(loaded.missing);
        notes[i] = std::move(loaded.notes);
        for (std::size_t use = 0; use + 1 < file.uses.size(); ++use) fill(loader.scene, file.uses[use], loaded.mesh);
        if (!file.uses.empty()) fill(loader.scene, file.uses.back(), std::move(loaded.mesh));
    });
    std::size_t said = 0;
    constexpr std::size_t most = 100;
    for (std::size_t i = 0; i < loader.plys.size(); ++i) {
        if (!missing[i].empty()) loader.warn(loader.plys[i].spot, "missing " + missing[i], missing[i]);
        for (Note& n : notes[i])
            if (said++ < most) loader.scene.notes.push_back(std::move(n));
    }
    if (said > most)
        note(loader.scene, Note::Kind::info, fmt::format("{} more notes about PLY files are left out", said - most));
}

} // namespace snell::pbrt
