// The menu, and what the window says where there is no picture yet, or none can come.
#include "snell/view/app.h"

#include "snell/scene/builtin.h"
#include "snell/view/widgets.h"

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>

namespace snell::view {

using Phase = SessionStatus::Phase;

// ---- menu ----

void App::draw_menu()
{
    if (!ImGui::BeginMainMenuBar()) return;
    const auto item = [](const char* label, const char* key, bool is_on, const char* help) {
        const bool chosen = ImGui::MenuItem(label, key, is_on);
        name_item(label);
        tip(help);
        return chosen;
    };
    const auto menu = [](const char* label) {
        const bool is_open = ImGui::BeginMenu(label);
        if (!is_open) name_item(label);
        return is_open;
    };
    if (menu("File")) {
        if (item("Open...", "Ctrl+O", false, "Open a scene by its file's name")) opens_file_dialog_ = true;
        if (menu("Built-in scenes")) {
            for (const BuiltinScene& scene : builtin_scenes())
                if (item(std::string(scene.name).c_str(), nullptr, state_.file == scene.name,
                         std::string(scene.summary).c_str()))
                    open(std::string(scene.name));
            ImGui::EndMenu();
        }
        if (ImGui::BeginMenu("Recent", !state_.recent.empty())) {
            for (const std::string& name : state_.recent)
                if (item(name.c_str(), nullptr, state_.file == name, "Open it again")) {
                    open(name);
                    break; // the list has changed
                }
            ImGui::EndMenu();
        }
        if (item("Read again", "F5", false, "Load the scene's file anew; the camera stays")) state_.press("F5");
        ImGui::Separator();
        if (item("Screenshot", "F12", false, "Write the picture as PNG and EXR")) state_.press("F12");
        if (item("Copy camera", "C", false, "As our options and as a pbrt LookAt")) state_.press("C");
        ImGui::Separator();
        if (item("Quit", "Esc", false, "Close the window")) quit(0);
        ImGui::EndMenu();
    }
    if (menu("View")) {
        if (item("Frame the scene", "F", false, "Move the camera back until all is seen")) state_.press("F");
        if (item("Orbit", "Tab", state_.is_orbiting, "Left drag goes around the picked point")) state_.press("Tab");
        if (ImGui::BeginMenu("Cameras", !state_.outline.cameras.empty() && state_.opened != 0)) {
            for (std::size_t i = 0; i < state_.outline.cameras.size(); ++i) {
                const CameraDesc& camera = state_.outline.cameras[i];
                const std::string label =
                    camera.name.empty() ? fmt::format("camera {}", i) : fmt::format("{}##{}", camera.name, i);
                if (item(label.c_str(), nullptr, false, "Look through this camera of the scene")) state_.look(camera);
            }
            ImGui::EndMenu();
        }
        ImGui::Separator();
        if (item("Light style", nullptr, state_.is_light, "Light controls, or dark ones"))
            state_.is_light = !state_.is_light;
        if (item("Smooth enlarging", nullptr, state_.smooth,
                 "Pictures that are smaller than their pane are enlarged bilinearly; else pixels stay squares"))
            state_.smooth = !state_.smooth;
        if (item("Hide controls", "G", false, "Only the picture")) state_.press("G");
        ImGui::EndMenu();
    }
    if (menu("Panels")) {
        if (item("Column of panels", "F2", shows_column_, "Show the column on the right")) state_.press("F2");
        ImGui::Separator();
        for (const auto& panel : panels_)
            if (item(panel->name(), nullptr, panel->is_open, panel->help())) {
                panel->is_open = !panel->is_open;
                if (panel->is_open && !panel->is_floating) shows_column_ = true;
            }
        ImGui::EndMenu();
    }
    if (menu("Help")) {
        if (item("Keys and mouse", "F1", false, "List them")) state_.press("F1");
        ImGui::EndMenu();
    }
    ImGui::EndMainMenuBar();
}

// ---- states ----

static bool begin_notice(const char* id, float x, float y, float w, float h, float width)
{
    ImGui::SetNextWindowPos(ImVec2(x + 0.5f * w, y + 0.5f * h), ImGuiCond_Always, ImVec2(0.5f, 0.5f));
    ImGui::SetNextWindowSizeConstraints(ImVec2(std::min(width, 0.95f * w), 0),
                                        ImVec2(std::min(width, 0.95f * w), 0.95f * h));
    return ImGui::Begin(id, nullptr,
                        ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_AlwaysAutoResize |
                            ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoBringToFrontOnFocus);
}

void App::draw_empty(float x, float y, float w, float h)
{
    begin_notice("##empty", x, y, w, h, 560.0f * state_.ui_scale);
    ImGui::TextUnformatted("No scene yet");
    ImGui::Separator();
    paragraph("Drop a file here (.gltf .glb .pbrt .obj .ply .stl), type its name, or click a built-in scene.");
    ImGui::SetNextItemWidth(-1.0f);
    if (ImGui::InputTextWithHint("##file", "name of a file or of a built-in scene, then Enter", &typed_file_,
                                 ImGuiInputTextFlags_EnterReturnsTrue) &&
        !typed_file_.empty())
        open(typed_file_);
    name_item("file");
    ImGui::Spacing();
    const float right = ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x;
    bool first = true;
    for (const BuiltinScene& scene : builtin_scenes()) {
        const std::string name(scene.name);
        const float width = ImGui::CalcTextSize(name.c_str()).x + 2.0f * ImGui::GetStyle().FramePadding.x;
        if (!first && ImGui::GetItemRectMax().x + ImGui::GetStyle().ItemSpacing.x + width < right) ImGui::SameLine();
        first = false;
        if (button(name.c_str(), std::string(scene.summary).c_str())) open(name);
    }
    if (!state_.recent.empty()) {
        ImGui::Spacing();
        ImGui::TextDisabled("Opened before");
        for (const std::string& name : state_.recent) {
            const bool chosen = ImGui::Selectable(name.c_str());
            tip("Open it again");
            if (chosen) {
                open(name);
                break; // the list has changed
            }
        }
    }
    ImGui::End();
}

void App::draw_loading(float x, float y, float w, float h)
{
    const SessionStatus& status = state_.status;
    begin_notice("##loading", x, y, w, h, 420.0f * state_.ui_scale);
    const bool is_building = status.phase == Phase::preparing;
    const std::string name = opening_.empty() ? status.name : opening_;
    ImGui::Text("%s %s", is_building ? "Preparing" : "Loading", name.c_str());
    ImGui::ProgressBar(static_cast<float>(std::clamp(status.fraction, 0.0, 1.0)), ImVec2(-1.0f, 0.0f));
    ImGui::TextDisabled("%s", status.what.empty() ? "building acceleration structures" : status.what.c_str());
    if (button("Cancel", "Stop opening this scene; what was shown before stays")) {
        session_->cancel_open();
        opening_.clear();
    }
    ImGui::End();
}

void App::draw_failure(float x, float y, float w, float h)
{
    begin_notice("##failure", x, y, w, h, 560.0f * state_.ui_scale);
    ImGui::Text("Cannot show %s", failed_.empty() ? "the scene" : failed_.c_str());
    ImGui::Separator();
    warning(state_.status.what);
    ImGui::Spacing();
    if (button("Try again", "Open the same scene once more")) open(failed_.empty() ? state_.file : failed_);
    ImGui::SameLine();
    if (button("Open another...", "Choose another file")) opens_file_dialog_ = true;
    ImGui::SameLine();
    if (button("Dismiss", "Hide this message")) dismissed_failure_ = state_.status.what;
    ImGui::End();
}

// The key that has opened a dialog is not meant for it.
static bool is_typed(ImGuiKey key)
{
    return !ImGui::IsWindowAppearing() && ImGui::IsKeyPressed(ImGui::GetKeyIndex(key), false);
}

void App::draw_dialogs()
{
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    const auto in_the_middle = [&] {
        ImGui::SetNextWindowPos(ImVec2(0.5f * size.x, 0.4f * size.y), ImGuiCond_Appearing, ImVec2(0.5f, 0.5f));
    };
    if (asks_to_quit_) ImGui::OpenPopup("Quit?");
    asks_to_quit_ = false;
    in_the_middle();
    if (ImGui::BeginPopupModal("Quit?", nullptr, ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoMove)) {
        ImGui::TextUnformatted("Close the viewer?");
        if (state_.document.is_dirty()) warning("The scene was changed since it was read or saved.");
        ImGui::Spacing();
        if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
        if (button("Quit", "Enter") || is_typed(ImGuiKey_Enter)) quit(0);
        ImGui::SameLine();
        if (button("Stay", "Esc") || is_typed(ImGuiKey_Escape)) ImGui::CloseCurrentPopup();
        ImGui::EndPopup();
    }

    if (opens_file_dialog_) {
        ImGui::OpenPopup("Open a scene");
        typed_file_ = state_.file;
    }
    opens_file_dialog_ = false;
    in_the_middle();
    ImGui::SetNextWindowSize(ImVec2(std::min(480.0f * state_.ui_scale, 0.95f * size.x), 0));
    if (ImGui::BeginPopupModal("Open a scene", nullptr, ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove)) {
        paragraph("The name of a file (.gltf .glb .pbrt .obj .ply .stl) or of a built-in scene:");
        ImGui::SetNextItemWidth(-1.0f);
        if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
        const bool entered = ImGui::InputText("##file", &typed_file_,
                                              ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_AutoSelectAll);
        name_item("file");
        if ((button("Open", "Open it") || entered) && !typed_file_.empty()) {
            open(typed_file_);
            ImGui::CloseCurrentPopup();
        }
        ImGui::SameLine();
        if (button("Cancel", "Esc") || is_typed(ImGuiKey_Escape)) ImGui::CloseCurrentPopup();
        ImGui::EndPopup();
    }
}

} // namespace snell::view
