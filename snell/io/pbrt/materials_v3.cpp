// The materials of pbrt-v3 that v4 no longer has.
#include "snell/io/pbrt/materials.h"

#include <cmath>

namespace snell::pbrt {
namespace {

float most(vec3 v)
{
    return max(v.x, max(v.y, v.z));
}

// A diffuse base under a dielectric coat whose reflectance at normal incidence is `specular`.
void make_glossy(Making& m, const TextureValue& base, vec3 specular, const Roughness& roughness)
{
    MaterialDesc& d = m.desc();
    set_base(d, base);
    const float f0 = clamp(most(specular), 0.0f, 0.99f);
    if (f0 <= 0.0f) return; // diffuse
    d.kind = material_principled;
    d.ior = (1.0f + std::sqrt(f0)) / (1.0f - std::sqrt(f0));
    d.principled.specular_color = specular / most(specular);
    set_principled_roughness(m, roughness);
}

void make_matte(Making& m)
{
    set_base(m.desc(), m.color("Kd", vec3(0.5f)));
    if (m.plain_number("sigma", 0.0f) != 0.0f)
        m.warn("sigma", "a rough diffuse surface (Oren and Nayar) becomes a Lambertian one");
}

void make_plastic(Making& m)
{
    MaterialDesc& d = m.desc();
    set_base(d, m.color("Kd", vec3(0.25f)));
    const vec3 specular = m.plain_color("Ks", vec3(0.25f));
    const Roughness roughness = read_roughness(m, "", 0.1f);
    if (most(specular) <= 0.0f) return;
    d.kind = material_principled;
    d.principled.specular_color = clamp(specular, 0.0f, 1.0f); // of a coat of index 1.5
    set_principled_roughness(m, roughness);
}

void make_substrate(Making& m)
{
    const vec3 specular = m.plain_color("Ks", vec3(0.5f));
    make_glossy(m, m.color("Kd", vec3(0.5f)), specular, read_roughness(m, "", 0.1f));
    m.inform("kind", "substrate (Ashikhmin and Shirley) becomes a principled surface");
}

void make_glass(Making& m)
{
    MaterialDesc& d = m.desc();
    d.ior = m.index("index", m.index("eta", 1.5f));
    set_base(d, m.color("Kt", vec3(1.0f)));
    const vec3 reflected = m.plain_color("Kr", vec3(1.0f));
    const Roughness roughness = read_roughness(m, "", 0.0f);
    if (most(vec3(1.0f) - reflected) > 0.01f)
        m.warn("Kr", "glass that reflects less than its index says (Kr below 1) reflects as its index says");
    d.kind = material_dielectric;
    d.alpha = roughness.alpha();
    if (roughness.texture || !roughness.is_even()) m.warn("roughness", "glass gets one roughness everywhere, the mean");
}

void make_mirror(Making& m)
{
    m.desc().kind = material_mirror;
    set_base(m.desc(), m.color("Kr", vec3(0.9f)));
}

void make_metal(Making& m)
{
    const Metal metal = m.metal("", "Cu");
    const Roughness roughness = read_roughness(m, "", 0.01f);
    MaterialDesc& d = m.desc();
    if (roughness.texture || !roughness.is_even()) {
        d.kind = material_principled;
        d.principled.metallic = 1.0f;
        d.base_color = normal_reflectance(metal);
        set_principled_roughness(m, roughness);
        return;
    }
    d.kind = material_conductor;
    d.base_color = vec3(1.0f);
    d.specular = metal.eta;
    d.absorption = metal.k;
    d.alpha = roughness.alpha();
}

void make_uber(Making& m)
{
    MaterialDesc& d = m.desc();
    const vec3 specular = m.plain_color("Ks", vec3(0.25f)), mirror = m.plain_color("Kr", vec3(0.0f));
    const vec3 through = m.plain_color("Kt", vec3(0.0f));
    const float eta = m.index("eta", m.index("index", 1.5f));
    const Roughness roughness = read_roughness(m, "", 0.1f);
    set_base(d, m.color("Kd", vec3(0.25f)));
    const vec3 coat = max(specular, mirror);
    if (most(coat) > 0.0f || most(through) > 0.0f) {
        d.kind = material_principled;
        d.ior = eta;
        d.principled.specular_color = clamp(coat, 0.0f, 1.0f);
        set_principled_roughness(m, roughness);
        if (most(mirror) > most(specular)) d.principled.roughness = 0.0f;
        d.principled.transmission = clamp(most(through), 0.0f, 1.0f);
        d.principled.thin_walled = false;
        if (most(mirror) > 0.0f && most(specular) > 0.0f)
            m.warn("Kr", "an uber surface with a glossy and a mirroring part gets the stronger one");
    }
    const TextureValue opacity = m.color("opacity", vec3(1.0f));
    if (!opacity.is_constant() || opacity.factor != vec3(1.0f)) {
        d.coverage = coverage_blend;
        d.opacity = (opacity.factor.x + opacity.factor.y + opacity.factor.z) / 3.0f;
        d.opacity_texture = opacity.ref;
    }
}

void make_translucent(Making& m)
{
    MaterialDesc& d = m.desc();
    const TextureValue color = m.color("Kd", vec3(0.25f));
    const vec3 specular = m.plain_color("Ks", vec3(0.25f));
    const float r = m.plain_number("reflect", 0.5f), t = m.plain_number("transmit", 0.5f);
    const Roughness roughness = read_roughness(m, "", 0.1f);
    const float sum = r + t;
    set_base(d, {color.factor * sum, color.ref});
    d.kind = material_principled;
    d.principled.diffuse_transmission = sum > 0.0f ? clamp(t / sum, 0.0f, 1.0f) : 0.0f;
    d.principled.diffuse_transmission_color = color.factor * sum;
    d.principled.diffuse_transmission_color_texture = color.ref;
    d.principled.specular_color = clamp(specular, 0.0f, 1.0f);
    if (most(specular) <= 0.0f) d.principled.specular = 0.0f;
    set_principled_roughness(m, roughness);
}

void make_disney(Making& m)
{
    MaterialDesc& d = m.desc();
    PrincipledDesc& p = d.principled;
    d.kind = material_principled;
    set_base(d, m.color("color", vec3(0.5f)));
    d.ior = m.index("eta", 1.5f);
    p.metallic = m.plain_number("metallic", 0.0f);
    p.roughness = m.plain_number("roughness", 0.5f);
    p.anisotropy = std::sqrt(clamp(m.plain_number("anisotropic", 0.0f), 0.0f, 1.0f));
    p.clearcoat = 0.25f * m.plain_number("clearcoat", 0.0f);
    p.clearcoat_roughness = std::sqrt(mix(0.1f, 0.001f, clamp(m.plain_number("clearcoatgloss", 1.0f), 0.0f, 1.0f)));
    const float sheen = m.plain_number("sheen", 0.0f), tint = m.plain_number("sheentint", 0.5f);
    p.sheen_color = sheen * mix(vec3(1.0f), d.base_color, tint);
    if (sheen > 0.0f) p.sheen_roughness = 0.5f;
    p.transmission = m.plain_number("spectrans", 0.0f);
    p.thin_walled = m.parameters.flag("thin", false);
    p.diffuse_transmission = p.thin_walled ? 0.5f * m.plain_number("difftrans", 0.0f) : 0.0f;
    m.parameters.ignore({"speculartint", "flatness", "scatterdistance", "difftrans"});
    m.inform("kind", "disney becomes a principled surface");
}

} // namespace

bool make_material_v3(Making& m)
{
    if (m.type == "matte")
        make_matte(m);
    else if (m.type == "plastic")
        make_plastic(m);
    else if (m.type == "substrate")
        make_substrate(m);
    else if (m.type == "glass")
        make_glass(m);
    else if (m.type == "mirror")
        make_mirror(m);
    else if (m.type == "metal")
        make_metal(m);
    else if (m.type == "uber")
        make_uber(m);
    else if (m.type == "translucent")
        make_translucent(m);
    else if (m.type == "disney")
        make_disney(m);
    else
        return false;
    return true;
}

} // namespace snell::pbrt
