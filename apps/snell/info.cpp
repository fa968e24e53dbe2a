// snell info: what is in a scene.
#include "commands.h"
#include "console.h"
#include "options.h"

#include "snell/io/load.h"
#include "snell/scene/packed.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <span>

namespace snell::app {

namespace {
struct Summary
{
    Scene scene;
    double load_seconds = 0;
    std::size_t mesh_triangles = 0;   // in files and lists
    std::size_t placed_triangles = 0; // with every instance counted
    std::size_t placed_spheres = 0;
    std::size_t lights = 0; // with emissive triangles and spheres, each as often as it is placed
    std::size_t scene_bytes = 0, packed_bytes = 0, accel_bytes = 0;
    Bounds bounds;
};
} // namespace

template <class T>
static std::size_t bytes_of(const std::vector<T>& list)
{
    return list.size() * sizeof(T);
}

static std::size_t scene_bytes(const Scene& scene)
{
    std::size_t bytes = bytes_of(scene.images) + bytes_of(scene.materials) + bytes_of(scene.meshes) +
                        bytes_of(scene.spheres) + bytes_of(scene.planes) + bytes_of(scene.groups) +
                        bytes_of(scene.instances) + bytes_of(scene.lights) + bytes_of(scene.cameras);
    for (const Image& image : scene.images) bytes += bytes_of(image.bytes) + bytes_of(image.floats);
    for (const Mesh& mesh : scene.meshes)
        bytes += bytes_of(mesh.positions) + bytes_of(mesh.normals) + bytes_of(mesh.uvs) + bytes_of(mesh.colors) +
                 bytes_of(mesh.triangles) + bytes_of(mesh.triangle_materials);
    for (const Group& group : scene.groups) bytes += bytes_of(group.meshes) + bytes_of(group.spheres);
    return bytes;
}

// What the default structure will take, to about a tenth: figures of meshes from two thousand to 200 thousand
// triangles. `snell render --stats` has the real one.
static std::size_t forecast_accel_bytes(const PackedScene& packed)
{
    constexpr std::size_t per_primitive = 77, per_instance = 40;
    return (packed.triangles.size() + packed.spheres.size()) * per_primitive + packed.instances.size() * per_instance;
}

static Summary summarise(const std::string& name)
{
    Summary summary;
    const auto start = std::chrono::steady_clock::now();
    summary.scene = open_scene(name);
    summary.load_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const Scene& scene = summary.scene;

    for (const Mesh& mesh : scene.meshes) summary.mesh_triangles += mesh.triangles.size();
    for (const InstanceDesc& instance : scene.instances) {
        const Group& group = scene.groups.at(instance.group.value);
        for (const Index<Mesh> mesh : group.meshes)
            summary.placed_triangles += scene.meshes.at(mesh.value).triangles.size();
        summary.placed_spheres += group.spheres.size();
    }
    const PackedScene packed = pack(scene);
    summary.lights = packed.lights.size();
    summary.scene_bytes = scene_bytes(scene);
    summary.packed_bytes = packed.bytes();
    summary.accel_bytes = forecast_accel_bytes(packed);
    summary.bounds = scene_bounds(scene);
    return summary;
}

static void print_text(const Summary& summary)
{
    const Scene& scene = summary.scene;
    const auto row = [](const char* name, const std::string& value) { fmt::print("{:12} {}\n", name, value); };
    row("scene", scene.name);
    row("meshes", fmt::format("{} with {} triangles", scene.meshes.size(), summary.mesh_triangles));
    row("spheres", std::to_string(scene.spheres.size()));
    row("planes", std::to_string(scene.planes.size()));
    row("instances", fmt::format("{} of {} groups: {} triangles and {} spheres in all", scene.instances.size(),
                                 scene.groups.size(), summary.placed_triangles, summary.placed_spheres));
    row("materials", std::to_string(scene.materials.size()));
    row("textures", std::to_string(scene.images.size()));
    row("lights", std::to_string(summary.lights));
    row("environment", fmt::format("{:g} {:g} {:g}", scene.environment.radiance.x,
                                    scene.environment.radiance.y, scene.environment.radiance.z));
    for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
        const CameraDesc& c = scene.cameras[i];
        row(i == 0 ? "cameras" : "",
            fmt::format("{}: '{}' --eye {:g},{:g},{:g} --target {:g},{:g},{:g} --fov {:g}", i, c.name, c.eye.x, c.eye.y,
                        c.eye.z, c.target.x, c.target.y, c.target.z, c.fov_degrees));
    }
    if (scene.cameras.empty()) row("cameras", "0");
    if (const Bounds& b = summary.bounds; b.empty())
        row("bounds", "empty");
    else
        row("bounds", fmt::format("{:g} {:g} {:g} to {:g} {:g} {:g}", b.lower.x, b.lower.y, b.lower.z, b.upper.x,
                                  b.upper.y, b.upper.z));
    row("memory", fmt::format("scene {}, packed {}, acceleration structure about {}",
                              short_bytes(static_cast<double>(summary.scene_bytes)),
                              short_bytes(static_cast<double>(summary.packed_bytes)),
                              short_bytes(static_cast<double>(summary.accel_bytes))));
    row("loaded in", short_time(summary.load_seconds));
}

static nlohmann::ordered_json triple(const vec3& v)
{
    return nlohmann::ordered_json::array({v.x, v.y, v.z});
}

static void print_json(const Summary& summary)
{
    const Scene& scene = summary.scene;
    nlohmann::ordered_json json;
    json["scene"] = scene.name;
    json["meshes"] = scene.meshes.size();
    json["triangles"] = summary.mesh_triangles;
    json["spheres"] = scene.spheres.size();
    json["planes"] = scene.planes.size();
    json["groups"] = scene.groups.size();
    json["instances"] = scene.instances.size();
    json["placed_triangles"] = summary.placed_triangles;
    json["placed_spheres"] = summary.placed_spheres;
    json["materials"] = scene.materials.size();
    json["textures"] = scene.images.size();
    json["lights"] = summary.lights;
    json["environment"] = triple(scene.environment.radiance);
    json["cameras"] = nlohmann::ordered_json::array();
    for (const CameraDesc& camera : scene.cameras)
        json["cameras"].push_back({{"name", camera.name},
                                   {"eye", triple(camera.eye)},
                                   {"target", triple(camera.target)},
                                   {"up", triple(camera.up)},
                                   {"fov_degrees", camera.fov_degrees}});
    if (summary.bounds.empty())
        json["bounds"] = nullptr;
    else
        json["bounds"] = {{"lower", triple(summary.bounds.lower)}, {"upper", triple(summary.bounds.upper)}};
    json["bytes"] = {
        {"scene", summary.scene_bytes}, {"packed", summary.packed_bytes}, {"accel_forecast", summary.accel_bytes}};
    json["seconds"] = {{"load", summary.load_seconds}};
    json["notes"] = nlohmann::ordered_json::array();
    for (const Note& note : scene.notes)
        json["notes"].push_back({{"kind", note.kind == Note::Kind::warning ? "warning" : "info"}, {"text", note.text}});
    // Names from files need not be UTF-8.
    fmt::print("{}\n", json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
}

int run_info(const Arguments& arguments)
{
    std::string scene;
    bool json = false;
    Options options("info", "Says what is in a scene, what was repaired, and how much memory it takes.",
                    "Examples:\n  snell info dragon.ply\n  snell info cornell --json\n");
    options.positional("SCENE", "A file (.obj .ply .stl) or a built-in scene",
                       [&](const std::string& text) { scene = text; });
    options.flag("--json", "Print one JSON object", [&] { json = true; });
    options.flag("-q,--quiet", "Print no notes", [] { console().level = Console::Level::quiet; });
    options.flag("-v,--verbose", "Print all notes", [] { console().level = Console::Level::verbose; });
    if (const auto code = options.parse(arguments)) return *code;

    const Summary summary = summarise(scene);
    if (json)
        print_json(summary);
    else
        print_text(summary);
    std::fflush(stdout); // so that on a terminal the notes come last
    if (!json) console().notes(summary.scene);
    return 0;
}

} // namespace snell::app
