// What the writer makes an object, what a lamp, and what everything is called.
#include "snell/io/pbrt/write_parts.h"

#include <algorithm>

namespace snell::pbrt {
namespace {

std::vector<uint> materials_of(const Mesh& mesh)
{
    if (mesh.triangles.empty()) return {};
    if (mesh.triangle_materials.empty()) return {mesh.material.value};
    std::vector<uint> all;
    for (const Index<MaterialDesc> m : mesh.triangle_materials)
        if (all.empty() || all.back() != m.value) all.push_back(m.value);
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
}

// The name, or where it is empty or taken another one.
std::string unique_name(const std::string& name, const char* otherwise, std::size_t number,
                        std::set<std::string>& taken)
{
    if (!name.empty() && taken.insert(name).second) return name;
    std::string other = fmt::format("{} {}", name.empty() ? otherwise : name, number);
    while (!taken.insert(other).second) other += "'";
    return other;
}

} // namespace

Plan::Plan(const Scene& scene)
    : uses(scene.groups.size(), 0), is_object(scene.groups.size(), false), of_mesh(scene.meshes.size()),
      is_used(scene.materials.size(), false), is_lamp(scene.materials.size(), false), material(scene.materials.size()),
      object(scene.groups.size())
{
    for (const InstanceDesc& instance : scene.instances) ++uses[instance.group.value];
    std::vector<std::size_t> groups_of_mesh(scene.meshes.size(), 0);
    for (std::size_t g = 0; g < scene.groups.size(); ++g)
        if (uses[g] > 0)
            for (const Index<Mesh> mesh : scene.groups[g].meshes) ++groups_of_mesh[mesh.value];
    for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
        if (groups_of_mesh[m] == 0) continue;
        of_mesh[m] = materials_of(scene.meshes[m]);
        empty_meshes += of_mesh[m].empty() ? 1 : 0;
    }

    // A sphere has its centre in its object's space, which a shape in the world has not; and a mesh is shared by being
    // in objects.
    std::vector<bool> turns(scene.groups.size(), false);
    for (const InstanceDesc& instance : scene.instances)
        if (!is_identity(instance.transform)) turns[instance.group.value] = true;
    std::vector<bool> in_object(scene.materials.size(), false);
    for (std::size_t g = 0; g < scene.groups.size(); ++g) {
        const Group& group = scene.groups[g];
        if (uses[g] == 0) continue;
        is_object[g] = uses[g] > 1 || (turns[g] && !group.spheres.empty()) ||
                       std::any_of(group.meshes.begin(), group.meshes.end(),
                                   [&](Index<Mesh> mesh) { return groups_of_mesh[mesh.value] > 1; });
        const auto use = [&](uint m) {
            is_used[m] = true;
            if (is_object[g]) in_object[m] = true;
        };
        for (const Index<Mesh> mesh : group.meshes)
            for (const uint m : of_mesh[mesh.value]) use(m);
        for (const Index<SphereDesc> sphere : group.spheres) use(scene.spheres[sphere.value].material.value);
    }
    for (const PlaneDesc& plane : scene.planes) is_used[plane.material.value] = true;

    std::set<std::string> material_names, object_names;
    for (std::size_t m = 0; m < scene.materials.size(); ++m) {
        const MaterialDesc& desc = scene.materials[m];
        if (!is_used[m]) {
            ++unused_materials;
            continue;
        }
        material[m] = unique_name(desc.name, "material", m, material_names);
        // pbrt knows light of even colour, and none in objects.
        is_lamp[m] = desc.emission != vec3(0.0f) && !desc.emission_texture.valid() && !in_object[m] &&
                     desc.kind != material_unlit;
    }
    for (std::size_t g = 0; g < scene.groups.size(); ++g)
        if (is_object[g]) object[g] = unique_name(scene.groups[g].name, "object", g, object_names);
}

} // namespace snell::pbrt
