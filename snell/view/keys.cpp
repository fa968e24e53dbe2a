#include "snell/view/keys.h"

#include <SDL.h>

#include <array>

namespace snell::view {

static constexpr std::array table = {
    Key{"W A S D", 0, false, Action::none, "Move forward, left, back, right"},
    Key{"Q E", 0, false, Action::none, "Move down, up"},
    Key{"Shift", 0, false, Action::none, "Move faster"},
    Key{"Ctrl", 0, false, Action::none, "Move slower"},
    Key{"Wheel", 0, false, Action::none, "Change the speed of moving; when orbiting: come nearer"},
    Key{"Left drag", 0, false, Action::none, "Look around; when orbiting: go around the picked point"},
    Key{"Alt+left drag", 0, false, Action::none, "Go around the picked point (orbit)"},
    Key{"Middle drag", 0, false, Action::none, "Move in the picture's plane (pan)"},
    Key{"Right drag", 0, false, Action::none, "Come nearer to the picked point, or go away from it (dolly)"},
    Key{"Click", 0, false, Action::none, "Pick the point: orbit's centre, and what the panels inspect"},
    Key{"Tab", SDLK_TAB, false, Action::toggle_orbit, "Left drag flies or orbits"},
    Key{"F", SDLK_f, false, Action::frame_scene, "Frame the scene: all of it is seen"},
    Key{"1", SDLK_1, false, Action::recall_view, "1 to 9: go to the stored view of that number"},
    Key{"Ctrl+1", SDLK_1, true, Action::store_view, "1 to 9: store the view under that number"},
    Key{"[", SDLK_LEFTBRACKET, false, Action::exposure_down, "Darker by half an EV"},
    Key{"]", SDLK_RIGHTBRACKET, false, Action::exposure_up, "Brighter by half an EV"},
    Key{"C", SDLK_c, false, Action::copy_camera, "Print and copy the camera: our options, and a pbrt LookAt"},
    Key{"Space", SDLK_SPACE, false, Action::play, "Play or pause the animation"},
    Key{"P", SDLK_p, false, Action::pause_rendering, "Pause rendering, or go on"},
    Key{"R", SDLK_r, false, Action::restart, "Render again from the first sample"},
    Key{"V", SDLK_v, false, Action::other_device, "Render on the GPU, or on the processor again"},
    Key{"Ctrl+Z", SDLK_z, true, Action::undo, "Undo the last edit"},
    Key{"Ctrl+Y", SDLK_y, true, Action::redo, "Redo it"},
    Key{"Ctrl+O", SDLK_o, true, Action::open, "Open a scene"},
    Key{"G", SDLK_g, false, Action::hide_ui, "Hide the controls, or show them"},
    Key{"F1", SDLK_F1, false, Action::help, "This list"},
    Key{"F2", SDLK_F2, false, Action::panels, "Hide the column of panels, or show it"},
    Key{"F5", SDLK_F5, false, Action::reload, "Read the scene's file again"},
    Key{"F12", SDLK_F12, false, Action::screenshot, "Screenshot: a PNG and an EXR, with the settings in them"},
    Key{"Ctrl+Tab", 0, false, Action::none, "Give the keyboard to the controls; Alt: to the menu; Esc: back"},
    Key{"Esc", SDLK_ESCAPE, false, Action::quit, "Quit, after a question"},
};

std::span<const Key> keys()
{
    return table;
}

KeyPress find_key(int code, bool with_ctrl)
{
    const bool is_digit = code >= SDLK_1 && code <= SDLK_9;
    const int sought = is_digit ? static_cast<int>(SDLK_1) : code;
    for (const Key& key : table)
        if (key.action != Action::none && key.code == sought && key.is_with_ctrl == with_ctrl)
            return {key.action, is_digit ? code - static_cast<int>(SDLK_0) : 0};
    return {};
}

std::optional<KeyName> parse_key(std::string_view name)
{
    KeyName key;
    for (std::size_t plus = 0; (plus = name.find('+')) != std::string_view::npos && plus > 0;
         name.remove_prefix(plus + 1)) {
        const std::string_view modifier = name.substr(0, plus);
        if (modifier == "Ctrl" || modifier == "ctrl")
            key.ctrl = true;
        else if (modifier == "Shift" || modifier == "shift")
            key.shift = true;
        else if (modifier == "Alt" || modifier == "alt")
            key.alt = true;
        else
            return std::nullopt;
    }
    const std::string text = name == "Esc" || name == "esc" ? "Escape" : std::string(name);
    key.code = SDL_GetKeyFromName(text.c_str());
    if (key.code == SDLK_UNKNOWN) return std::nullopt;
    return key;
}

} // namespace snell::view
