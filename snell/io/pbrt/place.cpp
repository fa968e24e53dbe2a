// Shapes into the world or into objects, with the state's material.
#include "snell/io/pbrt/loader.h"

#include <algorithm>
#include <cmath>

namespace snell::pbrt {
namespace {

float world_area(const Mesh& mesh, const Matrix& m, std::size_t triangle)
{
    const uvec3 t = mesh.triangles[triangle];
    const vec3 a = transform_point(m, mesh.positions[t.x]);
    return 0.5f *
           length(cross(transform_point(m, mesh.positions[t.y]) - a, transform_point(m, mesh.positions[t.z]) - a));
}

// A light of given power has as much for each shape that pbrt makes of it; lights: how many those are, 0: each triangle
// is one.
void share_power(Loader& loader, Mesh& mesh, MaterialUse use, const AreaLight& light, std::size_t lights)
{
    const float sides = light.two_sided ? 2.0f : 1.0f;
    constexpr std::size_t most_materials = 1024;
    const auto scale_for = [&](float area) { return area > 0.0f ? light.power / (3.14159265f * area * sides) : 0.0f; };
    if (lights > 0 || mesh.triangles.size() > most_materials) {
        double sum = 0;
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
            sum += static_cast<double>(world_area(mesh, loader.ctm(), i));
        use.light_scale =
            scale_for(static_cast<float>(sum / static_cast<double>(lights > 0 ? lights : mesh.triangles.size())));
        mesh.material = use_material(loader, loader.state.material, use);
        return;
    }
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        // Areas that differ by rounding share a material.
        const float area = world_area(mesh, loader.ctm(), i);
        use.light_scale = scale_for(area > 0.0f ? std::exp(std::round(std::log(area) * 2000.0f) / 2000.0f) : 0.0f);
        mesh.triangle_materials.push_back(use_material(loader, loader.state.material, use));
    }
    if (!mesh.triangle_materials.empty()) mesh.material = mesh.triangle_materials[0];
}

} // namespace

std::optional<MaterialUse> current_use(Loader& loader, const ParameterList& parameters)
{
    const GraphicsState& state = loader.state;
    MaterialUse use;
    use.area_light = state.area_light;
    if (loader.object.valid() && use.area_light != none) {
        loader.warn(parameters.spot, "light in object", "area lights in objects stay dark, as in pbrt");
        use.area_light = none;
    }
    const bool has_medium = state.inside != none && state.inside != state.outside;
    if (has_medium) {
        const Medium& medium = loader.media[state.inside];
        if (medium.scatters)
            loader.warn(parameters.spot, "medium scatters " + medium.name,
                        fmt::format("the medium '{}' is clear here: light does not scatter in media",
                                    medium.name.substr(0, 60)));
        const vec3 a = medium.absorption;
        if (!medium.scatters && (a.x > 0.0f || a.y > 0.0f || a.z > 0.0f)) use.medium = state.inside;
    }
    use.alpha = texture_parameter(loader, parameters, "alpha", true);
    if (use.alpha != none) {
        const TextureNode& node = loader.textures[use.alpha];
        const bool is_constant = node.kind == TextureNode::Kind::value && node.value.is_constant();
        if (is_constant) use.opacity = clamp(node.value.factor.x, 0.0f, 1.0f), use.alpha = none;
        if (use.opacity <= 0.0f) {
            if (use.area_light != none)
                loader.warn(parameters.spot, "invisible light", "an area light with an alpha of 0 is left out");
            return {};
        }
    }
    parameters.ignore({"shadowalpha"});
    if (state.material->is_interface && use.medium == none && use.area_light == none) {
        loader.inform(parameters.spot, "interface", "shapes that only bound a medium are left out");
        return {};
    }
    if (state.ctm[0] != state.ctm[1])
        loader.warn(parameters.spot, "moving shape", "a shape moves; it stands where it is when the shutter opens");
    if (!invert(state.ctm[0])) {
        loader.warn(parameters.spot, "singular", "the transform here has no inverse; what it places is left out");
        return {};
    }
    return use;
}

void place_mesh(Loader& loader, Mesh mesh, const ParameterList& parameters, const std::string& key, std::size_t lights)
{
    const std::optional<MaterialUse> use = current_use(loader, parameters);
    mesh.name = parameters.text("name", mesh.name);
    if (!use || mesh.triangles.empty()) return;
    const bool has_power = use->area_light != none && loader.area_lights[use->area_light].power > 0.0f;
    if (has_power)
        share_power(loader, mesh, *use, loader.area_lights[use->area_light], lights);
    else
        mesh.material = use_material(loader, loader.state.material, *use);
    const bool is_flipped = loader.state.reverse_orientation;

    if (loader.object.valid()) {
        if (is_flipped) flip_mesh(mesh);
        transform_mesh(mesh, loader.ctm());
        const Index<Mesh> index = add(loader.scene, std::move(mesh));
        loader.scene.groups[loader.object.value].meshes.push_back(index);
        return;
    }
    Index<Group> group;
    std::string full_key;
    if (!key.empty() && !has_power) {
        full_key = fmt::format("{} {} {}", key, mesh.material.value, is_flipped);
        if (const auto known = loader.shared_groups.find(full_key); known != loader.shared_groups.end())
            group = known->second;
    }
    if (!group.valid()) {
        if (is_flipped) flip_mesh(mesh);
        Group fresh;
        fresh.name = mesh.name;
        fresh.meshes.push_back(add(loader.scene, std::move(mesh)));
        group = add(loader.scene, fresh);
        if (!full_key.empty()) loader.shared_groups[full_key] = group;
    }
    InstanceDesc instance;
    instance.name = parameters.text("instance", loader.scene.groups[group.value].name);
    instance.group = group;
    instance.transform = to_transform(loader.ctm());
    add(loader.scene, instance);
}

} // namespace snell::pbrt
