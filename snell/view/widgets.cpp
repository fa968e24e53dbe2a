#include "snell/view/widgets.h"

#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace snell::view {

// ---- names ----

static std::map<std::string, vec2, std::less<>>& items(bool last)
{
    static std::map<std::string, vec2, std::less<>> now, before;
    return last ? before : now;
}

void begin_items()
{
    std::swap(items(true), items(false));
    items(false).clear();
}

static std::string& sought_item()
{
    static std::string label;
    return label;
}

void seek_item(std::string_view label)
{
    sought_item() = label;
}

std::optional<vec2> find_item(std::string_view label)
{
    const auto& all = items(true);
    const auto found = all.find(label);
    if (found == all.end()) return std::nullopt;
    return found->second;
}

void name_item(std::string_view name)
{
    if (!ImGui::IsItemVisible()) {
        // "Reflectance.x" is in the item "Reflectance".
        const std::string& sought = sought_item();
        const std::string_view label = name.substr(0, name.find("##"));
        if (!sought.empty() && (sought == label || sought.substr(0, sought.rfind('.')) == label))
            ImGui::SetScrollHereY(0.5f);
        return;
    }
    const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
    items(false)[std::string(name.substr(0, name.find("##")))] = vec2(0.5f * (low.x + high.x), 0.5f * (low.y + high.y));
}

// The three fields of a vector's or colour's control; `aside` of its width is something else.
static void name_fields(std::string_view label, float aside)
{
    if (!ImGui::IsItemVisible()) return;
    const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
    const std::string name(label.substr(0, label.find("##")));
    for (int i = 0; i < 3; ++i)
        items(false)[name + "." + "xyz"[i]] =
            vec2(low.x + (high.x - low.x - aside) * (static_cast<float>(i) + 0.5f) / 3.0f, 0.5f * (low.y + high.y));
}

void tip(std::string_view text)
{
    if (text.empty() || !ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) return;
    // Not at once: who only passes over wants to see what is below.
    static double since = 0.0;
    static ImGuiID on = 0;
    const ImVec2 corner = ImGui::GetItemRectMin();
    const ImGuiID id = ImGui::GetID(&corner) ^ static_cast<ImGuiID>(corner.x * 7919.0f + corner.y * 104729.0f);
    if (id != on) on = id, since = ImGui::GetTime();
    if (ImGui::GetTime() - since < 0.35 || ImGui::IsMouseDown(0)) return;
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(ImGui::GetFontSize() * 24.0f);
    ImGui::TextUnformatted(text.data(), text.data() + text.size());
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
}

// ---- controls ----

// Puts the label on the left and makes the next control as wide as what is left. Returns the control's id.
static std::string begin_row(const char* label, const char* help)
{
    const std::string_view whole(label);
    const std::string_view shown = whole.substr(0, whole.find("##"));
    const float width = ImGui::GetContentRegionAvail().x;
    const float column = std::clamp(0.38f * width, 4.0f * ImGui::GetFontSize(), 10.0f * ImGui::GetFontSize());
    const float left = ImGui::GetCursorPosX();
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted(shown.data(), shown.data() + shown.size());
    tip(help);
    ImGui::SameLine();
    ImGui::SetCursorPosX(std::max(left + column, ImGui::GetCursorPosX()));
    ImGui::SetNextItemWidth(-1.0f);
    return "##" + std::string(whole);
}

static bool end_row(bool changed, const char* label, const char* help)
{
    name_item(label);
    tip(help);
    return changed;
}

bool slider(const char* label, float& value, float least, float most, const char* help, const char* format,
            bool is_logarithmic)
{
    const std::string id = begin_row(label, help);
    const ImGuiSliderFlags flags =
        ImGuiSliderFlags_AlwaysClamp | (is_logarithmic ? ImGuiSliderFlags_Logarithmic : ImGuiSliderFlags_None);
    return end_row(ImGui::SliderFloat(id.c_str(), &value, least, most, format, flags), label, help);
}

bool slider(const char* label, int& value, int least, int most, const char* help, const char* format,
            bool is_logarithmic)
{
    const std::string id = begin_row(label, help);
    const ImGuiSliderFlags flags =
        ImGuiSliderFlags_AlwaysClamp | (is_logarithmic ? ImGuiSliderFlags_Logarithmic : ImGuiSliderFlags_None);
    return end_row(ImGui::SliderInt(id.c_str(), &value, least, most, format, flags), label, help);
}

bool number(const char* label, float& value, float step, float least, float most, const char* help, const char* format)
{
    const std::string id = begin_row(label, help);
    return end_row(ImGui::DragFloat(id.c_str(), &value, step, least, most, format, ImGuiSliderFlags_AlwaysClamp), label,
                   help);
}

bool vector(const char* label, vec3& value, float step, const char* help)
{
    const std::string id = begin_row(label, help);
    const bool changed = ImGui::DragFloat3(id.c_str(), &value.x, step, -1e18f, 1e18f, "%.4g");
    name_fields(label, 0.0f);
    return end_row(changed, label, help);
}

bool color(const char* label, vec3& value, const char* help)
{
    const std::string id = begin_row(label, help);
    const bool changed = ImGui::ColorEdit3(id.c_str(), &value.x, ImGuiColorEditFlags_Float | ImGuiColorEditFlags_HDR);
    name_fields(label, ImGui::GetFrameHeight());
    return end_row(changed, label, help);
}

bool text(const char* label, std::string& value, const char* help, const char* hint)
{
    const std::string id = begin_row(label, help);
    return end_row(ImGui::InputTextWithHint(id.c_str(), hint, &value, ImGuiInputTextFlags_EnterReturnsTrue), label,
                   help);
}

bool checkbox(const char* label, bool& value, const char* help)
{
    const std::string id = begin_row(label, help);
    return end_row(ImGui::Checkbox(id.c_str(), &value), label, help);
}

bool button(const char* label, const char* help)
{
    return end_row(ImGui::Button(label), label, help);
}

bool choose(const char* label, std::string& value, std::span<const std::string> names, const char* help,
            std::span<const std::string> summaries)
{
    bool changed = false;
    const std::string id = begin_row(label, help);
    const bool is_open = ImGui::BeginCombo(id.c_str(), value.c_str(), ImGuiComboFlags_HeightLarge);
    end_row(false, label, is_open ? "" : help);
    if (!is_open) return false;
    for (std::size_t i = 0; i < names.size(); ++i) {
        const bool is_chosen = names[i] == value;
        if (ImGui::Selectable(names[i].c_str(), is_chosen) && !is_chosen) value = names[i], changed = true;
        name_item(names[i]);
        if (is_chosen) ImGui::SetItemDefaultFocus();
        if (i < summaries.size()) tip(summaries[i]);
    }
    ImGui::EndCombo();
    return changed;
}

bool choose(const char* label, uint& value, std::span<const char* const> names, const char* help)
{
    bool changed = false;
    const std::string id = begin_row(label, help);
    const bool is_open = ImGui::BeginCombo(id.c_str(), value < names.size() ? names[value] : "?");
    end_row(false, label, is_open ? "" : help);
    if (!is_open) return false;
    for (uint i = 0; i < names.size(); ++i) {
        if (ImGui::Selectable(names[i], i == value) && i != value) value = i, changed = true;
        name_item(names[i]);
        if (i == value) ImGui::SetItemDefaultFocus();
    }
    ImGui::EndCombo();
    return changed;
}

// ---- text ----

void fact(const char* label, std::string_view value, const char* help)
{
    const float width = ImGui::GetContentRegionAvail().x;
    const float column = std::clamp(0.38f * width, 4.0f * ImGui::GetFontSize(), 10.0f * ImGui::GetFontSize());
    const float left = ImGui::GetCursorPosX();
    ImGui::TextDisabled("%s", label);
    if (help != nullptr) tip(help);
    ImGui::SameLine();
    ImGui::SetCursorPosX(std::max(left + column, ImGui::GetCursorPosX()));
    ImGui::TextUnformatted(value.data(), value.data() + value.size());
    if (help != nullptr) tip(help);
}

void paragraph(std::string_view words)
{
    ImGui::PushTextWrapPos(0.0f);
    ImGui::TextUnformatted(words.data(), words.data() + words.size());
    ImGui::PopTextWrapPos();
}

void warning(std::string_view words)
{
    const bool is_light = ImGui::GetStyle().Colors[ImGuiCol_WindowBg].x > 0.5f;
    ImGui::PushStyleColor(ImGuiCol_Text, is_light ? ImVec4(0.70f, 0.15f, 0.05f, 1) : ImVec4(1.0f, 0.62f, 0.35f, 1));
    paragraph(words);
    ImGui::PopStyleColor();
}

} // namespace snell::view
