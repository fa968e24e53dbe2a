// F1: the keys, from the table that handles them.
#include "snell/view/keys.h"
#include "snell/view/panel.h"
#include "snell/view/widgets.h"

#include <imgui.h>

namespace snell::view {

namespace {
class Help : public Panel
{
  public:
    const char* name() const override { return "Help"; }
    const char* help() const override { return "Keys and mouse."; }
    bool floats_at_start() const override { return true; }

    void draw(ViewState&) override
    {
        if (!ImGui::BeginTable("keys", 2, ImGuiTableFlags_RowBg | ImGuiTableFlags_SizingFixedFit)) return;
        ImGui::TableSetupColumn("key", ImGuiTableColumnFlags_WidthFixed);
        ImGui::TableSetupColumn("what", ImGuiTableColumnFlags_WidthStretch);
        for (const Key& key : keys()) {
            ImGui::TableNextRow();
            ImGui::TableNextColumn();
            ImGui::TextUnformatted(key.name);
            ImGui::TableNextColumn();
            paragraph(key.help);
        }
        ImGui::EndTable();
        ImGui::Spacing();
        paragraph(
            "Sliders take typed values: Ctrl+click, or Enter while they have the keyboard. Every control says what "
            "it does when the mouse rests on it. A file that is dropped onto the window is opened: a scene, an "
            "environment (.hdr .exr), or a texture for the picked surface.");
    }
};
} // namespace

std::unique_ptr<Panel> make_help_panel()
{
    return std::make_unique<Help>();
}

} // namespace snell::view
