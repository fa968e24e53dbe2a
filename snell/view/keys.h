// The viewer's keys: one table, for the one who handles them and for the one who lists them.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace snell::view {

enum class Action
{
    none,
    play,
    pause_rendering,
    copy_camera,
    frame_scene,
    toggle_orbit,
    hide_ui,
    help,
    panels,
    reload,
    screenshot,
    quit,
    open,
    exposure_down,
    exposure_up,
    restart,
    other_device,
    recall_view, // with the key's digit
    store_view,
    undo,
    redo
};

struct Key
{
    const char* name; // as scripts write it: "F12", "Ctrl+Z"; "1" stands for 1 to 9
    int code;         // SDL_Keycode
    bool is_with_ctrl;
    Action action;    // none: the key acts while it is held, or it is a movement of the mouse
    const char* help; // what it does
};

std::span<const Key> keys();

struct KeyPress
{
    Action action = Action::none;
    int digit = 0;
};
KeyPress find_key(int code, bool with_ctrl);

// "Ctrl+Shift+w": the key and its modifiers.
struct KeyName
{
    int code = 0; // SDL_Keycode
    bool ctrl = false, shift = false, alt = false;
};
std::optional<KeyName> parse_key(std::string_view name);

} // namespace snell::view
