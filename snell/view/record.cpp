#include "snell/view/record.h"

#include "snell/core/error.h"
#include "snell/io/image/write.h"
#include "snell/view/app.h"
#include "snell/view/navigation.h"

#include <algorithm>

namespace snell::view {

std::filesystem::path numbered_file(const std::string& pattern, uint number)
{
    const std::string remedy = "write it as in walk.%04d.png";
    const std::size_t percent = pattern.find('%');
    if (percent == std::string::npos || pattern.find('%', percent + 1) != std::string::npos)
        throw Error(fmt::format("'{}' has no place for a number, or several", pattern), remedy);
    std::size_t end = percent + 1;
    while (end < pattern.size() && pattern[end] >= '0' && pattern[end] <= '9') ++end;
    if (end >= pattern.size() || pattern[end] != 'd' || end - percent > 3)
        throw Error(fmt::format("'{}': behind the % there is no d", pattern), remedy);
    const std::string digits = pattern.substr(percent + 1, end - percent - 1);
    const int width = digits.empty() ? 0 : std::stoi(digits);
    std::string text = std::to_string(number);
    if (static_cast<int>(text.size()) < width) text.insert(0, static_cast<std::size_t>(width) - text.size(), '0');
    return pattern.substr(0, percent) + text + pattern.substr(end + 1);
}

Recorder::Recorder(std::string pattern, std::vector<CameraDesc> views, uint frames)
    : pattern_(std::move(pattern)), views_(std::move(views)), frames_(std::max(frames, 1u))
{
    if (views_.empty())
        throw Error("there is no view to record", "store some with Ctrl+1 to Ctrl+9, or give a file of them");
    check_writable(numbered_file(pattern_, 0));
}

void Recorder::move(App& app) const
{
    const float t = frames_ > 1 ? static_cast<float>(next_) / static_cast<float>(frames_ - 1) : 0.0f;
    app.state().look(along(views_, t));
}

bool Recorder::step(App& app)
{
    ViewState& state = app.state();
    if (state.opened == 0 || app.is_opening()) return false;
    if (!is_on_its_way_) {
        move(app);
        is_on_its_way_ = true;
        return false;
    }
    const ShotPtr& shot = state.panes[0].shot;
    if (!app.is_settled() || shot == nullptr || shot->is_preview || !shot->finished) return false;
    app.save_screenshot(numbered_file(pattern_, next_));
    if (++next_ == frames_) return true;
    move(app);
    return false;
}

} // namespace snell::view
