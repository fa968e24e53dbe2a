// Animations: playing, and going to a moment.
#include "snell/view/fields.h"
#include "snell/view/panel.h"
#include "snell/view/widgets.h"

#include "snell/core/error.h"

#include <imgui.h>

#include <algorithm>
#include <charconv>

namespace snell::view {
namespace {

class TimelinePanel final : public Panel
{
  public:
    const char* name() const override { return "Timeline"; }
    const char* help() const override
    {
        return "Plays the scene's animations (key frames of nodes, skinning, morph targets), or holds one moment.";
    }
    void draw(ViewState& state) override;
    bool set(ViewState& state, const std::string& what, const std::string& value) override;
    std::optional<std::string> get(ViewState& state, const std::string& what) override;
};

void go_to(ViewState& state, float seconds)
{
    Playback& p = state.document.playback;
    p.seconds = seconds;
    state.document.pose(state, p.animation, seconds);
    if (p.camera < state.outline.cameras.size()) state.look(state.outline.cameras[p.camera]);
}

} // namespace

void TimelinePanel::draw(ViewState& state)
{
    Document& document = state.document;
    const Scene& scene = state.outline;
    if (!document.is_ready()) {
        paragraph("No scene is open yet.");
        return;
    }
    if (scene.animations.empty()) {
        paragraph("Nothing in this scene moves: it has no animation.");
        return;
    }
    Playback& p = document.playback;
    std::vector<std::string> names = {"at rest"};
    for (std::size_t i = 0; i < scene.animations.size(); ++i)
        names.push_back(fmt::format("{}: {}", i, shown_name(scene.animations[i].name, i)));
    std::string chosen = names[p.animation.valid() ? p.animation.value + 1 : 0];
    if (choose("Animation", chosen, names, "Which of the scene's animations moves it; at rest: as the file has it.")) {
        const auto found = static_cast<std::size_t>(std::find(names.begin(), names.end(), chosen) - names.begin());
        p.animation = found == 0 ? Index<Animation>{} : Index<Animation>{static_cast<uint>(found - 1)};
        go_to(state, 0.0f);
    }
    if (p.animation.valid()) {
        const float duration = scene.animations[p.animation.value].duration;
        if (button(state.is_playing ? "Pause" : "Play", "Plays the animation, or holds it (Space)."))
            state.is_playing = !state.is_playing;
        ImGui::SameLine();
        if (button("Rewind", "Goes to the first moment.")) go_to(state, 0.0f);
        float seconds = p.seconds;
        if (slider("Time", seconds, 0.0f, std::max(duration, 1e-3f),
                   "The moment that is shown, seconds: drag to scrub.", "%.3f s"))
            go_to(state, seconds);
        slider("Playback speed", p.speed, -4.0f, 4.0f, "Seconds of the animation a second; negative: backwards.");
        checkbox("Loop", p.loops, "Begins again at the end.");
    }
    std::vector<std::string> cameras = {"the view stays"};
    for (std::size_t i = 0; i < scene.cameras.size(); ++i)
        cameras.push_back(fmt::format("{}: {}", i, shown_name(scene.cameras[i].name, i)));
    std::string camera = cameras[p.camera < scene.cameras.size() ? p.camera + 1 : 0];
    if (choose("Look through", camera, cameras, "A camera that the view follows while time goes by.")) {
        const auto found =
            static_cast<std::size_t>(std::find(cameras.begin(), cameras.end(), camera) - cameras.begin());
        p.camera = found == 0 ? none : static_cast<uint>(found - 1);
        if (found > 0) state.look(scene.cameras[p.camera]);
    }
}

bool TimelinePanel::set(ViewState& state, const std::string& what, const std::string& value)
{
    if (what != "time") return false;
    const char* const end = value.data() + value.size();
    float seconds = 0.0f;
    const auto result = std::from_chars(value.data(), end, seconds);
    if (result.ec != std::errc() || result.ptr != end)
        throw Error(fmt::format("time '{}' is no number", value), "give seconds");
    go_to(state, seconds);
    return true;
}

std::optional<std::string> TimelinePanel::get(ViewState& state, const std::string& what)
{
    if (what == "time") return fmt::format("{:.3f}", state.document.playback.seconds);
    return std::nullopt;
}

std::unique_ptr<Panel> make_timeline_panel()
{
    return std::make_unique<TimelinePanel>();
}

} // namespace snell::view
