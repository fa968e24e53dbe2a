#include "snell/view/script_values.h"

#include "snell/core/error.h"
#include "snell/view/app.h"
#include "snell/view/camera_text.h"
#include "snell/view/view_transforms.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include <unistd.h>

namespace snell::view {

uint find_view_transform(const std::string& name)
{
    std::string all;
    for (uint i = 0; i < tone_count; ++i) {
        if (name == view_transform_names()[i]) return i;
        all += (all.empty() ? "" : ", ") + std::string(view_transform_names()[i]);
    }
    throw Error(fmt::format("there is no view transform '{}'", name), "there are: " + all);
}

std::optional<double> read_value(const std::string& text)
{
    double value = 0;
    const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
    const auto [end, error] = std::from_chars(begin, text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
    return value;
}

std::size_t take_pane(const ViewState& state, std::string& value)
{
    std::size_t number = 0;
    const auto [end, code] = std::from_chars(value.data(), value.data() + value.size(), number);
    if (code != std::errc() || number < 1 || number > state.panes.size())
        throw Error(fmt::format("'{}' begins with no pane's number", value),
                    fmt::format("there are panes 1 to {}", state.panes.size()));
    std::size_t skip = static_cast<std::size_t>(end - value.data());
    if (skip < value.size() && value[skip] == ':') ++skip;
    value.erase(0, skip);
    return number - 1;
}

static float number(const std::string& name, const std::string& value, double least, double most)
{
    const auto read = read_value(value);
    if (!read || *read < least || *read > most)
        throw Error(fmt::format("{}: '{}' is not a number from {} to {}", name, value, least, most));
    return static_cast<float>(*read);
}

static bool on_or_off(const std::string& name, const std::string& value)
{
    if (value == "on") return true;
    if (value == "off") return false;
    throw Error(fmt::format("{}: '{}' is neither on nor off", name, value));
}

void set_value(App& app, const std::string& name, const std::string& value)
{
    ViewState& state = app.state();
    CameraDesc camera = state.camera;
    if (name == "exposure") {
        state.exposure_ev = number(name, value, -100, 100);
    } else if (name == "tone") {
        state.curve = find_view_transform(value);
    } else if (name == "fov") {
        camera.fov_degrees = number(name, value, 0.001, 360.0);
        state.look(camera);
    } else if (name == "eye" || name == "target" || name == "up") {
        state.look(parse_camera("--" + name + " " + value, camera));
    } else if (name == "camera") {
        state.look(parse_camera(value, camera));
    } else if (name == "speed") {
        state.speed = number(name, value, 1e-9, 1e9);
    } else if (name == "orbit") {
        state.is_orbiting = on_or_off(name, value);
    } else if (name == "light") {
        state.is_light = on_or_off(name, value);
    } else if (name == "smooth") {
        state.smooth = on_or_off(name, value);
    } else if (name == "hidden") {
        state.ui_hidden = on_or_off(name, value);
    } else if (name == "paused") {
        state.is_paused = on_or_off(name, value);
    } else if (name == "playing") {
        state.is_playing = on_or_off(name, value);
    } else {
        bool is_known = false;
        for (const auto& panel : app.panels()) is_known = is_known || panel->set(state, name, value);
        if (!is_known)
            throw Error(fmt::format("there is nothing named '{}' to set", name), "docs/viewer.md lists names");
    }
}

static std::string phase_name(SessionStatus::Phase phase)
{
    switch (phase) {
    case SessionStatus::Phase::empty:
        return "empty";
    case SessionStatus::Phase::loading:
        return "loading";
    case SessionStatus::Phase::preparing:
        return "preparing";
    case SessionStatus::Phase::rendering:
        return "rendering";
    case SessionStatus::Phase::resting:
        return "resting";
    case SessionStatus::Phase::failed:
        return "failed";
    }
    return "";
}

// Memory that the process has now, in MiB.
static double resident_mib()
{
    long pages = 0;
    if (std::FILE* file = std::fopen("/proc/self/statm", "r")) {
        if (std::fscanf(file, "%*d %ld", &pages) != 1) pages = 0;
        std::fclose(file);
    }
    return static_cast<double>(pages) * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1024.0 * 1024.0);
}

std::string get_value(App& app, const std::string& name)
{
    ViewState& state = app.state();
    const auto on = [](bool is_on) { return std::string(is_on ? "on" : "off"); };
    const ShotPtr& shot = state.panes[0].shot;
    const auto vector = [](vec3 v) { return fmt::format("{},{},{}", v.x, v.y, v.z); };
    if (name == "phase") return phase_name(state.status.phase);
    if (name == "scene") return state.file;
    if (name == "opened") return std::to_string(state.opened);
    if (name == "error") return state.status.phase == SessionStatus::Phase::failed ? state.status.what : "";
    if (name == "spp") return std::to_string(shot != nullptr ? shot->spp : 0u);
    if (name == "generation") return std::to_string(shot != nullptr ? shot->generation : 0u);
    if (name == "exposure") return fmt::format("{}", state.exposure_ev);
    if (name == "tone") return view_transform_names()[state.curve];
    if (name == "fov") return fmt::format("{}", state.camera.fov_degrees);
    if (name == "eye") return vector(state.camera.eye);
    if (name == "eye.x") return fmt::format("{}", state.camera.eye.x);
    if (name == "eye.y") return fmt::format("{}", state.camera.eye.y);
    if (name == "eye.z") return fmt::format("{}", state.camera.eye.z);
    if (name == "target") return vector(state.camera.target);
    if (name == "speed") return fmt::format("{}", state.speed);
    if (name == "orbit") return on(state.is_orbiting);
    if (name == "light") return on(state.is_light);
    if (name == "hidden") return on(state.ui_hidden);
    if (name == "paused") return on(state.is_paused);
    if (name == "playing") return on(state.is_playing);
    if (name == "picked") return on(state.picked_point.has_value());
    if (name == "panes") return std::to_string(state.panes.size());
    if (name == "width") return std::to_string(state.panes[0].request.settings.width);
    if (name == "height") return std::to_string(state.panes[0].request.settings.height);
    if (name == "frames") return std::to_string(app.frames());
    if (name == "notes") return std::to_string(state.notes.size());
    if (name == "latency") return fmt::format("{}", state.timings.input_to_picture.percentile(0.5));
    if (name == "latency.count") return std::to_string(state.timings.input_to_picture.count());
    if (name == "frame_ms") return fmt::format("{}", state.timings.frame.percentile(0.5));
    if (name == "ui_ms") return fmt::format("{}", state.timings.ui.percentile(0.5));
    if (name == "convert_ms") return fmt::format("{}", state.timings.convert.percentile(0.5));
    if (name == "memory") return fmt::format("{:.1f}", resident_mib());
    for (const auto& panel : app.panels())
        if (const auto value = panel->get(state, name)) return *value;
    throw Error(fmt::format("there is nothing named '{}' to ask for", name), "docs/viewer.md lists names");
}

} // namespace snell::view
