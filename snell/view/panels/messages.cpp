// What loading and repairing the scene had to say.
#include "snell/view/panel.h"
#include "snell/view/widgets.h"

#include <fmt/format.h>
#include <imgui.h>

namespace snell::view {

namespace {
class Messages : public Panel
{
  public:
    const char* name() const override { return "Messages"; }
    const char* help() const override { return "What loading, repairing and completing the scene had to say."; }

    void draw(ViewState& state) override
    {
        if (state.notes.empty()) return paragraph("Nothing was wrong with the scene.");
        ImGui::BeginChild("notes", ImVec2(0, std::min(300.0f, 60.0f + 20.0f * static_cast<float>(state.notes.size())) *
                                                 state.ui_scale));
        constexpr std::size_t most = 500;
        for (std::size_t i = 0; i < std::min(state.notes.size(), most); ++i) {
            if (state.notes[i].kind == Note::Kind::warning)
                warning(state.notes[i].text);
            else
                paragraph(state.notes[i].text);
        }
        if (state.notes.size() > most) fact("and", fmt::format("{} more", state.notes.size() - most));
        ImGui::EndChild();
    }
};
} // namespace

std::unique_ptr<Panel> make_messages_panel()
{
    return std::make_unique<Messages>();
}

} // namespace snell::view
