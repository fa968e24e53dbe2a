// What materials and their textures say that is probably not meant.
#include "snell/scene/doctor_parts.h"
#include "snell/scene/validate_mesh.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

namespace snell::doctor {

using Severity = Finding::Severity;

static std::string material_label(const Scene& scene, std::size_t index)
{
    return fmt::format("material {}", label(scene.materials[index].name, index));
}

static std::string image_label(const Scene& scene, uint index)
{
    return fmt::format("texture {}", label(scene.images[index].name, index));
}

// ---- where textures are used ----

struct Use
{
    const char* what;
    const TextureRef* ref;
    bool is_data; // numbers or directions, no colours
};

static std::vector<Use> uses_of(const MaterialDesc& m)
{
    std::vector<Use> all;
    all.push_back({"base colour", &m.base_texture, false});
    all.push_back({"emission", &m.emission_texture, false});
    all.push_back({"normal map", &m.normal_texture, true});
    // Opacity is the fourth channel of a colour's texture, which is never decoded, or another file's first.
    if (m.opacity_texture.valid() && m.opacity_texture.channel != 3 && m.coverage != coverage_opaque)
        all.push_back({"opacity", &m.opacity_texture, false});
    if (m.kind == material_principled) {
        const PrincipledDesc& p = m.principled;
        const std::array<Use, 15> more = {{
            {"metallic", &p.metallic_texture, true},
            {"roughness", &p.roughness_texture, true},
            {"specular", &p.specular_texture, p.specular_texture.channel != 3},
            {"specular colour", &p.specular_color_texture, false},
            {"clearcoat", &p.clearcoat_texture, true},
            {"clearcoat roughness", &p.clearcoat_roughness_texture, true},
            {"clearcoat normal map", &p.clearcoat_normal_texture, true},
            {"sheen colour", &p.sheen_color_texture, false},
            {"sheen roughness", &p.sheen_roughness_texture, p.sheen_roughness_texture.channel != 3},
            {"transmission", &p.transmission_texture, true},
            {"anisotropy", &p.anisotropy_texture, true},
            {"iridescence", &p.iridescence_texture, true},
            {"iridescence thickness", &p.iridescence_thickness_texture, true},
            {"diffuse transmission", &p.diffuse_transmission_texture, p.diffuse_transmission_texture.channel != 3},
            {"diffuse transmission colour", &p.diffuse_transmission_color_texture, false},
        }};
        for (const Use& use : more) all.push_back(use);
    }
    std::erase_if(all, [](const Use& use) { return !use.ref->valid(); });
    return all;
}

static void check_encodings(const Scene& scene, std::size_t index, Findings& findings)
{
    for (const Use& use : uses_of(scene.materials[index])) {
        const uint image = use.ref->image.value;
        if (!use.is_data || scene.images[image].format != texels_rgba8_srgb) continue;
        findings.add("srgb-data", Severity::doubtful,
                     fmt::format("{}: its {} ({}) is decoded as a colour from sRGB, but holds numbers; store it as "
                                 "linear data",
                                 material_label(scene, index), use.what, image_label(scene, image)));
    }
}

// A normal map points out of the surface nearly everywhere, so it is blue; a bump map in its place is grey.
static void check_normal_map(const Scene& scene, std::size_t index, Findings& findings)
{
    const MaterialDesc& material = scene.materials[index];
    if (!material.normal_texture.valid()) return;
    const uint number = material.normal_texture.image.value;
    const Image& image = scene.images[number];
    const std::size_t texels = std::size_t{image.width} * image.height;
    const bool is_float = image.format == texels_rgba32f;
    std::size_t looked_at = 0, inwards = 0, grey = 0;
    for (std::size_t i = 0; i < texels; i += texels / 1024 + 1) {
        float c[3];
        for (std::size_t k = 0; k < 3; ++k)
            c[k] = is_float ? image.floats[4 * i + k] : static_cast<float>(image.bytes[4 * i + k]) / 255.0f;
        ++looked_at;
        if (c[2] < 0.48f) ++inwards;
        if (std::abs(c[0] - c[1]) < 0.02f && std::abs(c[1] - c[2]) < 0.02f) ++grey;
    }
    if (grey * 10 < looked_at * 9 && inwards * 2 < looked_at) return;
    findings.add("odd-normal-map", Severity::doubtful,
                 fmt::format("{}: {} is no normal map by its looks ({}); a height map in its place?",
                             material_label(scene, index), image_label(scene, number),
                             grey * 10 < looked_at * 9 ? "it points inwards" : "it is grey"));
}

// ---- colours ----

static void check_albedo(const Scene& scene, std::size_t index, bool has_vertex_colors, Findings& findings)
{
    const MaterialDesc& m = scene.materials[index];
    if (m.base_texture.valid() || has_vertex_colors || is_emissive(m)) return;
    const bool is_diffuse = m.kind == material_diffuse || m.kind == material_mix ||
                            (m.kind == material_principled && m.principled.metallic < 1.0f &&
                             m.principled.transmission < 1.0f && m.principled.diffuse_transmission < 1.0f);
    if (!is_diffuse) return;
    if (m.base_color == vec3(1.0f))
        findings.add("white-albedo", Severity::info,
                     fmt::format("{} reflects all light (colour 1): light goes on for many bounces; real whites are at "
                                 "0.8 to 0.9",
                                 material_label(scene, index)));
}

static void check_sizes(const Scene& scene, Findings& findings)
{
    for (std::size_t i = 0; i < scene.images.size(); ++i) {
        const Image& image = scene.images[i];
        constexpr std::size_t large = std::size_t{8192} * 8192;
        if (std::size_t{image.width} * image.height < large) continue;
        findings.add("huge-texture", Severity::info,
                     fmt::format("{} has {} x {} texels and takes {} MiB", image_label(scene, static_cast<uint>(i)),
                                 image.width, image.height, (image.bytes.size() + 4 * image.floats.size()) >> 20));
    }
}

// ---- who uses what ----

struct UsedBy
{
    bool is_used = false;
    bool has_vertex_colors = false;     // on every mesh
    std::optional<uint> without_uvs[2]; // a mesh that lacks a set of texture coordinates
    std::size_t meshes_without_uvs[2] = {0, 0};
};

static std::vector<UsedBy> find_users(const Scene& scene, const std::vector<MeshFacts>& facts)
{
    std::vector<UsedBy> users(scene.materials.size());
    std::vector<uint> last_mesh(scene.materials.size(), none);
    const auto add_mesh = [&](uint material, uint index) {
        if (last_mesh[material] == index) return;
        last_mesh[material] = index;
        const Mesh& mesh = scene.meshes[index];
        UsedBy& by = users[material];
        by.has_vertex_colors = !mesh.colors.empty() && (by.has_vertex_colors || !by.is_used);
        by.is_used = true;
        for (std::size_t set = 0; set < 2; ++set) {
            if (!(set == 0 ? mesh.uvs : mesh.uvs_1).empty()) continue;
            if (by.meshes_without_uvs[set]++ == 0) by.without_uvs[set] = index;
        }
    };
    for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
        const Mesh& mesh = scene.meshes[i];
        if (!facts[i].is_placed || mesh.triangles.empty()) continue;
        if (mesh.triangle_materials.empty()) add_mesh(mesh.material.value, static_cast<uint>(i));
        for (const Index<MaterialDesc> material : mesh.triangle_materials)
            add_mesh(material.value, static_cast<uint>(i));
    }
    for (const SphereDesc& sphere : scene.spheres) users[sphere.material.value].is_used = true;
    for (const PlaneDesc& plane : scene.planes) users[plane.material.value].is_used = true;
    return users;
}

static void check_coordinates(const Scene& scene, std::size_t index, const UsedBy& by, Findings& findings)
{
    for (uint set = 0; set < 2; ++set) {
        if (!by.without_uvs[set]) continue;
        for (const Use& use : uses_of(scene.materials[index])) {
            if (use.ref->uv_set != set) continue;
            const std::size_t others = by.meshes_without_uvs[set] - 1;
            findings.add(
                "texture-without-uv", Severity::doubtful,
                fmt::format("{}: its {} ({}) needs texture coordinates{}, and {}{} has none: one texel is used "
                            "for all of it",
                            material_label(scene, index), use.what, image_label(scene, use.ref->image.value),
                            set == 1 ? " of the second set" : "", mesh_label(scene, *by.without_uvs[set]),
                            others > 0 ? fmt::format(" (as {} more)", others) : ""),
                by.meshes_without_uvs[set]);
            break; // one for each set is enough
        }
    }
}

void check_materials(const Scene& scene, const std::vector<MeshFacts>& facts, Findings& findings)
{
    const std::vector<UsedBy> users = find_users(scene, facts);
    for (std::size_t i = 0; i < scene.materials.size(); ++i) {
        // Other variants may use what this one does not.
        if (!users[i].is_used) {
            if (scene.variants.empty())
                findings.add("unused-material", Severity::info,
                             fmt::format("{} is not used by anything", material_label(scene, i)));
            continue;
        }
        check_encodings(scene, i, findings);
        check_normal_map(scene, i, findings);
        check_albedo(scene, i, users[i].has_vertex_colors, findings);
        check_coordinates(scene, i, users[i], findings);
    }
    check_sizes(scene, findings);
}

} // namespace snell::doctor
