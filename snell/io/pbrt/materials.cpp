// The materials of pbrt-v4.
#include "snell/io/pbrt/materials.h"

#include "snell/io/text_cursor.h"

#include <cmath>

namespace snell::pbrt {
namespace {

void make_diffuse(Making& m)
{
    set_base(m.desc(), m.color("reflectance", vec3(0.5f)));
    if (m.plain_number("sigma", 0.0f) != 0.0f)
        m.warn("sigma", "a rough diffuse surface (Oren and Nayar) becomes a Lambertian one");
}

void make_conductor(Making& m)
{
    const Metal metal = m.metal("", "Cu");
    const Roughness roughness = read_roughness(m, "", 0.0f);
    const Parameter* reflectance = m.parameters.find("reflectance");
    const bool is_textured = reflectance != nullptr && reflectance->type == Type::texture;
    if (roughness.texture || !roughness.is_even() || is_textured) {
        m.desc().kind = material_principled;
        m.desc().principled.metallic = 1.0f;
        if (is_textured)
            set_base(m.desc(), m.color("reflectance", vec3(0.5f)));
        else
            m.desc().base_color = normal_reflectance(metal);
        set_principled_roughness(m, roughness);
        m.inform("varied", "a metal that varies or has a direction gets Schlick's approximation of its reflectance");
        return;
    }
    m.desc().kind = material_conductor;
    m.desc().specular = metal.eta;
    m.desc().absorption = metal.k;
    m.desc().base_color = vec3(1.0f);
    m.desc().alpha = roughness.alpha();
}

void make_dielectric(Making& m)
{
    m.desc().ior = m.index("eta", 1.5f);
    set_base(m.desc(), m.color("tint", vec3(1.0f))); // ours
    m.desc().absorption = m.plain_color("absorption", vec3(0.0f));
    const Roughness roughness = read_roughness(m, "", 0.0f);
    if (roughness.texture || !roughness.is_even()) {
        m.desc().kind = material_principled;
        m.desc().principled.transmission = 1.0f;
        m.desc().principled.thin_walled = false;
        set_principled_roughness(m, roughness);
        return;
    }
    m.desc().kind = material_dielectric;
    m.desc().alpha = roughness.alpha();
}

void make_thin_dielectric(Making& m)
{
    MaterialDesc& d = m.desc();
    d.kind = material_principled;
    d.base_color = vec3(1.0f);
    d.ior = m.index("eta", 1.5f);
    d.principled.transmission = 1.0f;
    d.principled.thin_walled = true;
    d.principled.roughness = 0.0f;
    m.inform("kind", "thindielectric reflects once, without the reflections between its two sides");
}

// Parameters of layered materials that have no counterpart.
void ignore_layers(Making& m)
{
    m.parameters.ignore({"thickness", "maxdepth", "nsamples", "twosided"});
    const vec3 albedo = m.plain_color("albedo", vec3(0.0f));
    if (max(albedo.x, max(albedo.y, albedo.z)) > 0.0f)
        m.warn("albedo", fmt::format("the medium between the layers of {} is left out", m.type));
    m.parameters.ignore({"g"});
}

void make_coated_diffuse(Making& m)
{
    MaterialDesc& d = m.desc();
    d.kind = material_principled;
    set_base(d, m.color("reflectance", vec3(0.5f)));
    d.ior = m.index("eta", 1.5f);
    set_principled_roughness(m, read_roughness(m, "", 0.0f));
    ignore_layers(m);
    m.warn("kind", "coateddiffuse becomes a principled surface: light does not bounce between coat and base");
}

void make_coated_conductor(Making& m)
{
    MaterialDesc& d = m.desc();
    d.kind = material_principled;
    d.principled.metallic = 1.0f;
    d.base_color = normal_reflectance(m.metal("conductor.", "Cu"));
    set_principled_roughness(m, read_roughness(m, "conductor.", 0.0f));
    d.principled.clearcoat = 1.0f;
    d.principled.clearcoat_roughness = std::sqrt(read_roughness(m, "interface.", 0.0f).alpha());
    if (const float eta = m.index("interface.eta", 1.5f); std::abs(eta - 1.5f) > 0.01f)
        m.warn("interface.eta", "a coat of an index other than 1.5 gets 1.5");
    ignore_layers(m);
    m.warn("kind", "coatedconductor becomes a principled metal with a clear coat: light does not bounce between them");
}

void make_diffuse_transmission(Making& m)
{
    MaterialDesc& d = m.desc();
    const float scale = m.parameters.number("scale", 1.0f);
    const TextureValue reflected = m.color("reflectance", vec3(0.25f));
    const TextureValue through = m.color("transmittance", vec3(0.25f));
    const vec3 r = scale * reflected.factor, t = scale * through.factor;
    const float most_r = max(r.x, max(r.y, r.z)), most_t = max(t.x, max(t.y, t.z));
    d.kind = material_principled;
    d.principled.specular = 0.0f;
    d.principled.roughness = 1.0f;
    const float part = most_r + most_t > 0.0f ? most_t / (most_r + most_t) : 0.0f;
    d.principled.diffuse_transmission = part;
    d.base_color = part < 1.0f ? r / (1.0f - part) : vec3(0.0f);
    d.base_texture = reflected.ref;
    d.principled.diffuse_transmission_color = part > 0.0f ? t / part : vec3(0.0f);
    d.principled.diffuse_transmission_color_texture = through.ref;
}

// The diffuse reflectance of a half space that scatters (Jensen et al. 2001, A Practical Model for Subsurface Light
// Transport), with a boundary of index eta.
vec3 subsurface_reflectance(vec3 absorption, vec3 scattering, float eta)
{
    const float inner = -1.440f / (eta * eta) + 0.710f / eta + 0.668f + 0.0636f * eta;
    const float a = (1 + inner) / (1 - inner);
    vec3 result(0.0f);
    for (int c = 0; c < 3; ++c) {
        const float sum = absorption[c] + scattering[c];
        const float albedo = sum > 0.0f ? clamp(scattering[c] / sum, 0.0f, 1.0f) : 0.0f;
        const float s = std::sqrt(3.0f * (1.0f - albedo));
        result[c] = 0.5f * albedo * (1.0f + std::exp(-4.0f / 3.0f * a * s)) * std::exp(-s);
    }
    return result;
}

void make_subsurface(Making& m)
{
    MaterialDesc& d = m.desc();
    d.kind = material_principled;
    d.ior = m.index("eta", 1.33f);
    if (m.parameters.has("reflectance"))
        set_base(d, m.color("reflectance", vec3(0.5f)));
    else if (m.parameters.has("Kd"))
        set_base(d, m.color("Kd", vec3(0.5f)));
    else {
        // pbrt's defaults: skim milk, per millimetre
        const vec3 absorption = m.plain_color("sigma_a", vec3(0.0011f, 0.0024f, 0.014f));
        const vec3 scattering = m.plain_color("sigma_s", vec3(2.55f, 3.21f, 3.77f));
        d.base_color = subsurface_reflectance(absorption, scattering * (1.0f - m.parameters.number("g", 0.0f)), d.ior);
    }
    set_principled_roughness(m, read_roughness(m, "", 0.0f));
    m.parameters.ignore({"scale", "mfp", "g", "name", "sigma_a", "sigma_s", "sigma_prime_s"});
    m.warn("kind",
           fmt::format("{} becomes an opaque surface of about its colour: light does not travel under it", m.type));
}

void make_hair(Making& m)
{
    vec3 color(0.25f, 0.14f, 0.08f);
    color = m.plain_color("color", m.plain_color("reflectance", color));
    m.desc().base_color = color;
    for (const Parameter& parameter : m.parameters.all()) parameter.used = true;
    m.warn("kind", "hair becomes a diffuse surface");
}

void make_mix(Making& m)
{
    std::vector<std::string> names;
    for (const std::string& name : m.parameters.texts("materials")) names.push_back(name);
    TextureValue amount = m.number("amount", 0.5f);
    if (names.size() != 2) {
        names = {m.parameters.text("namedmaterial1"), m.parameters.text("namedmaterial2")};
        std::swap(names[0], names[1]); // v3's amount is that of the first
    }
    std::shared_ptr<MaterialEntry> parts[2];
    for (std::size_t i = 0; i < 2; ++i) {
        const auto known = m.loader.materials.find(names[i]);
        if (known == m.loader.materials.end() || !known->second->is_defined || known->second.get() == &m.entry) {
            m.warn("parts",
                   fmt::format("a mix needs two materials that are defined before; {} is none", show_word(names[i])));
            return;
        }
        parts[i] = known->second;
    }
    mix_materials(m, *parts[0], *parts[1], amount);
}

void read_surface(Making& m)
{
    MaterialDesc& d = m.desc();
    if (const std::string map = m.parameters.text("normalmap"); !map.empty()) {
        PendingImage image;
        image.path = m.loader.resolve(map, m.parameters.spot);
        image.is_color = false;
        image.spot = m.parameters.spot;
        d.normal_texture.image = add_image(m.loader, std::move(image), map);
    }
    for (const std::string_view bump : {"displacement", "bumpmap"})
        if (const Parameter* p = m.parameters.find(bump))
            m.loader.warn(p->spot, "bump", "bump maps are left out: surfaces are smooth");
}

} // namespace

void make_material(Loader& loader, MaterialEntry& entry, const std::string& type, const ParameterList& parameters)
{
    struct Maker
    {
        std::string_view type;
        void (*make)(Making&);
    };
    static constexpr Maker makers[] = {{"diffuse", make_diffuse},
                                       {"conductor", make_conductor},
                                       {"dielectric", make_dielectric},
                                       {"thindielectric", make_thin_dielectric},
                                       {"coateddiffuse", make_coated_diffuse},
                                       {"coatedconductor", make_coated_conductor},
                                       {"diffusetransmission", make_diffuse_transmission},
                                       {"subsurface", make_subsurface},
                                       {"kdsubsurface", make_subsurface},
                                       {"hair", make_hair},
                                       {"mix", make_mix}};
    Making making{loader, parameters, entry, type.substr(0, 40)};
    parameters.ignore({"type"});
    const Maker* maker = nullptr;
    for (const Maker& each : makers)
        if (each.type == type) maker = &each;
    if (maker != nullptr)
        maker->make(making);
    else if (type.empty() || type == "interface" || type == "none")
        entry.is_interface = true;
    else if (!make_own_material(making) && !make_material_v3(making)) {
        entry.desc.base_color = vec3(0.5f);
        making.warn("kind", fmt::format("materials of type {} are not there; grey stands in", show_word(type)));
        for (const Parameter& parameter : parameters.all()) parameter.used = true;
    }
    read_surface(making);
    read_common_parameters(making);
    parameters.report_unused(fmt::format("Material \"{}\"", making.type), loader.notes);
}

} // namespace snell::pbrt
