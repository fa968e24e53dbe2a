// What the window shows: menu, panes, column of panels, status line, and what is said where there is no picture.
#include "snell/view/app.h"

#include "snell/scene/builtin.h"
#include "snell/view/overlay.h"
#include "snell/view/script.h"
#include "snell/view/widgets.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

namespace snell::view {

using Phase = SessionStatus::Phase;

void App::draw_ui()
{
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    float top = 0, bottom = size.y, right = size.x;
    if (!state_.ui_hidden) {
        draw_menu();
        top = ImGui::GetFrameHeight();
        bottom -= ImGui::GetFrameHeight() + 2.0f * state_.ui_scale;
        const bool has_column = std::any_of(panels_.begin(), panels_.end(),
                                            [](const auto& panel) { return panel->is_open && !panel->is_floating; });
        if (shows_column_ && has_column) {
            const float most = std::max(0.6f * size.x, 1.0f); // of small windows less than what is comfortable
            column_width_ = std::clamp(column_width_, std::min(200.0f * state_.ui_scale, most), most);
            right -= column_width_;
        }
    }
    lay_out_panes(0, top, std::max(right, 1.0f), std::max(bottom - top, 1.0f));
    draw_panes();
    const float width = std::max(right, 1.0f), height = std::max(bottom - top, 1.0f);
    const Phase phase = state_.status.phase;
    if (phase == Phase::loading || phase == Phase::preparing) draw_loading(0, top, width, height);
    if (phase == Phase::failed && state_.status.what != dismissed_failure_) draw_failure(0, top, width, height);
    if (phase != Phase::failed) dismissed_failure_.clear();
    if (phase == Phase::empty && opening_.empty()) draw_empty(0, top, width, height);
    if (!state_.ui_hidden) {
        if (right < size.x) draw_column(top, bottom);
        draw_floating();
        draw_status();
    }
    draw_messages(bottom);
    draw_dialogs();
}

// ---- the panes ----

void App::lay_out_panes(float x, float y, float w, float h)
{
    std::vector<Pane>& panes = state_.panes;
    const std::size_t count = panes.size();
    const bool is_divided = state_.arrangement == Arrangement::divider && count == 2;
    const std::size_t columns = count == 1 || is_divided ? 1 : 2, rows = count <= 2 ? 1 : 2;
    const float gap = 2.0f * state_.ui_scale;
    const float pane_w =
        is_divided ? w : std::floor((w - gap * static_cast<float>(columns - 1)) / static_cast<float>(columns));
    const float pane_h =
        is_divided ? h : std::floor((h - gap * static_cast<float>(rows - 1)) / static_cast<float>(rows));
    for (std::size_t i = 0; i < count; ++i) {
        Pane& pane = panes[i];
        pane.w = std::max(pane_w, 1.0f), pane.h = std::max(pane_h, 1.0f);
        const std::size_t column = is_divided ? 0 : i % 2, row = is_divided ? 0 : i / 2;
        pane.x = x + static_cast<float>(column) * (pane_w + gap);
        pane.y = y + static_cast<float>(row) * (pane_h + gap);
        pane.clip_x0 = pane.x, pane.clip_x1 = pane.x + pane.w;
    }
    if (is_divided) {
        const float middle = std::round(x + std::clamp(state_.divider, 0.0f, 1.0f) * w);
        panes[0].clip_x1 = middle;
        panes[1].clip_x0 = middle;
    }

    // While the window or the column is being dragged, pictures are stretched; they are rendered anew when it rests.
    const float scale = window_.pixels_per_unit();
    const int pixels_w = std::max(1, static_cast<int>(std::lround(panes[0].w * scale)));
    const int pixels_h = std::max(1, static_cast<int>(std::lround(panes[0].h * scale)));
    if (pixels_w != sized_w_ || pixels_h != sized_h_) {
        const bool is_first = sized_w_ == 0;
        sized_w_ = pixels_w, sized_h_ = pixels_h;
        sized_at_ = is_first ? -1.0 : state_.time;
    }
    constexpr double rest = 0.15;
    if (state_.time - sized_at_ < rest) state_.wake();
    for (Pane& pane : panes) {
        RenderSettings& settings = pane.request.settings;
        if (state_.time - sized_at_ < rest && frames_ > 0) continue;
        settings.width = sized_w_, settings.height = sized_h_;
    }
}

static void draw_outlined(ImDrawList& list, ImVec2 at, const std::string& text)
{
    for (const ImVec2 by : {ImVec2(-1, 0), ImVec2(1, 0), ImVec2(0, -1), ImVec2(0, 1)})
        list.AddText(ImVec2(at.x + by.x, at.y + by.y), IM_COL32(0, 0, 0, 200), text.c_str());
    list.AddText(at, IM_COL32(255, 255, 255, 255), text.c_str());
}

void App::draw_panes()
{
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    while (textures_.size() < state_.panes.size()) textures_.push_back(std::make_unique<PaneTexture>());
    const DisplaySettings settings = {state_.exposure_ev, state_.curve};
    for (std::size_t i = 0; i < state_.panes.size(); ++i) {
        Pane& pane = state_.panes[i];
        PaneTexture& shown = *textures_[i];
        if (pane.shot != nullptr && pane.shot->film.width > 0 &&
            (shown.shot != pane.shot || !(shown.settings == settings))) {
            const auto begin = std::chrono::steady_clock::now();
            to_screen(*pane.shot, settings, screen_);
            state_.timings.convert.add(
                std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
            shown.texture.upload(screen_);
            shown.shot = pane.shot, shown.settings = settings;
        }
        shown.texture.set_smooth(state_.smooth);
        const ImVec2 low(pane.x, pane.y), high(pane.x + pane.w, pane.y + pane.h);
        list.PushClipRect(ImVec2(pane.clip_x0, pane.y), ImVec2(pane.clip_x1, high.y));
        list.AddRectFilled(low, high, IM_COL32(0, 0, 0, 255));
        if (pane.shot != nullptr && !shown.texture.empty()) list.AddImage(shown.texture.id(), low, high);
        for (const auto& panel : panels_) panel->draw_over(state_, pane, list);
        if (!pane.label.empty() && state_.panes.size() > 1)
            draw_outlined(list, ImVec2(pane.clip_x0 + 8.0f * state_.ui_scale, pane.y + 6.0f * state_.ui_scale),
                          pane.label);
        if (state_.panes.size() > 1 && i == state_.active_pane && !state_.ui_hidden)
            list.AddRect(ImVec2(pane.clip_x0, low.y), ImVec2(pane.clip_x1, high.y), IM_COL32(90, 150, 250, 200));
        list.PopClipRect();
    }
    draw_sketch();
    if (state_.arrangement == Arrangement::divider && state_.panes.size() == 2) draw_divider();
    if (state_.active_pane >= state_.panes.size()) state_.active_pane = 0;
}

void App::draw_divider()
{
    const Pane& left = state_.panes[0];
    const float x = left.clip_x1, reach = 5.0f * state_.ui_scale;
    ImGui::SetNextWindowPos(ImVec2(x - reach, left.y));
    ImGui::SetNextWindowSize(ImVec2(2 * reach, left.h));
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(0, 0));
    ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, ImVec2(1, 1));
    ImGui::Begin("##divider", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoBackground |
                     ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoBringToFrontOnFocus);
    ImGui::InvisibleButton("divider", ImVec2(2 * reach, left.h));
    name_item("divider");
    is_dragging_divider_ = ImGui::IsItemActive();
    if (ImGui::IsItemHovered() || is_dragging_divider_) ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
    if (is_dragging_divider_) state_.divider = std::clamp((ImGui::GetIO().MousePos.x - left.x) / left.w, 0.02f, 0.98f);
    tip("Drag to see more of one side");
    ImGui::End();
    ImGui::PopStyleVar(2);
    ImGui::GetBackgroundDrawList()->AddLine(ImVec2(x, left.y), ImVec2(x, left.y + left.h), IM_COL32(255, 255, 255, 220),
                                            state_.ui_scale);
}

// The boxes of a scene whose trees are being built, until there is a picture.
void App::draw_sketch()
{
    const auto& sketch = state_.status.sketch;
    if (sketch == nullptr) return;
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    for (const Pane& pane : state_.panes) {
        const Overlay overlay(sketch->camera, pane, std::max(1.0f, std::floor(pane.w)),
                              std::max(1.0f, std::floor(pane.h)), list);
        list.PushClipRect(ImVec2(pane.clip_x0, pane.y), ImVec2(pane.clip_x1, pane.y + pane.h));
        if (state_.opened != 0) // the old scene is still there: it steps back
            list.AddRectFilled(ImVec2(pane.x, pane.y), ImVec2(pane.x + pane.w, pane.y + pane.h),
                               IM_COL32(0, 0, 0, 160));
        const auto draw_box = [&](const Bounds& box, ImU32 color) {
            if (box.empty()) return;
            for (int edge = 0; edge < 12; ++edge) {
                const int axis = edge / 4, corner = edge % 4;
                vec3 a = box.lower, b;
                if ((corner & 1) != 0) a[(axis + 1) % 3] = box.upper[(axis + 1) % 3];
                if ((corner & 2) != 0) a[(axis + 2) % 3] = box.upper[(axis + 2) % 3];
                b = a;
                b[axis] = box.upper[axis];
                overlay.line(a, b, color);
            }
        };
        for (const Bounds& box : sketch->boxes) draw_box(box, IM_COL32(150, 170, 200, 90));
        draw_box(sketch->bounds, IM_COL32(230, 235, 245, 200));
        list.PopClipRect();
    }
}

// ---- the column of panels ----

void App::draw_panel_header(Panel& panel)
{
    bool stays = true;
    ImGui::SetNextItemOpen(true, ImGuiCond_Once);
    const bool is_unfolded = ImGui::CollapsingHeader(panel.name(), &stays);
    tip(std::string(panel.help()) + "\n\nRight click: a window of its own.");
    if (ImGui::BeginPopupContextItem()) {
        if (ImGui::MenuItem("A window of its own")) panel.is_floating = true;
        if (ImGui::MenuItem("Close")) stays = false;
        ImGui::EndPopup();
    }
    if (is_unfolded) {
        panel.draw(state_);
        ImGui::Dummy(ImVec2(0, 4.0f * state_.ui_scale));
    }
    if (!stays) panel.is_open = false;
}

void App::draw_column(float top, float bottom)
{
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    const float x = size.x - column_width_;
    ImGui::SetNextWindowPos(ImVec2(x, top));
    ImGui::SetNextWindowSize(ImVec2(column_width_, bottom - top));
    ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0.0f);
    ImGui::Begin("Panels##column", nullptr,
                 ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize |
                     ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoBringToFrontOnFocus);
    for (const auto& panel : panels_) {
        if (!panel->is_open || panel->is_floating) continue;
        ImGui::PushID(panel->name());
        draw_panel_header(*panel);
        ImGui::PopID();
    }
    ImGui::End();

    // Its left edge can be dragged.
    const float reach = 4.0f * state_.ui_scale;
    ImGui::SetNextWindowPos(ImVec2(x - reach, top));
    ImGui::SetNextWindowSize(ImVec2(2 * reach, bottom - top));
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(0, 0));
    ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, ImVec2(1, 1));
    ImGui::Begin("##edge", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoBackground |
                     ImGuiWindowFlags_NoNav);
    ImGui::InvisibleButton("edge", ImVec2(2 * reach, bottom - top));
    if (ImGui::IsItemHovered() || ImGui::IsItemActive()) ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
    if (ImGui::IsItemActive()) column_width_ = size.x - ImGui::GetIO().MousePos.x;
    ImGui::End();
    ImGui::PopStyleVar(3);
}

void App::draw_floating()
{
    int number = 0;
    for (const auto& panel : panels_) {
        if (!panel->is_open || !panel->is_floating) continue;
        const float scale = state_.ui_scale, step = 24.0f * static_cast<float>(number++ % 6);
        const ImVec2 size = ImGui::GetIO().DisplaySize;
        ImGui::SetNextWindowPos(ImVec2((40.0f + step) * scale, (50.0f + step) * scale), ImGuiCond_FirstUseEver);
        ImGui::SetNextWindowSize(ImVec2(std::min(520.0f * scale, size.x), std::min(480.0f * scale, 0.85f * size.y)),
                                 ImGuiCond_FirstUseEver);
        bool stays = true;
        if (ImGui::Begin(panel->name(), &stays)) {
            if (!panel->floats_at_start() && ImGui::SmallButton("Back into the column")) panel->is_floating = false;
            panel->draw(state_);
        }
        ImGui::End();
        if (!stays) panel->is_open = false;
    }
}

// ---- lines at the window's edges ----

static std::string describe(const Phase phase)
{
    switch (phase) {
    case Phase::empty:
        return "no scene";
    case Phase::loading:
        return "loading";
    case Phase::preparing:
        return "building trees";
    case Phase::rendering:
        return "rendering";
    case Phase::resting:
        return "done";
    case Phase::failed:
        return "failed";
    }
    return "";
}

void App::draw_status()
{
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    const float height = ImGui::GetFrameHeight() + 2.0f * state_.ui_scale;
    ImGui::SetNextWindowPos(ImVec2(0, size.y - height));
    ImGui::SetNextWindowSize(ImVec2(size.x, height));
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(8.0f * state_.ui_scale, 2.0f * state_.ui_scale));
    ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0.0f);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, ImVec2(1, 1));
    ImGui::Begin("##status", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoNav |
                     ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoBringToFrontOnFocus);
    ImGui::AlignTextToFramePadding();
    const SessionStatus& status = state_.status;
    auto part = [first = true](const std::string& text, const char* help) mutable {
        if (!first) {
            ImGui::SameLine();
            ImGui::TextDisabled("|");
            ImGui::SameLine();
        }
        first = false;
        ImGui::TextUnformatted(text.c_str());
        tip(help);
    };
    if (!state_.file.empty()) part(std::filesystem::path(state_.file).filename().string(), "The scene that is shown");
    std::string phase = state_.is_paused && status.phase == Phase::resting ? "paused" : describe(status.phase);
    part(phase, "What the renderer is doing. Done: every picture has the samples that were asked for");
    const Pane& pane = state_.panes[std::min(state_.active_pane, state_.panes.size() - 1)];
    if (pane.shot != nullptr) {
        part(fmt::format("{} / {} spp", pane.shot->spp, pane.request.settings.spp),
             "Samples a pixel that are in the picture, of those asked for");
        const GovernorState& governor = status.governor;
        if (status.is_moving) {
            std::string decision = governor.scale < 1.0f ? fmt::format("{:.0f}% of the width", 100.0f * governor.scale)
                                                         : std::string("full size");
            if (governor.max_depth > 0) decision += fmt::format(", {} bounces", governor.max_depth);
            part(decision, "What the frame governor leaves out while things move, to keep the frame time: resolution "
                           "first, then the depth of paths");
            part(fmt::format("{:.0f} ms", governor.measured_ms), "Time of the last picture while things move");
        } else {
            part(fmt::format("{:.2f} M rays/s",
                             pane.shot->seconds > 0
                                 ? 1e-6 * static_cast<double>(pane.shot->stats.rays()) / pane.shot->seconds
                                 : 0.0),
                 "Rays of all kinds for each second of rendering");
        }
    }
    if (!state_.timings.input_to_picture.empty())
        part(fmt::format("input to picture {:.0f} ms", state_.timings.input_to_picture.percentile(0.5)),
             "Latency: from an event to the picture that answers it; the median of the latest");
    const std::size_t warnings = static_cast<std::size_t>(std::count_if(
        state_.notes.begin(), state_.notes.end(), [](const Note& n) { return n.kind == Note::Kind::warning; }));
    if (!state_.notes.empty())
        part(warnings > 0 ? fmt::format("{} warnings", warnings) : fmt::format("{} notes", state_.notes.size()),
             "What loading the scene had to say: see the panel Messages");
    const char* hint = "F1 help";
    const float width = ImGui::CalcTextSize(hint).x + 10.0f * state_.ui_scale;
    ImGui::SameLine();
    if (size.x - width > ImGui::GetCursorPosX()) {
        ImGui::SetCursorPosX(size.x - width);
        ImGui::TextDisabled("%s", hint);
    }
    ImGui::End();
    ImGui::PopStyleVar(3);
}

void App::draw_messages(float bottom)
{
    while (!messages_.empty() && messages_.front().until < state_.time) messages_.pop_front();
    constexpr std::size_t most = 5;
    while (messages_.size() > most) messages_.pop_front();
    ImDrawList& list = *ImGui::GetForegroundDrawList();
    const Pane& pane = state_.panes[0];
    const float padding = 6.0f * state_.ui_scale, wrap = std::max(0.9f * pane.w, 100.0f);
    float y = bottom - padding;
    for (auto message = messages_.rbegin(); message != messages_.rend(); ++message) {
        const char* begin = message->text.c_str();
        const ImVec2 extent = ImGui::CalcTextSize(begin, nullptr, false, wrap);
        y -= extent.y + 2 * padding;
        const ImVec2 low(padding, y), high(padding + extent.x + 2 * padding, y + extent.y + 2 * padding);
        list.AddRectFilled(low, high, IM_COL32(20, 22, 26, 225), 4.0f * state_.ui_scale);
        list.AddText(ImGui::GetFont(), ImGui::GetFontSize(), ImVec2(low.x + padding, low.y + padding),
                     IM_COL32(255, 255, 255, 255), begin, nullptr, wrap);
        y -= padding;
    }
}

} // namespace snell::view
