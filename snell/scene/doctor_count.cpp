// The scene report's counts, and what memory the scene takes.
#include "snell/scene/doctor_parts.h"

#include <array>

namespace snell::doctor {

template <class T>
static std::size_t bytes_of(const std::vector<T>& list)
{
    return list.size() * sizeof(T);
}

static std::size_t texture_bytes(const Image& image)
{
    return bytes_of(image.bytes) + bytes_of(image.floats);
}

static std::size_t bytes_of_scene(const Scene& scene)
{
    std::size_t bytes = bytes_of(scene.images) + bytes_of(scene.materials) + bytes_of(scene.meshes) +
                        bytes_of(scene.spheres) + bytes_of(scene.planes) + bytes_of(scene.groups) +
                        bytes_of(scene.instances) + bytes_of(scene.lights) + bytes_of(scene.cameras) +
                        bytes_of(scene.nodes) + bytes_of(scene.skins) + bytes_of(scene.rigs) +
                        bytes_of(scene.animations);
    for (const Image& image : scene.images) bytes += texture_bytes(image);
    for (const Mesh& mesh : scene.meshes)
        bytes += bytes_of(mesh.positions) + bytes_of(mesh.normals) + bytes_of(mesh.tangents) + bytes_of(mesh.uvs) +
                 bytes_of(mesh.uvs_1) + bytes_of(mesh.colors) + bytes_of(mesh.triangles) +
                 bytes_of(mesh.triangle_materials);
    for (const Group& group : scene.groups) bytes += bytes_of(group.meshes) + bytes_of(group.spheres);
    for (const Skin& skin : scene.skins) bytes += bytes_of(skin.joints) + bytes_of(skin.inverse_bind);
    for (const Rig& rig : scene.rigs) {
        bytes += bytes_of(rig.positions) + bytes_of(rig.normals) + bytes_of(rig.tangents) + bytes_of(rig.targets) +
                 bytes_of(rig.joints) + bytes_of(rig.weights);
        for (const MorphTarget& target : rig.targets)
            bytes += bytes_of(target.positions) + bytes_of(target.normals) + bytes_of(target.tangents);
    }
    for (const Animation& animation : scene.animations)
        for (const AnimationChannel& channel : animation.channels)
            bytes += sizeof channel + bytes_of(channel.times) + bytes_of(channel.values);
    return bytes;
}

// What the default structure will take, to about a tenth: figures of meshes from two thousand to 200 thousand
// triangles. `snell render --stats` has the real one.
static std::size_t forecast_accel_bytes(const PackedScene& packed)
{
    constexpr std::size_t per_primitive = 77, per_instance = 40;
    return (packed.triangles.size() + packed.spheres.size()) * per_primitive + packed.instances.size() * per_instance;
}

// What building it takes besides (the boxes of the primitives, a binary tree over them) and the program itself. With
// this the forecast was within an eighth of the peak of five renders, of 1,000 to 1.4 million triangles and of half a
// million instances.
static std::size_t forecast_build_bytes(const PackedScene& packed)
{
    constexpr std::size_t per_primitive = 80, per_instance = 310, program = std::size_t{12} << 20;
    return (packed.triangles.size() + packed.spheres.size()) * per_primitive + packed.instances.size() * per_instance +
           program;
}

// Kinds that occur, with their names.
template <std::size_t N>
static SceneReport::Tally tally(const std::array<const char*, N>& names, const std::array<std::size_t, N>& counts)
{
    SceneReport::Tally result;
    for (std::size_t i = 0; i < N; ++i)
        if (counts[i] > 0) result.emplace_back(names[i], counts[i]);
    return result;
}

static void count_materials(const Scene& scene, SceneReport& report)
{
    static constexpr std::array<const char*, material_kinds> names = {"diffuse",   "mirror", "mix",       "dielectric",
                                                                      "conductor", "unlit",  "principled"};
    std::array<std::size_t, material_kinds> counts = {};
    for (const MaterialDesc& material : scene.materials) ++counts[material.kind];
    report.materials = tally(names, counts);
}

static void count_lights(const PackedScene& packed, SceneReport& report)
{
    static constexpr std::array<const char*, 5> names = {"point", "directional", "spot", "triangle", "sphere"};
    std::array<std::size_t, 5> counts = {};
    for (const Light& light : packed.lights) ++counts[light.kind];
    report.lights = tally(names, counts);
    report.light_count = packed.lights.size();
}

static void count_textures(const Scene& scene, SceneReport& report)
{
    static constexpr std::array<const char*, 3> formats = {"rgba8-linear", "rgba8-srgb", "rgba32f"};
    for (const Image& image : scene.images) {
        report.textures.push_back({image.name, image.width, image.height, formats[image.format], texture_bytes(image)});
        report.texture_bytes += texture_bytes(image);
    }
}

void count(const Scene& scene, const PackedScene* packed, SceneReport& report)
{
    for (const Mesh& mesh : scene.meshes) report.mesh_triangles += mesh.triangles.size();
    for (const InstanceDesc& instance : scene.instances) {
        const Group& group = scene.groups[instance.group.value];
        for (const Index<Mesh> mesh : group.meshes)
            report.placed_triangles += scene.meshes[mesh.value].triangles.size();
        report.placed_spheres += group.spheres.size();
        if (determinant(instance.transform) < 0.0f) ++report.mirrored_instances;
    }
    for (const Rig& rig : scene.rigs) report.morph_targets += rig.targets.size();
    count_materials(scene, report);
    count_textures(scene, report);
    report.bounds = scene_bounds(scene);
    report.scene_bytes = bytes_of_scene(scene);
    if (packed == nullptr) return;
    count_lights(*packed, report);
    report.packed_bytes = packed->bytes();
    report.accel_bytes = forecast_accel_bytes(*packed);
    report.peak_bytes = report.scene_bytes + report.packed_bytes + report.accel_bytes + forecast_build_bytes(*packed);
}

} // namespace snell::doctor
