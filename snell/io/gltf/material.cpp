#include "snell/io/gltf/material.h"

#include "snell/io/gltf/texture_ref.h"

#include <algorithm>
#include <cmath>

namespace snell::gltf {
namespace {

float unit(double value)
{
    return std::isfinite(value) ? static_cast<float>(std::clamp(value, 0.0, 1.0)) : 0.0f;
}

vec3 to_vec3(const std::vector<double>& numbers, vec3 otherwise)
{
    if (numbers.size() < 3) return otherwise;
    return vec3(glm::dvec3(numbers[0], numbers[1], numbers[2]));
}

// Reflectance at normal incidence of the ior 1.5 that a principled material has by default.
constexpr float default_f0 = 0.04f;

// Converts one material; each function takes over one part of it.
class Converter
{
  public:
    Converter(const Document& document, const tinygltf::Material& source, std::string who, Images& images,
              Remarks& remarks)
        : source_(source), who_(std::move(who)), remarks_(remarks), textures_(document, images, remarks, who_)
    {
    }

    MaterialDesc convert()
    {
        out_ = default_material();
        out_.name = source_.name;
        if (const Fields glossy = extension("KHR_materials_pbrSpecularGlossiness"); glossy.exists())
            specular_glossiness(glossy);
        else
            metallic_roughness();
        coverage();
        if (extension("KHR_materials_unlit").exists()) {
            // It shows its base colour, whatever else it has.
            out_.kind = material_unlit;
            out_.principled = PrincipledDesc{};
            out_.single_sided = !source_.doubleSided;
            return std::move(out_);
        }
        surface();
        specular();
        clearcoat();
        sheen();
        transmission();
        anisotropy();
        iridescence();
        const PrincipledDesc& p = out_.principled;
        out_.single_sided = !source_.doubleSided && p.transmission == 0.0f && p.diffuse_transmission == 0.0f;
        return std::move(out_);
    }

  private:
    Fields extension(const char* name) const { return Fields(source_.extensions, name); }

    void metallic_roughness()
    {
        const tinygltf::PbrMetallicRoughness& pbr = source_.pbrMetallicRoughness;
        base(pbr.baseColorFactor, pbr.baseColorTexture);
        PrincipledDesc& p = out_.principled;
        p.metallic = unit(pbr.metallicFactor);
        p.roughness = unit(pbr.roughnessFactor);
        p.metallic_texture = textures_.make(pbr.metallicRoughnessTexture, Content::data, 2);
        p.roughness_texture = textures_.make(pbr.metallicRoughnessTexture, Content::data, 1);
    }

    // A dielectric whose reflectance at normal incidence is the specular colour.
    void specular_glossiness(const Fields& glossy)
    {
        base(glossy.numbers("diffuseFactor"), TextureUse(glossy, "diffuseTexture"));
        const TextureUse texture(glossy, "specularGlossinessTexture");
        const float glossiness = unit(glossy.number("glossinessFactor", 1.0));
        PrincipledDesc& p = out_.principled;
        p.metallic = 0.0f;
        p.specular_color = max(to_vec3(glossy.numbers("specularFactor"), vec3(1.0f)), vec3(0.0f)) / default_f0;
        p.specular_color_texture = textures_.make(texture, Content::color);
        p.roughness = texture.exists() ? 1.0f : 1.0f - glossiness;
        p.roughness_texture = textures_.make_roughness(texture, glossiness);
    }

    void base(const std::vector<double>& factor, const TextureUse& texture)
    {
        if (factor.size() == 4) {
            out_.base_color = to_vec3(factor, vec3(1.0f));
            out_.opacity = unit(factor[3]);
        }
        out_.base_texture = textures_.make(texture, Content::color);
    }

    void coverage()
    {
        if (source_.alphaMode == "OPAQUE") {
            out_.opacity = 1.0f;
            return;
        }
        if (source_.alphaMode == "MASK") {
            out_.coverage = coverage_mask;
            out_.cutoff = static_cast<float>(source_.alphaCutoff);
        } else if (source_.alphaMode == "BLEND") {
            out_.coverage = coverage_blend;
        } else {
            remarks_.warn("alpha mode",
                          fmt::format("{}: alpha mode '{}' is not known; it is opaque", who_, source_.alphaMode));
            out_.opacity = 1.0f;
            return;
        }
        out_.opacity_texture = out_.base_texture;
        out_.opacity_texture.channel = 3;
    }

    void surface()
    {
        const double strength = extension("KHR_materials_emissive_strength").number("emissiveStrength", 1.0);
        out_.emission = to_vec3(source_.emissiveFactor, vec3(0.0f)) * static_cast<float>(strength);
        if (!is_black(out_.emission)) out_.emission_texture = textures_.make(source_.emissiveTexture, Content::color);
        out_.two_sided_emission = source_.doubleSided;
        const TextureUse normal(source_.normalTexture);
        out_.normal_texture = textures_.make(normal, Content::normal);
        out_.normal_scale = normal.scale;
    }

    void specular()
    {
        const double ior = extension("KHR_materials_ior").number("ior", 1.5);
        PrincipledDesc& p = out_.principled;
        if (ior == 0.0)
            p.specular_color /= default_f0; // says that the reflectance is the specular colour itself
        else
            out_.ior = static_cast<float>(std::max(ior, 1.0));
        p.dispersion =
            static_cast<float>(std::max(extension("KHR_materials_dispersion").number("dispersion", 0.0), 0.0));

        const Fields fields = extension("KHR_materials_specular");
        if (!fields.exists()) return;
        p.specular = unit(fields.number("specularFactor", 1.0));
        p.specular_texture = textures_.make(TextureUse(fields, "specularTexture"), Content::alpha, 3);
        p.specular_color *= max(to_vec3(fields.numbers("specularColorFactor"), vec3(1.0f)), vec3(0.0f));
        const TextureUse texture(fields, "specularColorTexture");
        if (texture.exists()) p.specular_color_texture = textures_.make(texture, Content::color);
    }

    void clearcoat()
    {
        const Fields fields = extension("KHR_materials_clearcoat");
        const float factor = unit(fields.number("clearcoatFactor", 0.0));
        if (factor == 0.0f) return;
        PrincipledDesc& p = out_.principled;
        p.clearcoat = factor;
        p.clearcoat_texture = textures_.make(TextureUse(fields, "clearcoatTexture"), Content::data, 0);
        p.clearcoat_roughness = unit(fields.number("clearcoatRoughnessFactor", 0.0));
        p.clearcoat_roughness_texture =
            textures_.make(TextureUse(fields, "clearcoatRoughnessTexture"), Content::data, 1);
        const TextureUse normal(fields, "clearcoatNormalTexture");
        p.clearcoat_normal_texture = textures_.make(normal, Content::normal);
        p.clearcoat_normal_scale = normal.scale;
    }

    void sheen()
    {
        const Fields fields = extension("KHR_materials_sheen");
        const vec3 color = to_vec3(fields.numbers("sheenColorFactor"), vec3(0.0f));
        if (is_black(color)) return;
        PrincipledDesc& p = out_.principled;
        p.sheen_color = color;
        p.sheen_color_texture = textures_.make(TextureUse(fields, "sheenColorTexture"), Content::color);
        p.sheen_roughness = unit(fields.number("sheenRoughnessFactor", 0.0));
        p.sheen_roughness_texture = textures_.make(TextureUse(fields, "sheenRoughnessTexture"), Content::alpha, 3);
    }

    void transmission()
    {
        PrincipledDesc& p = out_.principled;
        const Fields through = extension("KHR_materials_transmission");
        p.transmission = unit(through.number("transmissionFactor", 0.0));
        if (p.transmission > 0.0f)
            p.transmission_texture = textures_.make(TextureUse(through, "transmissionTexture"), Content::data, 0);

        const Fields diffuse = extension("KHR_materials_diffuse_transmission");
        p.diffuse_transmission = unit(diffuse.number("diffuseTransmissionFactor", 0.0));
        if (p.diffuse_transmission > 0.0f) {
            p.diffuse_transmission_texture =
                textures_.make(TextureUse(diffuse, "diffuseTransmissionTexture"), Content::alpha, 3);
            p.diffuse_transmission_color = to_vec3(diffuse.numbers("diffuseTransmissionColorFactor"), vec3(1.0f));
            p.diffuse_transmission_color_texture =
                textures_.make(TextureUse(diffuse, "diffuseTransmissionColorTexture"), Content::color);
        }

        const Fields volume = extension("KHR_materials_volume");
        p.thin_walled = !(volume.number("thicknessFactor", 0.0) > 0.0);
        const double distance = volume.number("attenuationDistance", 0.0); // without one there is no attenuation
        if (p.thin_walled || !(distance > 0.0)) return;
        // A colour of 0 would absorb without end.
        const vec3 color = clamp(to_vec3(volume.numbers("attenuationColor"), vec3(1.0f)), vec3(1e-6f), vec3(1.0f));
        out_.absorption = max(-log(color) / static_cast<float>(distance), vec3(0.0f));
    }

    void anisotropy()
    {
        const Fields fields = extension("KHR_materials_anisotropy");
        PrincipledDesc& p = out_.principled;
        p.anisotropy = unit(fields.number("anisotropyStrength", 0.0));
        if (p.anisotropy == 0.0f) return;
        p.anisotropy_rotation = static_cast<float>(fields.number("anisotropyRotation", 0.0));
        p.anisotropy_texture = textures_.make(TextureUse(fields, "anisotropyTexture"), Content::anisotropy);
    }

    void iridescence()
    {
        const Fields fields = extension("KHR_materials_iridescence");
        PrincipledDesc& p = out_.principled;
        p.iridescence = unit(fields.number("iridescenceFactor", 0.0));
        if (p.iridescence == 0.0f) return;
        p.iridescence_texture = textures_.make(TextureUse(fields, "iridescenceTexture"), Content::data, 0);
        p.iridescence_ior = static_cast<float>(std::max(fields.number("iridescenceIor", 1.3), 1.0));
        p.iridescence_thickness_min =
            static_cast<float>(std::max(fields.number("iridescenceThicknessMinimum", 100.0), 0.0));
        p.iridescence_thickness_max =
            static_cast<float>(std::max(fields.number("iridescenceThicknessMaximum", 400.0), 0.0));
        p.iridescence_thickness_texture =
            textures_.make(TextureUse(fields, "iridescenceThicknessTexture"), Content::data, 1);
    }

    const tinygltf::Material& source_;
    std::string who_;
    Remarks& remarks_;
    TextureRefs textures_;
    MaterialDesc out_;
};

} // namespace

MaterialDesc to_material(const Document& document, std::size_t index, Images& images, Remarks& remarks)
{
    const tinygltf::Material& source = document.model.materials[index];
    return Converter(document, source, label("material", index, source.name), images, remarks).convert();
}

MaterialDesc default_material()
{
    MaterialDesc material;
    material.kind = material_principled;
    material.base_color = vec3(1.0f);
    material.principled.metallic = 1.0f;
    material.principled.roughness = 1.0f;
    return material;
}

} // namespace snell::gltf
