#include "snell/view/input.h"

#include <SDL.h>
#include <backends/imgui_impl_sdl.h>
#include <imgui.h>
#include <imgui_internal.h>

#include <cmath>

namespace snell::view {

static double seconds_of(const SDL_Event& event)
{
    return static_cast<double>(event.common.timestamp) * 1e-3;
}

bool Input::is_press(const SDL_Event& event)
{
    return event.type == SDL_MOUSEBUTTONDOWN || event.type == SDL_MOUSEWHEEL;
}

vec2 Input::press_position(const SDL_Event& event)
{
    if (event.type == SDL_MOUSEBUTTONDOWN)
        return {static_cast<float>(event.button.x), static_cast<float>(event.button.y)};
    const ImVec2 mouse = ImGui::GetIO().MousePos;
    return {mouse.x, mouse.y};
}

void Input::frame_drawn()
{
    for (bool& was_down : pointer_.was_down) was_down = false;
}

// Whether a key belongs to the controls: text is being typed, or they are being gone through by keyboard.
static bool controls_have_key(int code)
{
    const ImGuiIO& io = ImGui::GetIO();
    if (io.WantTextInput) return true;
    if (ImGui::IsPopupOpen(nullptr, ImGuiPopupFlags_AnyPopupId | ImGuiPopupFlags_AnyPopupLevel)) return true;
    const bool navigates = code == SDLK_SPACE || code == SDLK_TAB || code == SDLK_ESCAPE || code == SDLK_RETURN;
    return navigates && io.NavVisible;
}

void Input::handle_key(const SDL_Event& event, std::vector<InputEvent>& to)
{
    const int code = event.key.keysym.sym;
    const bool is_down = event.type == SDL_KEYDOWN;
    const auto mod = event.key.keysym.mod;
    if (code == SDLK_LSHIFT || code == SDLK_RSHIFT) shift_ = is_down;
    if (code == SDLK_LCTRL || code == SDLK_RCTRL) ctrl_ = is_down;
    if (!is_down) {
        held_.erase(code);
        return;
    }
    if (controls_have_key(code)) return;
    const bool with_ctrl = (mod & KMOD_CTRL) != 0;
    if (event.key.repeat == 0 && !(mod & KMOD_ALT)) {
        held_.insert(code);
        if (move() != vec3(0.0f)) held_since_ = seconds_of(event);
    }
    if (event.key.repeat != 0 && code != SDLK_LEFTBRACKET && code != SDLK_RIGHTBRACKET) return;
    if ((mod & KMOD_ALT) != 0 || (code == SDLK_TAB && with_ctrl)) return;
    InputEvent input;
    input.press = find_key(code, with_ctrl);
    input.when = seconds_of(event);
    if (input.press.action != Action::none) to.push_back(input);
}

void Input::handle_button(const SDL_Event& event, std::vector<InputEvent>& to)
{
    const SDL_MouseButtonEvent& button = event.button;
    const int index = button.button == SDL_BUTTON_LEFT     ? 0
                      : button.button == SDL_BUTTON_RIGHT  ? 1
                      : button.button == SDL_BUTTON_MIDDLE ? 2
                                                           : -1;
    if (index < 0) return;
    pointer_.x = static_cast<float>(button.x), pointer_.y = static_cast<float>(button.y);
    pointer_.is_inside = true;
    const bool is_down = event.type == SDL_MOUSEBUTTONDOWN;
    pointer_.is_down[index] = is_down;
    if (is_down) {
        pointer_.was_down[index] = true;
        if (drag_ != 0 || !picture_is_there_) return;
        drag_ = button.button;
        is_alt_drag_ = (SDL_GetModState() & KMOD_ALT) != 0;
        is_moved_ = false;
        press_x_ = pointer_.x, press_y_ = pointer_.y;
    } else if (button.button == drag_) {
        if (drag_ == SDL_BUTTON_LEFT && !is_moved_) {
            InputEvent input;
            input.kind = InputEvent::Kind::click;
            input.x = press_x_, input.y = press_y_;
            input.when = seconds_of(event);
            to.push_back(input);
        }
        drag_ = 0;
    }
}

void Input::handle_motion(const SDL_Event& event, std::vector<InputEvent>& to)
{
    const float x = static_cast<float>(event.motion.x), y = static_cast<float>(event.motion.y);
    const float dx = x - pointer_.x, dy = y - pointer_.y;
    pointer_.x = x, pointer_.y = y;
    pointer_.is_inside = true;
    if (drag_ == 0) return;
    constexpr float still = 3.0f; // a hand that clicks is not quite at rest
    if (!is_moved_ && std::abs(x - press_x_) + std::abs(y - press_y_) <= still) return;
    InputEvent input;
    input.kind = drag_ == SDL_BUTTON_MIDDLE  ? InputEvent::Kind::pan
                 : drag_ == SDL_BUTTON_RIGHT ? InputEvent::Kind::dolly
                 : is_alt_drag_              ? InputEvent::Kind::orbit
                                             : InputEvent::Kind::look;
    input.x = is_moved_ ? dx : x - press_x_;
    input.y = is_moved_ ? dy : y - press_y_;
    input.when = seconds_of(event);
    is_moved_ = true;
    to.push_back(input);
}

void Input::handle(const SDL_Event& event, std::vector<InputEvent>& to)
{
    ImGui_ImplSDL2_ProcessEvent(&event);
    InputEvent input;
    input.when = seconds_of(event);
    switch (event.type) {
    case SDL_KEYDOWN:
    case SDL_KEYUP:
        handle_key(event, to);
        break;
    case SDL_MOUSEBUTTONDOWN:
    case SDL_MOUSEBUTTONUP:
        handle_button(event, to);
        break;
    case SDL_MOUSEMOTION:
        handle_motion(event, to);
        break;
    case SDL_MOUSEWHEEL:
        if (!picture_is_there_) break;
        input.kind = InputEvent::Kind::wheel;
        input.y = static_cast<float>(event.wheel.y);
        to.push_back(input);
        break;
    case SDL_DROPFILE:
        input.kind = InputEvent::Kind::drop;
        input.text = event.drop.file;
        to.push_back(input);
        break;
    case SDL_QUIT:
        input.kind = InputEvent::Kind::quit;
        to.push_back(input);
        break;
    case SDL_WINDOWEVENT:
        if (event.window.event == SDL_WINDOWEVENT_LEAVE && drag_ == 0) pointer_.is_inside = false;
        if (event.window.event == SDL_WINDOWEVENT_FOCUS_LOST) {
            // Keys that come up elsewhere are never heard of.
            held_.clear();
            shift_ = ctrl_ = false;
        }
        input.kind = InputEvent::Kind::resized;
        to.push_back(input);
        break;
    default:
        break;
    }
}

vec3 Input::move() const
{
    const auto axis = [&](int less, int more) {
        return (held_.contains(more) ? 1.0f : 0.0f) - (held_.contains(less) ? 1.0f : 0.0f);
    };
    return {axis(SDLK_a, SDLK_d), axis(SDLK_q, SDLK_e), axis(SDLK_s, SDLK_w)};
}

float Input::move_factor() const
{
    return shift_ == ctrl_ ? 1.0f : shift_ ? 4.0f : 0.25f;
}

} // namespace snell::view
