#include "snell/view/script_input.h"

#include "snell/core/error.h"
#include "snell/view/app.h"

#include <SDL.h>
#include <fmt/format.h>

#include <array>
#include <cmath>

namespace snell::view {

static bool push(SDL_Event event)
{
    if (SDL_PushEvent(&event) < 0) throw Error(fmt::format("input could not be made: {}", SDL_GetError()));
    return true;
}

static Uint32 window_id(App& app)
{
    return SDL_GetWindowID(app.window().handle());
}

bool push_move(App& app, float x, float y)
{
    SDL_Event event{};
    event.type = SDL_MOUSEMOTION;
    event.motion.windowID = window_id(app);
    event.motion.x = static_cast<int>(std::lround(x));
    event.motion.y = static_cast<int>(std::lround(y));
    return push(event);
}

static void hold(int modifier, bool is_down)
{
    const int mod = SDL_GetModState();
    SDL_SetModState(static_cast<SDL_Keymod>(is_down ? mod | modifier : mod & ~modifier));
}

static int modifiers(const KeyName& key)
{
    return (key.ctrl ? KMOD_LCTRL : 0) | (key.shift ? KMOD_LSHIFT : 0) | (key.alt ? KMOD_LALT : 0);
}

static bool push_one_key(App& app, int code, int mod, bool is_down)
{
    SDL_Event event{};
    event.type = is_down ? SDL_KEYDOWN : SDL_KEYUP;
    event.key.windowID = window_id(app);
    event.key.state = is_down ? SDL_PRESSED : SDL_RELEASED;
    event.key.keysym.sym = code;
    event.key.keysym.scancode = SDL_GetScancodeFromKey(code);
    event.key.keysym.mod = static_cast<Uint16>(mod);
    return push(event);
}

bool push_button(App& app, float x, float y, const std::string& how, bool is_down)
{
    SDL_Event event{};
    event.type = is_down ? SDL_MOUSEBUTTONDOWN : SDL_MOUSEBUTTONUP;
    event.button.windowID = window_id(app);
    event.button.state = is_down ? SDL_PRESSED : SDL_RELEASED;
    event.button.clicks = 1;
    event.button.x = static_cast<int>(std::lround(x));
    event.button.y = static_cast<int>(std::lround(y));
    if (how == "left" || how == "alt" || how == "ctrl")
        event.button.button = SDL_BUTTON_LEFT;
    else if (how == "right")
        event.button.button = SDL_BUTTON_RIGHT;
    else if (how == "middle")
        event.button.button = SDL_BUTTON_MIDDLE;
    else
        throw Error(fmt::format("there is no way to click '{}'", how), "there are: left, right, middle, alt, ctrl");
    if (how == "alt") hold(KMOD_LALT, is_down);
    if (how == "ctrl") { // ImGui hears of it by the key
        hold(KMOD_LCTRL, is_down);
        push_one_key(app, SDLK_LCTRL, SDL_GetModState(), is_down);
    }
    return push(event);
}

bool push_key(App& app, const KeyName& key, bool is_down)
{
    const int mod = is_down ? modifiers(key) : 0;
    SDL_SetModState(static_cast<SDL_Keymod>(mod)); // ImGui asks SDL
    if (key.ctrl) push_one_key(app, SDLK_LCTRL, mod, is_down);
    if (key.shift) push_one_key(app, SDLK_LSHIFT, mod, is_down);
    return push_one_key(app, key.code, mod, is_down);
}

bool push_text(App& app, const std::string& text)
{
    // SDL's events hold a few characters each.
    constexpr std::size_t room = SDL_TEXTINPUTEVENT_TEXT_SIZE - 4;
    for (std::size_t begin = 0; begin < text.size(); begin += room) {
        SDL_Event event{};
        event.type = SDL_TEXTINPUT;
        event.text.windowID = window_id(app);
        text.substr(begin, room).copy(event.text.text, room);
        push(event);
    }
    return true;
}

bool push_wheel(App& app, int notches)
{
    SDL_Event event{};
    event.type = SDL_MOUSEWHEEL;
    event.wheel.windowID = window_id(app);
    event.wheel.y = notches;
    event.wheel.preciseY = static_cast<float>(notches);
    return push(event);
}

bool push_drop(App& app, const std::string& file)
{
    SDL_Event event{};
    event.type = SDL_DROPFILE;
    event.drop.windowID = window_id(app);
    event.drop.file = SDL_strdup(file.c_str()); // who handles it frees it
    return push(event);
}

bool push_random(App& app, std::mt19937& random)
{
    const auto below = [&](uint n) { return static_cast<uint>(random() % n); };
    int width = 1, height = 1;
    SDL_GetWindowSize(app.window().handle(), &width, &height);
    const auto x = static_cast<float>(below(static_cast<uint>(width)));
    const auto y = static_cast<float>(below(static_cast<uint>(height)));
    static constexpr std::array buttons = {"left", "left", "left", "right", "middle", "alt"};
    // Not those that write files or close the window.
    static constexpr std::array names = {"w",  "a",    "s",    "d",     "q",      "e",      "f",      "g",
                                         "r",  "p",    "[",    "]",     "1",      "2",      "3",      "F1",
                                         "F2", "F5",   "Tab",  "Space", "Ctrl+1", "Ctrl+2", "Ctrl+z", "Ctrl+y",
                                         "Up", "Down", "Left", "Right", "Return", "Escape", "Ctrl+o"};
    switch (below(8)) {
    case 0:
    case 1:
        return push_move(app, x, y);
    case 2:
        push_move(app, x, y);
        return push_button(app, x, y, buttons[below(buttons.size())], true);
    case 3:
    case 4: // whatever was down comes up somewhere
        push_move(app, x, y);
        for (const char* button : {"left", "right", "middle", "alt"}) push_button(app, x, y, button, false);
        return true;
    case 5:
        return push_key(app, *parse_key(names[below(names.size())]), below(2) == 0);
    case 6:
        return push_wheel(app, static_cast<int>(below(5)) - 2);
    default: {
        const KeyName key = *parse_key(names[below(names.size())]);
        push_key(app, key, true);
        return push_key(app, key, false);
    }
    }
}

bool release_all(App& app)
{
    for (const char* button : {"left", "right", "middle", "alt"}) push_button(app, 0, 0, button, false);
    for (const char* key : {"w", "a", "s", "d", "q", "e"}) push_key(app, *parse_key(key), false);
    return true;
}

} // namespace snell::view
