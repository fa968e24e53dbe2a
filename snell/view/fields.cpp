#include "snell/view/fields.h"

#include "snell/view/widgets.h"

#include <imgui.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>

namespace snell::view {

void Fields::touch(const char* label)
{
    changed_ = true;
    control_ = ImGui::GetID(label);
}

void Fields::part(const char* label, float& value, const char* help)
{
    slide(label, value, 0.0f, 1.0f, help);
}

void Fields::slide(const char* label, float& value, float least, float most, const char* help)
{
    if (slider(label, value, least, most, help, "%.3f")) touch(label);
}

void Fields::drag(const char* label, float& value, float step, float least, float most, const char* help)
{
    if (number(label, value, step, least, most, help, "%.4g")) touch(label);
}

void Fields::vector(const char* label, vec3& value, float step, const char* help)
{
    if (view::vector(label, value, step, help)) touch(label);
}

void Fields::color(const char* label, vec3& value, const char* help)
{
    if (view::color(label, value, help)) touch(label);
}

void Fields::light(const char* label, vec3& value, const char* help)
{
    float strength = max3(value);
    vec3 hue = strength > 0.0f ? value / strength : vec3(1.0f);
    const std::string strength_label = fmt::format("{}, strength", label);
    if (view::color(label, hue, help)) {
        if (!(strength > 0.0f)) strength = 1.0f; // a colour was chosen for what is dark
        // The colour alone: how bright it is in the picker would else darken it with each frame of a drag.
        value = max3(hue) > 0.0f ? hue * (strength / max3(hue)) : vec3(0.0f);
        touch(label);
    }
    const std::string strength_help = fmt::format("{} The largest of the three numbers.", help);
    if (number(strength_label.c_str(), strength, 0.01f * std::max(strength, 0.1f), 0.0f, 1e6f, strength_help.c_str(),
               "%.4g")) {
        value = hue * strength;
        touch(strength_label.c_str());
    }
}

void Fields::flag(const char* label, bool& value, const char* help)
{
    if (checkbox(label, value, help)) touch(label);
}

void Fields::choice(const char* label, uint& value, std::span<const char* const> names, const char* help)
{
    if (choose(label, value, names, help)) touch(label);
}

std::string shown_name(const std::string& name, std::size_t number)
{
    return name.empty() ? fmt::format("({})", number) : name;
}

// One of a list.
template <class T>
static bool choose_one(const char* label, Index<T>& value, const std::vector<T>& all, bool may_be_none,
                       const char* help)
{
    std::vector<std::string> texts;
    if (may_be_none) texts.emplace_back("none");
    std::set<std::string> taken;
    for (std::size_t i = 0; i < all.size(); ++i) {
        std::string text = shown_name(all[i].name, i);
        if (!taken.insert(text).second) text += fmt::format(" ({})", i);
        texts.push_back(std::move(text));
    }
    std::vector<const char*> names;
    for (const std::string& text : texts) names.push_back(text.c_str());
    const uint first = may_be_none ? 1 : 0;
    uint chosen = value.valid() ? value.value + first : 0;
    if (!choose(label, chosen, names, help)) return false;
    value = chosen < first ? Index<T>{} : Index<T>{chosen - first};
    return true;
}

void Fields::material(const char* label, Index<MaterialDesc>& value, const Scene& scene, const char* help)
{
    if (choose_one(label, value, scene.materials, false, help)) touch(label);
}

void Fields::image(const char* label, Index<Image>& value, const Scene& scene, const char* help)
{
    if (choose_one(label, value, scene.images, true, help)) touch(label);
}

void Fields::texture(const char* label, TextureRef& ref, const Scene& scene, const char* help)
{
    static constexpr std::array wraps = {"repeat", "mirror", "clamp"};
    static constexpr std::array filters = {"bilinear", "nearest"};
    static constexpr std::array channels = {"red", "green", "blue", "alpha"};
    static constexpr std::array sets = {"first", "second"};
    if (scene.images.empty()) return;
    image(label, ref.image, scene, help);
    if (!ref.valid()) return;
    ImGui::PushID(label);
    if (ImGui::TreeNode("look-up")) {
        choice("U outside", ref.wrap_u, wraps, "What lies beyond the picture's sides: the wrap mode.");
        choice("V outside", ref.wrap_v, wraps, "What lies beyond the picture's top and bottom: the wrap mode.");
        choice("Filter", ref.filter, filters, "What lies between texels: the reconstruction filter.");
        choice("Channel", ref.channel, channels, "Which channel is read where one number is wanted.");
        choice("Coordinates", ref.uv_set, sets, "Which of the mesh's texture coordinates are used.");
        drag("U scale", ref.row_u.x, 0.01f, -1e3f, 1e3f, "How often it repeats: scale of the texture transform.");
        drag("V scale", ref.row_v.y, 0.01f, -1e3f, 1e3f, "How often it repeats: scale of the texture transform.");
        drag("U offset", ref.row_u.z, 0.005f, -1e3f, 1e3f, "Offset of the texture transform.");
        drag("V offset", ref.row_v.z, 0.005f, -1e3f, 1e3f, "Offset of the texture transform.");
        ImGui::TreePop();
    }
    ImGui::PopID();
}

} // namespace snell::view
