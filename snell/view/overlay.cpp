#include "snell/view/overlay.h"

#include "snell/kernel/views.h"

#include <fmt/format.h>

namespace snell::view {

void draw_legend(const Pane& pane, ImDrawList& list, std::string_view title, double most, std::string_view unit,
                 float ui_scale)
{
    const float width = std::min(260.0f * ui_scale, 0.6f * pane.w), height = 14.0f * ui_scale,
                margin = 12.0f * ui_scale;
    const float line = ImGui::GetTextLineHeight();
    const ImVec2 low(pane.x + margin, pane.y + pane.h - margin - height - line);
    list.AddRectFilled(ImVec2(low.x - 6.0f * ui_scale, low.y - line - 6.0f * ui_scale),
                       ImVec2(low.x + width + 6.0f * ui_scale, low.y + height + line + 6.0f * ui_scale),
                       IM_COL32(0, 0, 0, 170), 4.0f);
    const std::string head = unit.empty() ? std::string(title) : fmt::format("{} [{}]", title, unit);
    list.AddText(ImVec2(low.x, low.y - line - 2.0f), IM_COL32(255, 255, 255, 255), head.c_str());
    constexpr int steps = 64;
    for (int i = 0; i < steps; ++i) {
        const float a = static_cast<float>(i) / steps, b = static_cast<float>(i + 1) / steps;
        list.AddRectFilled(ImVec2(low.x + a * width, low.y), ImVec2(low.x + b * width, low.y + height),
                           overlay_color(heat_color(0.5f * (a + b))));
    }
    for (int i = 0; i <= 4; ++i) {
        const std::string number = fmt::format("{:.3g}", most * i / 4);
        const float x = low.x + width * static_cast<float>(i) / 4.0f;
        const float wide = ImGui::CalcTextSize(number.c_str()).x;
        const float shift = i == 0 ? 0.0f : i == 4 ? wide : 0.5f * wide;
        list.AddText(ImVec2(x - shift, low.y + height), IM_COL32(255, 255, 255, 255), number.c_str());
    }
}

} // namespace snell::view
