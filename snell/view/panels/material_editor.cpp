#include "snell/view/panels/material_editor.h"

#include <imgui.h>

#include <array>

namespace snell::view {

static bool section(const char* label, bool open = false)
{
    return ImGui::CollapsingHeader(label, open ? ImGuiTreeNodeFlags_DefaultOpen : 0);
}

static void edit_roughness(Fields& f, MaterialDesc& m)
{
    f.part("Roughness (alpha)", m.alpha,
           "Width of the microfacet distribution: alpha of GGX (Trowbridge-Reitz). 0 is perfectly smooth.");
}

static void edit_layers(Fields& f, MaterialDesc& m, const Scene& s)
{
    PrincipledDesc& p = m.principled;
    if (section("Base", true)) {
        f.color("Base colour", m.base_color, "Albedo of the dielectric, reflectance of the metal at normal incidence.");
        f.texture("Base colour map", m.base_texture, s, "Multiplies the base colour.");
        f.part("Metallic", p.metallic, "Between a dielectric (0) and a conductor (1).");
        f.texture("Metallic map", p.metallic_texture, s, "Multiplies metallic.");
        f.part("Roughness", p.roughness, "Perceptual roughness: its square is the alpha of GGX.");
        f.texture("Roughness map", p.roughness_texture, s, "Multiplies roughness.");
        f.slide("Index of refraction", m.ior, 1.0f, 3.0f, "Inside over outside: decides the Fresnel reflectance.");
    }
    if (section("Specular")) {
        f.part("Specular", p.specular, "Strength of the dielectric reflection (KHR_materials_specular).");
        f.texture("Specular map", p.specular_texture, s, "Multiplies specular.");
        f.light("Specular colour", p.specular_color, "F0: tint of the dielectric reflection at normal incidence.");
        f.texture("Specular colour map", p.specular_color_texture, s, "Multiplies the specular colour.");
    }
    if (section("Clearcoat")) {
        f.part("Clearcoat", p.clearcoat, "A thin layer of lacquer above everything else: its strength.");
        f.texture("Clearcoat map", p.clearcoat_texture, s, "Multiplies clearcoat.");
        f.part("Clearcoat roughness", p.clearcoat_roughness, "Perceptual roughness of the lacquer.");
        f.texture("Clearcoat roughness map", p.clearcoat_roughness_texture, s, "Multiplies the lacquer's roughness.");
        f.texture("Clearcoat normals", p.clearcoat_normal_texture, s, "Normal map of the lacquer alone.");
        f.drag("Clearcoat normal scale", p.clearcoat_normal_scale, 0.01f, -10.0f, 10.0f, "How far its normals bend.");
    }
    if (section("Sheen")) {
        f.color("Sheen colour", p.sheen_color, "Retroreflection of cloth at grazing angles (Charlie distribution).");
        f.texture("Sheen colour map", p.sheen_color_texture, s, "Multiplies the sheen colour.");
        f.part("Sheen roughness", p.sheen_roughness, "How far the fibres stray.");
        f.texture("Sheen roughness map", p.sheen_roughness_texture, s, "Multiplies the sheen's roughness.");
    }
    if (section("Transmission")) {
        f.part("Transmission", p.transmission, "Part of the light that goes through instead of being scattered.");
        f.texture("Transmission map", p.transmission_texture, s, "Multiplies transmission.");
        f.flag("Thin-walled", p.thin_walled, "Light goes straight through; else it refracts into a solid.");
        if (!p.thin_walled) {
            f.light("Absorption", m.absorption, "Beer-Lambert coefficient inside, per scene unit.");
            f.slide("Dispersion", p.dispersion, 0.0f, 5.0f, "20 over the Abbe number: colours refract differently.");
        }
        f.part("Diffuse transmission", p.diffuse_transmission, "Part of the diffuse light that leaves at the back.");
        f.texture("Diffuse transmission map", p.diffuse_transmission_texture, s, "Multiplies it.");
        f.color("Its colour", p.diffuse_transmission_color, "Tint of the diffuse transmission.");
        f.texture("Its colour map", p.diffuse_transmission_color_texture, s, "Multiplies that tint.");
    }
    if (section("Anisotropy")) {
        f.part("Anisotropy", p.anisotropy, "Stretches the highlight, as brushed metal does.");
        f.drag("Direction", p.anisotropy_rotation, 0.01f, -6.2832f, 6.2832f, "Radians from the tangent.");
        f.texture("Anisotropy map", p.anisotropy_texture, s, "Red and green: direction; blue: strength.");
    }
    if (section("Iridescence")) {
        f.part("Iridescence", p.iridescence, "Interference of a thin film (Belcour and Barla 2017): its strength.");
        f.texture("Iridescence map", p.iridescence_texture, s, "Multiplies iridescence.");
        f.slide("Film's index", p.iridescence_ior, 1.0f, 5.0f, "Index of refraction of the film.");
        f.drag("Thinnest, nm", p.iridescence_thickness_min, 1.0f, 0.0f, 5000.0f, "Thickness where the map is 0.");
        f.drag("Thickest, nm", p.iridescence_thickness_max, 1.0f, 0.0f, 5000.0f, "Thickness where it is 1, or no map.");
        f.texture("Thickness map", p.iridescence_thickness_texture, s, "Chooses between the two thicknesses.");
    }
}

static void edit_kind(Fields& f, MaterialDesc& m, const Scene& s)
{
    switch (m.kind) {
    case material_diffuse:
        f.color("Reflectance", m.base_color, "Albedo of a Lambertian surface.");
        f.texture("Reflectance map", m.base_texture, s, "Multiplies the albedo.");
        break;
    case material_mirror:
        f.color("Reflectance", m.base_color, "What a perfect mirror reflects.");
        f.texture("Reflectance map", m.base_texture, s, "Multiplies the reflectance.");
        break;
    case material_mix:
        f.color("Diffuse", m.base_color, "Diffuse albedo. With the specular reflectance it may not exceed 1.");
        f.texture("Diffuse map", m.base_texture, s, "Multiplies the diffuse albedo.");
        f.color("Specular", m.specular, "Specular reflectance, the same at all angles.");
        f.flag("Map tints specular", m.texture_tints_specular, "The map multiplies the specular part as well.");
        edit_roughness(f, m);
        break;
    case material_dielectric:
        f.slide("Index of refraction", m.ior, 1.0f, 3.0f, "Inside over outside (Snell's law, Fresnel's equations).");
        f.color("Tint", m.base_color, "Multiplies what is reflected and refracted; real glass has 1.");
        f.texture("Tint map", m.base_texture, s, "Multiplies the tint.");
        f.light("Absorption", m.absorption, "Beer-Lambert coefficient inside, per scene unit.");
        edit_roughness(f, m);
        break;
    case material_conductor:
        f.light("eta", m.specular, "Real part of the complex index of refraction, by colour.");
        f.light("k", m.absorption, "Imaginary part: the extinction coefficient, by colour.");
        edit_roughness(f, m);
        break;
    case material_unlit:
        f.color("Colour", m.base_color, "Shown as it is: the surface scatters nothing and lights nothing.");
        f.texture("Colour map", m.base_texture, s, "Multiplies the colour.");
        break;
    default:
        edit_layers(f, m, s);
    }
}

void edit_material(Fields& f, MaterialDesc& m, const Scene& s)
{
    static constexpr std::array kinds = {
        "diffuse", "mirror", "diffuse and specular", "dielectric (glass)", "conductor (metal)", "unlit", "principled"};
    static_assert(kinds.size() == material_kinds);
    static constexpr std::array coverages = {"opaque", "mask", "blend"};
    f.choice("Kind", m.kind, kinds, "The scattering model (BSDF).");
    edit_kind(f, m, s);
    if (m.kind != material_unlit && section("Emission", !is_black(m.emission))) {
        f.light("Emission", m.emission, "Radiance that the surface emits, as an area light.");
        f.texture("Emission map", m.emission_texture, s, "Multiplies the emission.");
        f.flag("Both sides", m.two_sided_emission, "Emits from the back as well as from the side of the normal.");
    }
    if (section("Surface")) {
        f.texture("Normal map", m.normal_texture, s, "Bends the shading normal: tangent space, green up.");
        if (m.normal_texture.valid())
            f.drag("Normal scale", m.normal_scale, 0.01f, -10.0f, 10.0f, "How far the normals are bent.");
        f.choice("Coverage", m.coverage, coverages, "Alpha mode: whether the surface has holes.");
        if (m.coverage != coverage_opaque) {
            f.part("Opacity", m.opacity, "Alpha: the probability that a ray finds the surface there.");
            f.texture("Opacity map", m.opacity_texture, s, "Multiplies the opacity.");
        }
        if (m.coverage == coverage_mask) f.part("Cutoff", m.cutoff, "Below this opacity there is nothing.");
        f.flag("Single-sided", m.single_sided, "Camera rays do not see it from behind (back-face culling).");
    }
}

} // namespace snell::view
