#include "snell/core/error.h"
#include "snell/kernel/tone.h"
#include "snell/scene/albedo_tables.h"
#include "snell/scene/pack_parts.h"

#include <cmath>
#include <cstring>
#include <map>
#include <tuple>

namespace snell {

// A rougher surface than this is what the GGX formulas take. Below, alpha squared nears the spacing of floats around 1,
// in which they compute, and the lobe (peak 1 / (pi alpha^2) > 300,000) is narrower than a pixel of any picture: such a
// surface is a perfect mirror or glass.
static constexpr float smooth_alpha = 1e-3f;

namespace {
// Gives equal references one slot.
class Slots
{
  public:
    explicit Slots(std::vector<TextureSlot>& slots) : slots_(slots) {}

    uint operator()(const TextureRef& ref)
    {
        if (!ref.valid()) return none;
        const auto key = std::make_tuple(ref.image.value, ref.uv_set, ref.wrap_u, ref.wrap_v, ref.filter, ref.channel,
                                         ref.row_u.x, ref.row_u.y, ref.row_u.z, ref.row_v.x, ref.row_v.y, ref.row_v.z);
        const auto [place, is_new] = numbers_.try_emplace(key, static_cast<uint>(slots_.size()));
        if (is_new)
            slots_.push_back(
                {ref.image.value, ref.uv_set, ref.wrap_u, ref.wrap_v, ref.filter, ref.channel, ref.row_u, ref.row_v});
        return place->second;
    }

  private:
    using Key = std::tuple<uint, uint, uint, uint, uint, uint, float, float, float, float, float, float>;
    std::vector<TextureSlot>& slots_;
    std::map<Key, uint> numbers_;
};
} // namespace

static Principled pack_principled(const PrincipledDesc& desc, Slots& slot)
{
    Principled p = {};
    p.metallic = desc.metallic;
    p.roughness = desc.roughness;
    p.specular = desc.specular;
    p.clearcoat = desc.clearcoat;
    p.clearcoat_roughness = desc.clearcoat_roughness;
    p.clearcoat_normal_scale = desc.clearcoat_normal_scale;
    p.specular_color = desc.specular_color;
    p.sheen_color = desc.sheen_color;
    p.sheen_roughness = desc.sheen_roughness;
    p.transmission = desc.transmission;
    p.thin_walled = desc.thin_walled ? 1u : 0u;
    p.anisotropy = desc.anisotropy;
    p.anisotropy_rotation = desc.anisotropy_rotation;
    p.iridescence = desc.iridescence;
    p.iridescence_ior = desc.iridescence_ior;
    p.iridescence_thickness_min = desc.iridescence_thickness_min;
    p.iridescence_thickness_max = desc.iridescence_thickness_max;
    p.dispersion = desc.dispersion;
    p.diffuse_transmission = desc.diffuse_transmission;
    p.diffuse_transmission_color = desc.diffuse_transmission_color;
    p.metallic_slot = slot(desc.metallic_texture);
    p.roughness_slot = slot(desc.roughness_texture);
    p.specular_slot = slot(desc.specular_texture);
    p.specular_color_slot = slot(desc.specular_color_texture);
    p.clearcoat_slot = slot(desc.clearcoat_texture);
    p.clearcoat_roughness_slot = slot(desc.clearcoat_roughness_texture);
    p.clearcoat_normal_slot = slot(desc.clearcoat_normal_texture);
    p.sheen_color_slot = slot(desc.sheen_color_texture);
    p.sheen_roughness_slot = slot(desc.sheen_roughness_texture);
    p.transmission_slot = slot(desc.transmission_texture);
    p.anisotropy_slot = slot(desc.anisotropy_texture);
    p.iridescence_slot = slot(desc.iridescence_texture);
    p.iridescence_thickness_slot = slot(desc.iridescence_thickness_texture);
    p.diffuse_transmission_slot = slot(desc.diffuse_transmission_texture);
    p.diffuse_transmission_color_slot = slot(desc.diffuse_transmission_color_texture);
    p.glass_table = none;
    return p;
}

// Rough solid glass needs a table for its ior; anisotropy one for all.
static void pack_albedo(PackedScene& packed)
{
    if (packed.principled.empty()) return;
    std::vector<float> iors;
    std::vector<Principled*> glasses;
    bool anisotropic = false;
    for (const Material& m : packed.materials) {
        if (m.principled == none) continue;
        Principled& p = packed.principled[m.principled];
        anisotropic = anisotropic || p.anisotropy > 0.0f;
        if (!(p.transmission > 0.0f) || p.thin_walled != 0u || !(p.roughness > 0.0f)) continue;
        iors.push_back(m.ior);
        glasses.push_back(&p);
    }
    AlbedoTables tables = albedo_tables(iors, anisotropic);
    for (std::size_t i = 0; i < glasses.size(); ++i) glasses[i]->glass_table = tables.glass_table[i];
    packed.albedo = std::move(tables.values);
}

void pack_materials(const Scene& scene, PackedScene& packed)
{
    Slots slot(packed.slots);
    packed.materials.reserve(scene.materials.size());
    for (const MaterialDesc& desc : scene.materials) {
        Material m = {};
        m.base_color = desc.base_color;
        m.kind = desc.kind;
        m.emission = desc.emission;
        m.alpha = desc.alpha < smooth_alpha ? 0.0f : desc.alpha;
        m.specular = desc.specular;
        m.ior = desc.ior;
        m.absorption = desc.absorption;
        if (desc.two_sided_emission) m.flags |= material_two_sided_emission;
        if (desc.texture_tints_specular) m.flags |= material_texture_tints_specular;
        m.base_slot = slot(desc.base_texture);
        m.emission_slot = slot(desc.emission_texture);
        m.normal_slot = slot(desc.normal_texture);
        m.normal_scale = desc.normal_scale;
        m.coverage = desc.coverage;
        m.opacity = desc.opacity;
        m.cutoff = desc.cutoff;
        m.opacity_slot = slot(desc.opacity_texture);
        m.principled = none;
        if (m.normal_slot != none) m.flags |= material_needs_tangents;
        if (desc.kind == material_principled) {
            m.principled = static_cast<uint>(packed.principled.size());
            packed.principled.push_back(pack_principled(desc.principled, slot));
            const Principled& p = packed.principled.back();
            if (p.anisotropy > 0.0f || p.clearcoat_normal_slot != none) m.flags |= material_needs_tangents;
        }
        if (m.kind == material_unlit) m.emission = vec3(0.0f), m.emission_slot = none; // its colour is all it shows
        if (desc.single_sided) m.flags |= material_single_sided;
        if (m.coverage != coverage_opaque) packed.coverage |= scene_has_holes;
        if (desc.single_sided) packed.coverage |= scene_has_single_sided;
        packed.materials.push_back(m);
    }
    pack_albedo(packed);
}

bool is_textured(const Material& material)
{
    return material.principled != none || (material.flags & material_needs_tangents) != 0u ||
           material.base_slot != none || material.emission_slot != none || material.opacity_slot != none;
}

void pack_images(const Scene& scene, PackedScene& packed)
{
    packed.srgb.resize(256);
    for (uint i = 0; i < 256; ++i) packed.srgb[i] = srgb_decode(static_cast<float>(i) / 255.0f);

    std::size_t words = 0;
    for (const Image& image : scene.images)
        words += std::size_t{image.width} * image.height * (image.format == texels_rgba32f ? 4 : 1);
    if (words >= none) throw Error(fmt::format("the textures have {} words of texels; 2^32 is the limit", words));
    packed.texels.resize(words);
    packed.textures.clear();
    std::size_t offset = 0;
    for (const Image& image : scene.images) {
        packed.textures.push_back({static_cast<uint>(offset), image.width, image.height, image.format});
        const bool is_float = image.format == texels_rgba32f;
        const std::size_t bytes = is_float ? image.floats.size() * sizeof(float) : image.bytes.size();
        if (bytes > 0)
            std::memcpy(packed.texels.data() + offset,
                        is_float ? static_cast<const void*>(image.floats.data()) : image.bytes.data(), bytes);
        offset += bytes / 4;
    }
}

} // namespace snell
