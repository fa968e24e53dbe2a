// Materials: pbrt's where it has them, else ours.
#include "snell/io/pbrt/slots.h"
#include "snell/io/pbrt/write_parts.h"

namespace snell::pbrt {
namespace {

class MaterialText
{
  public:
    MaterialText(Writer& writer, const MaterialDesc& desc) : w_(writer), m_(desc) {}

    std::string write(bool is_lamp)
    {
        model();
        common(is_lamp);
        return std::move(text_);
    }

  private:
    void type(const char* name) { text_ = fmt::format("\"string type\" \"{}\"", name); }
    void number(std::string_view name, float value) { text_ += fmt::format(" \"float {}\" {}", name, value); }
    void color(std::string_view name, vec3 value) { text_ += fmt::format(" \"rgb {}\" [ {} ]", name, show(value)); }
    void flag(std::string_view name, bool value) { text_ += fmt::format(" \"bool {}\" {}", name, value); }
    void texture(std::string_view name, const std::string& which)
    {
        text_ += fmt::format(" \"texture {}\" \"{}\"", name, which);
    }

    // A colour, or a texture that has it as its factor.
    void base(std::string_view name)
    {
        if (m_.base_texture.valid())
            texture(name, write_texture(w_, m_.base_texture, false, m_.base_color));
        else
            color(name, m_.base_color);
    }

    // Our own parameters, of which there may be a value, a texture or both; missing ones have their usual value, and
    // beside a texture 1.
    void number_slot(std::string_view name, float value, float usual, const TextureRef* ref)
    {
        const bool has_texture = ref != nullptr && ref->valid();
        if (value != (has_texture ? 1.0f : usual)) number(name, value);
        if (has_texture) texture(name, write_texture(w_, *ref, true));
    }
    void color_slot(std::string_view name, vec3 value, vec3 usual, const TextureRef& ref)
    {
        if (value != (ref.valid() ? vec3(1.0f) : usual)) color(name, value);
        if (ref.valid()) texture(name, write_texture(w_, ref, false));
    }

    void roughness()
    {
        if (m_.alpha > 0.0f) number("roughness", m_.alpha), flag("remaproughness", false);
    }

    void model()
    {
        switch (m_.kind) {
        case material_diffuse:
            type("diffuse");
            base("reflectance");
            break;
        case material_mirror:
            type("mirror"); // of v3
            base("Kr");
            break;
        case material_conductor:
            type("conductor");
            color("eta", m_.specular);
            color("k", m_.absorption);
            roughness();
            break;
        case material_dielectric:
            type("dielectric");
            number("eta", m_.ior);
            if (m_.base_texture.valid() || m_.base_color != vec3(1.0f)) base("tint");
            if (m_.absorption != vec3(0.0f)) color("absorption", m_.absorption);
            roughness();
            break;
        case material_mix:
            type("diffuse_specular");
            base("reflectance");
            color("specular", m_.specular);
            number("alpha", m_.alpha);
            if (m_.texture_tints_specular) flag("texture_tints_specular", true);
            break;
        case material_unlit:
            type("unlit");
            base("color");
            break;
        case material_principled:
            type("principled");
            principled();
            break;
        default:
            fail_check(__FILE__, __LINE__, fmt::format("no word for materials of kind {}", m_.kind));
        }
    }

    void principled()
    {
        const PrincipledDesc& p = m_.principled;
        const PrincipledDesc usual;
        color_slot("base_color", m_.base_color, vec3(1.0f), m_.base_texture);
        number("ior", m_.ior);
        if (m_.absorption != vec3(0.0f)) color("absorption", m_.absorption);
        for (const NumberSlot& slot : number_slots)
            number_slot(slot.name, p.*slot.number, usual.*slot.number,
                        slot.texture != nullptr ? &(p.*slot.texture) : nullptr);
        for (const ColorSlot& slot : color_slots)
            color_slot(slot.name, p.*slot.color, usual.*slot.color, p.*slot.texture);
        for (const MapSlot& slot : map_slots)
            if ((p.*slot.texture).valid()) texture(slot.name, write_texture(w_, p.*slot.texture, true));
        if (!p.thin_walled) flag("thin_walled", false);
    }

    void common(bool is_lamp)
    {
        if (!is_lamp) {
            color_slot("emission", m_.emission, vec3(0.0f), m_.emission_texture);
            if (m_.two_sided_emission) flag("two_sided_emission", true);
        }
        if (m_.single_sided) flag("single_sided", true);
        normal_map();
        const MaterialDesc usual;
        const bool has_opacity = m_.coverage != usual.coverage || m_.opacity != usual.opacity ||
                                 m_.cutoff != usual.cutoff || m_.opacity_texture.valid();
        if (!has_opacity) return;
        static constexpr const char* names[] = {"opaque", "mask", "blend"};
        static_assert(coverage_opaque == 0 && coverage_mask == 1 && coverage_blend == 2);
        text_ += fmt::format(" \"string coverage\" \"{}\"", names[m_.coverage]);
        number_slot("opacity", m_.opacity, 1.0f, &m_.opacity_texture);
        if (m_.cutoff != usual.cutoff) number("cutoff", m_.cutoff);
    }

    void normal_map()
    {
        const TextureRef& ref = m_.normal_texture;
        if (m_.normal_scale != 1.0f) number("normal_scale", m_.normal_scale);
        if (!ref.valid()) return;
        TextureRef plain;
        plain.image = ref.image;
        const bool is_plain = ref == plain && w_.scene.images[ref.image.value].format != texels_rgba8_srgb;
        if (is_plain && m_.kind != material_principled) // pbrt's own way; it has no room for the picture's name
            text_ += fmt::format(" \"string normalmap\" {}", in_quotes(write_picture_file(w_, ref.image, false)));
        else
            texture("normal", write_texture(w_, ref, true));
    }

    Writer& w_;
    const MaterialDesc& m_;
    std::string text_;
};

} // namespace

void write_materials(Writer& w)
{
    for (std::size_t i = 0; i < w.scene.materials.size(); ++i) {
        if (!w.plan.is_used[i]) continue;
        const MaterialDesc& desc = w.scene.materials[i];
        const std::string& name = w.plan.material[i];
        const std::string text = MaterialText(w, desc).write(w.plan.is_lamp[i]);
        const bool is_renamed = name != desc.name;
        if (is_renamed) w.line("AttributeBegin\n  Attribute \"material\" \"string name\" {}", in_quotes(desc.name));
        w.line("{}MakeNamedMaterial {} {}", is_renamed ? "  " : "", in_quotes(name), text);
        if (is_renamed) w.line("AttributeEnd");
    }
}

} // namespace snell::pbrt
