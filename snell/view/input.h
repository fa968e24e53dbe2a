// From SDL's events to what the viewer does about them. Real events and a script's go the same way.
#pragma once

#include "snell/core/vec.h"
#include "snell/view/keys.h"
#include "snell/view/window.h"

#include <set>
#include <string>
#include <vector>

union SDL_Event;

namespace snell::view {

struct InputEvent
{
    enum class Kind
    {
        key,  // press
        look, // by x, y pixels to the right and down, all of these
        orbit,
        pan,
        dolly,
        click, // at x, y in ImGui's units
        wheel, // y notches
        drop,  // text: a file
        resized,
        quit
    };
    Kind kind = Kind::key;
    KeyPress press;
    float x = 0, y = 0;
    std::string text;
    double when = 0; // seconds, as SDL_GetTicks() counts
};

class Input
{
  public:
    // Hands the event to ImGui, and adds to `to` what is not ImGui's. picture_at(x, y): whether there is a picture
    // there and no control over it.
    template <class PictureAt>
    void handle(const SDL_Event& event, PictureAt&& picture_at, std::vector<InputEvent>& to)
    {
        picture_is_there_ = is_press(event) && picture_at(press_position(event).x, press_position(event).y);
        handle(event, to);
    }

    const Pointer& pointer() const { return pointer_; }
    void frame_drawn(); // ImGui has seen presses
    // Keys that are held: -1, 0 or 1 to the right, up and forward; zero while controls have the keyboard.
    vec3 move() const;
    float move_factor() const; // by Shift and Ctrl
    bool is_dragging() const { return drag_ != 0; }
    double held_since() const { return held_since_; } // when the latest key of move() was pressed

  private:
    static bool is_press(const SDL_Event& event);
    static vec2 press_position(const SDL_Event& event);
    void handle(const SDL_Event& event, std::vector<InputEvent>& to);
    void handle_key(const SDL_Event& event, std::vector<InputEvent>& to);
    void handle_button(const SDL_Event& event, std::vector<InputEvent>& to);
    void handle_motion(const SDL_Event& event, std::vector<InputEvent>& to);

    Pointer pointer_;
    std::set<int> held_; // keycodes
    bool shift_ = false, ctrl_ = false;
    double held_since_ = 0;
    int drag_ = 0; // SDL's number of the button; 0: none
    bool is_alt_drag_ = false, is_moved_ = false, picture_is_there_ = false;
    float press_x_ = 0, press_y_ = 0;
};

} // namespace snell::view
