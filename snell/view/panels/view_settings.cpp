// How the scene is looked at: camera, exposure, view transform, stored views.
#include "snell/scene/camera_models.h"
#include "snell/view/camera_text.h"
#include "snell/view/navigation.h"
#include "snell/view/panel.h"
#include "snell/view/view_transforms.h"
#include "snell/view/widgets.h"

#include <imgui.h>

#include <algorithm>

namespace snell::view {

namespace {
class ViewSettings : public Panel
{
  public:
    const char* name() const override { return "View"; }
    const char* help() const override { return "Camera, exposure and view transform; none of them changes the scene."; }
    bool opens_at_start() const override { return true; }

    void draw(ViewState& state) override
    {
        slider("Exposure", state.exposure_ev, -10.0f, 10.0f,
               "In EV: one more is twice as bright. Keys [ and ]. Views of data (normals, depth, ...) are not changed.",
               "%+.1f EV");
        if (choose("View transform", state.curve, view_transform_labels(),
                   "From scene-linear light to what a screen can show: the tone curve"))
            state.wake();
        ImGui::Separator();

        CameraDesc camera = state.camera;
        const uint kind = camera.model.kind;
        bool changed = false;
        if (kind != camera_lens && kind != camera_equirectangular) // which see what they see
            changed = slider("Field of view", camera.fov_degrees, 1.0f,
                             std::min(camera_models()[kind].largest_fov - 10.0f, 350.0f),
                             "Full angle of the picture's shorter side, in degrees", "%.1f deg");
        const float step = 0.002f * std::max(natural_speed(state.bounds), 1e-6f);
        changed |= vector("Eye", camera.eye, step, "Where the camera stands, in the scene's units");
        changed |= vector("Target", camera.target, step, "A point it looks at");
        if (changed && length(camera.target - camera.eye) > 0.0f) state.look(camera);
        const float natural = natural_speed(state.bounds);
        slider("Speed", state.speed, 1e-3f * natural, 1e2f * natural,
               "Of moving by keys, in the scene's units a second. The wheel changes it as well", "%.3g", true);
        checkbox("Orbit", state.is_orbiting, "Left drag goes around the picked point, instead of looking around. Tab");
        if (button("Frame the scene", "Move the camera so that all of it is seen. Key F")) state.press("F");
        ImGui::SameLine();
        if (button("Copy camera", "As our options and as a pbrt LookAt. Key C")) state.press("C");
        ImGui::Separator();

        ImGui::AlignTextToFramePadding();
        ImGui::TextUnformatted("Views");
        for (std::size_t i = 1; i < state.stored.size(); ++i) {
            ImGui::SameLine(0.0f, 3.0f * state.ui_scale);
            const std::string label = std::to_string(i);
            const bool is_stored = state.stored[i].has_value();
            if (is_stored) ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyle().Colors[ImGuiCol_ButtonActive]);
            const bool pressed = ImGui::SmallButton(label.c_str());
            if (is_stored) ImGui::PopStyleColor();
            tip(is_stored ? "Go to this view (its digit). Shift+click stores the present one in its place"
                          : "Click stores the present view here (Ctrl and the digit)");
            if (!pressed) continue;
            if (is_stored && !ImGui::GetIO().KeyShift)
                state.look(*state.stored[i]);
            else
                state.stored[i] = state.camera;
        }
    }
};
} // namespace

std::unique_ptr<Panel> make_view_settings_panel()
{
    return std::make_unique<ViewSettings>();
}

} // namespace snell::view
