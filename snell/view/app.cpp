// The main loop. The user interface's thread never waits for rendering: it asks the session for things, and looks
// whether a new picture is there.
#include "snell/view/app.h"

#include "snell/core/error.h"
#include "snell/kernel/camera.h"
#include "snell/render/params.h"
#include "snell/view/camera_text.h"
#include "snell/view/navigation.h"
#include "snell/view/record.h"
#include "snell/view/script.h"
#include "snell/view/widgets.h"

#include <SDL.h>
#include <imgui.h>
#include <imgui_internal.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <set>
#include <thread>

namespace snell::view {

static double seconds_now()
{
    return static_cast<double>(SDL_GetTicks64()) * 1e-3;
}

static WindowOptions window_options(const ViewOptions& options)
{
    return {"snell", options.width, options.height, options.ui_scale, options.is_light};
}

App::App(const ViewOptions& options)
    : options_(options), window_(window_options(options)), session_(std::make_unique<Session>()), state_(*session_)
{
    state_.exposure_ev = options.exposure_ev;
    state_.curve = options.curve;
    state_.is_light = options.is_light;
    state_.ui_scale = window_.ui_scale();
    state_.governor.target_ms = options.target_ms;
    state_.panes.resize(1);
    state_.panes[0].request.settings = options.settings;
    state_.look = [this](const CameraDesc& camera) { show_camera(camera, seconds_now()); };
    state_.say = [this](const std::string& text) {
        messages_.push_back({text, state_.time + 4.0 + 0.05 * static_cast<double>(text.size())});
    };
    state_.open = [this](std::string name) { open(name); };
    state_.press = [this](const std::string& name) {
        if (const auto key = parse_key(name)) act(find_key(key->code, key->ctrl));
    };
    state_.wake = [this] { frames_to_draw_ = std::max(frames_to_draw_, 2); };
    column_width_ = 340.0f * state_.ui_scale;
    panels_ = make_panels();
    for (const auto& panel : panels_) {
        panel->is_open = panel->opens_at_start();
        panel->is_floating = panel->floats_at_start();
    }
    if (options_.keeps_recent) load_recent();
    if (!options_.script.empty()) script_ = std::make_unique<Script>(options_.script);
    if (!options_.record.empty())
        recorder_ = std::make_unique<Recorder>(options_.record, read_views(options_.path), options_.record_frames);
    session_->set_governor(state_.governor);
    sent_governor_ = state_.governor;
    if (!options_.scene.empty()) open(options_.scene);
}

App::~App() = default;

Panel* App::find_panel(const std::string& name)
{
    for (const auto& panel : panels_)
        if (name == panel->name()) return panel.get();
    return nullptr;
}

void App::quit(int code)
{
    if (is_held_open_) return;
    is_done_ = true;
    code_ = code;
}

int App::run()
{
    double last = seconds_now();
    while (!is_done_) {
        wait_for_events();
        const double now = seconds_now();
        state_.time = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
        handle_events();
        state_.status = session_->status();
        if (script_ != nullptr) script_->step(*this);
        if (recorder_ != nullptr && recorder_->step(*this)) quit(0);
        move_by_keys(std::min(now - last, 0.1)); // after a long frame one does not want to be somewhere else
        last = now;
        follow_opening();
        watch_file();
        for (const auto& panel : panels_) panel->update(state_);
        send_requests();
        take_shots();
        if (has_to_draw()) draw_frame();
    }
    if (!options_.timings.empty()) write_timings();
    // The window goes at once. What renders, loads or builds is told to stop; should it not within half a second, there
    // is nothing left to save, and the program ends without it.
    window_.hide();
    const auto has_ended = std::make_shared<std::atomic<bool>>(false);
    std::thread([code = code_, has_ended] {
        std::this_thread::sleep_for(std::chrono::milliseconds(500));
        if (*has_ended) return;
        std::fflush(nullptr);
        std::_Exit(code);
    }).detach();
    session_.reset();
    *has_ended = true;
    return code_;
}

void App::wait_for_events()
{
    const bool is_moving = input_.is_dragging() || input_.move() != vec3(0.0f) || camera_to_send_ ||
                           !awaited_.empty() || frames_to_draw_ > 0;
    const auto phase = state_.status.phase;
    const bool is_busy = phase != SessionStatus::Phase::resting && phase != SessionStatus::Phase::empty &&
                         phase != SessionStatus::Phase::failed;
    int timeout = is_moving ? 4 : script_ != nullptr ? 10 : is_busy || state_.is_playing ? 25 : 200;
    if (state_.time - moved_at_ < 1.0) timeout = std::min(timeout, 30); // tooltips are to come
    SDL_WaitEventTimeout(nullptr, timeout);
}

// ---- input ----

bool App::is_picture_at(float x, float y) const
{
    if (!pixel_at(x, y) || is_dragging_divider_) return false;
    if (ImGui::IsPopupOpen(nullptr, ImGuiPopupFlags_AnyPopupId | ImGuiPopupFlags_AnyPopupLevel)) return false;
    for (const ImGuiWindow* window : ImGui::GetCurrentContext()->Windows)
        if (window->WasActive && !window->Hidden && (window->Flags & ImGuiWindowFlags_NoMouseInputs) == 0 &&
            window->OuterRectClipped.Contains(ImVec2(x, y)))
            return false;
    return true;
}

std::optional<PickedPixel> App::pixel_at(float x, float y) const
{
    for (std::size_t i = 0; i < state_.panes.size(); ++i) {
        const Pane& pane = state_.panes[i];
        if (x < pane.clip_x0 || x >= pane.clip_x1 || y < pane.y || y >= pane.y + pane.h) continue;
        const RenderSettings& settings = pane.request.settings;
        PickedPixel pixel;
        pixel.pane = i;
        pixel.x = std::clamp(static_cast<int>((x - pane.x) / pane.w * static_cast<float>(settings.width)), 0,
                             settings.width - 1);
        pixel.y = std::clamp(static_cast<int>((y - pane.y) / pane.h * static_cast<float>(settings.height)), 0,
                             settings.height - 1);
        return pixel;
    }
    return std::nullopt;
}

void App::handle_events()
{
    std::vector<InputEvent> inputs;
    std::set<int>
        pressed; // ImGui sees a key's state once a frame: one that was pressed may not come up before the next
    const auto take = [&](SDL_Event& event) {
        input_.handle(
            event, [this](float x, float y) { return is_picture_at(x, y); }, inputs);
        if (event.type == SDL_KEYDOWN) pressed.insert(event.key.keysym.sym);
        if (event.type == SDL_DROPFILE) SDL_free(event.drop.file);
        frames_to_draw_ = std::max(frames_to_draw_, 3); // ImGui settles over some frames
        moved_at_ = state_.time;
    };
    if (frames_ != frames_at_events_) {
        for (SDL_Event& event : waiting_) take(event);
        waiting_.clear();
        frames_at_events_ = frames_;
    }
    SDL_Event event;
    while (waiting_.empty() && SDL_PollEvent(&event) != 0) {
        if (event.type == SDL_KEYUP && pressed.contains(event.key.keysym.sym))
            waiting_.push_back(event);
        else
            take(event);
    }
    for (const InputEvent& input : inputs) handle(input);
}

vec3 App::pivot() const
{
    if (state_.picked_point) return state_.picked_point->point;
    return state_.camera.target;
}

void App::handle(const InputEvent& input)
{
    const float per_pixel =
        glm::radians(state_.camera.fov_degrees) / std::max(1.0f, std::min(state_.panes[0].w, state_.panes[0].h));
    const float distance = std::max(length(pivot() - state_.camera.eye), 1e-6f);
    constexpr float orbit_per_pixel = 0.008f;
    auto kind = input.kind;
    if (kind == InputEvent::Kind::look && state_.is_orbiting) kind = InputEvent::Kind::orbit;
    switch (kind) {
    case InputEvent::Kind::key:
        act(input.press);
        break;
    case InputEvent::Kind::look: // the picture follows the hand
        show_camera(turn(state_.camera, -input.x * per_pixel, input.y * per_pixel), input.when);
        break;
    case InputEvent::Kind::orbit:
        show_camera(orbit(state_.camera, pivot(), input.x * orbit_per_pixel, -input.y * orbit_per_pixel), input.when);
        break;
    case InputEvent::Kind::pan:
        show_camera(pan(state_.camera, -input.x * per_pixel * distance, input.y * per_pixel * distance), input.when);
        break;
    case InputEvent::Kind::dolly:
        show_camera(dolly(state_.camera, pivot(), std::exp(0.005f * (input.y - input.x))), input.when);
        break;
    case InputEvent::Kind::wheel:
        if (state_.is_orbiting) {
            show_camera(dolly(state_.camera, pivot(), std::pow(0.9f, input.y)), input.when);
        } else {
            const float natural = natural_speed(state_.bounds);
            state_.speed = std::clamp(state_.speed * std::pow(1.2f, input.y), 1e-3f * natural, 1e3f * natural);
            state_.say(fmt::format("speed {:.3g} a second", state_.speed));
        }
        break;
    case InputEvent::Kind::click:
        pick(input.x, input.y);
        break;
    case InputEvent::Kind::drop:
        drop(input.text);
        break;
    case InputEvent::Kind::quit:
        quit(0);
        break;
    case InputEvent::Kind::resized:
        break;
    }
}

void App::move_by_keys(double seconds)
{
    const vec3 move = input_.move();
    if (move == vec3(0.0f) || state_.opened == 0) return;
    const float step = state_.speed * input_.move_factor() * static_cast<float>(seconds);
    // The first step of a key that was just pressed counts from its event.
    const double when = moved_by_keys_at_ < input_.held_since() ? input_.held_since() : seconds_now();
    moved_by_keys_at_ = seconds_now();
    show_camera(fly(state_.camera, move.x * step, move.y * step, move.z * step), when);
}

void App::show_camera(const CameraDesc& wanted, double when)
{
    CameraDesc camera = wanted;
    // Or each step would focus it anew, on a target whose distance is rounded to another number.
    if (camera.model.kind == camera_lens && !(camera.model.focus_distance > 0.0f))
        camera.model.focus_distance = length(camera.target - camera.eye);
    if (state_.opened == 0) return; // there is nothing to be seen yet
    if (const std::string fault = camera_fault(camera); !fault.empty()) return state_.say("the camera has " + fault);
    state_.camera = camera;
    if (!camera_to_send_) camera_when_ = when;
    camera_to_send_ = camera;
}

void App::pick(float x, float y)
{
    const auto pixel = pixel_at(x, y);
    if (!pixel) return;
    state_.active_pane = pixel->pane;
    state_.picked = pixel;
    for (const auto& panel : panels_)
        if (panel->click(state_, *pixel)) break;
    const PickedPixel at = *pixel;
    session_->query([arrived = arrived_, at](const SessionAccess& access) {
        std::optional<PickedPoint> point;
        if (at.pane < access.prepared.size() && access.prepared[at.pane] != nullptr) {
            const Prepared& prepared = *access.prepared[at.pane];
            const RenderSettings& settings = access.panes[at.pane].settings;
            const ReadyCamera camera = make_camera(access.camera, settings.width, settings.height);
            const Ray ray = camera_ray(camera, vec2(static_cast<float>(at.x) + 0.5f, static_cast<float>(at.y) + 0.5f));
            const Hit hit = RayScene(prepared.packed.view(), *prepared.accel).intersect(ray);
            if (is_hit(hit)) point = PickedPoint{ray.origin + hit.t * ray.direction, hit.t, none};
        }
        const std::lock_guard lock(arrived->mutex);
        arrived->picked = point;
    });
}

void App::act(KeyPress press)
{
    const auto aspect = [&] {
        const RenderSettings& s = state_.panes[0].request.settings;
        return static_cast<float>(s.width) / static_cast<float>(s.height);
    };
    const auto digit = static_cast<std::size_t>(std::clamp(press.digit, 0, 9));
    switch (press.action) {
    case Action::none:
        break;
    case Action::play:
        if (state_.outline.animations.empty())
            state_.say("nothing moves in this scene: it has no animation");
        else
            state_.is_playing = !state_.is_playing;
        break;
    case Action::pause_rendering:
        state_.is_paused = !state_.is_paused;
        state_.say(state_.is_paused ? "rendering is paused; P goes on" : "rendering goes on");
        break;
    case Action::copy_camera:
        copy_camera();
        break;
    case Action::frame_scene:
        show_camera(frame(state_.camera, state_.bounds, aspect()), seconds_now());
        break;
    case Action::toggle_orbit:
        state_.is_orbiting = !state_.is_orbiting;
        state_.say(state_.is_orbiting ? "orbit: left drag goes around the picked point"
                                      : "fly: left drag looks around");
        break;
    case Action::hide_ui:
        state_.ui_hidden = !state_.ui_hidden;
        break;
    case Action::help:
        if (Panel* help = find_panel("Help")) help->is_open = !help->is_open;
        state_.ui_hidden = false;
        break;
    case Action::panels:
        shows_column_ = state_.ui_hidden || !shows_column_;
        state_.ui_hidden = false;
        break;
    case Action::reload:
        if (!state_.file.empty()) open(state_.file, true);
        break;
    case Action::screenshot:
        take_screenshot();
        break;
    case Action::quit:
        asks_to_quit_ = true;
        break;
    case Action::open:
        opens_file_dialog_ = true;
        break;
    case Action::exposure_down:
        state_.exposure_ev -= 0.5f;
        break;
    case Action::exposure_up:
        state_.exposure_ev += 0.5f;
        break;
    case Action::restart:
        session_->restart();
        break;
    case Action::other_device:
        try {
            std::string& device =
                state_.panes[std::min(state_.active_pane, state_.panes.size() - 1)].request.settings.device;
            find_panel("Rendering")->set(state_, "device", device == "cpu" ? "gpu" : "cpu");
            state_.say("rendering on " + device);
        } catch (const Error& error) {
            state_.say(error.what());
        }
        break;
    case Action::recall_view:
        if (state_.stored[digit])
            show_camera(*state_.stored[digit], seconds_now());
        else
            state_.say(fmt::format("no view is stored under {}; Ctrl+{} stores one", digit, digit));
        break;
    case Action::store_view:
        state_.stored[digit] = state_.camera;
        state_.say(fmt::format("stored as view {}", digit));
        break;
    case Action::undo:
        ImGui::GetIO().KeyShift ? state_.document.redo(state_) : state_.document.undo(state_);
        break;
    case Action::redo:
        state_.document.redo(state_);
        break;
    }
    if (press.action == Action::exposure_down || press.action == Action::exposure_up)
        state_.say(fmt::format("exposure {:+.1f} EV", state_.exposure_ev));
    state_.wake();
}

// ---- the session ----

bool App::is_settled() const
{
    const RenderSettings& settings = state_.panes[0].request.settings;
    return awaited_.empty() && !camera_to_send_ && settings.width == sized_w_ && settings.height == sized_h_ &&
           sent_panes_.size() == state_.panes.size() && sent_panes_[0] == state_.panes[0].request;
}

void App::send_requests()
{
    std::vector<PaneRequest> requests;
    for (const Pane& pane : state_.panes) requests.push_back(pane.request);
    if (requests != sent_panes_ && frames_ > 0) { // before the first frame nobody knows how large they are
        session_->set_panes(requests);
        sent_panes_ = requests;
    }
    if (!(state_.governor.target_ms == sent_governor_.target_ms && state_.governor.enabled == sent_governor_.enabled)) {
        session_->set_governor(state_.governor);
        sent_governor_ = state_.governor;
    }
    if (state_.is_paused != sent_paused_) {
        session_->set_paused(state_.is_paused);
        sent_paused_ = state_.is_paused;
    }
    constexpr double apart = 0.008; // more cameras than pictures would only keep the session from its work
    if (camera_to_send_ && state_.opened == state_.status.opened && seconds_now() - camera_sent_ >= apart) {
        const std::uint64_t number = session_->set_camera(*camera_to_send_);
        awaited_.push_back({number, camera_when_});
        camera_to_send_.reset();
        camera_sent_ = seconds_now();
        constexpr std::size_t most = 64; // of a hand that moves faster than pictures come
        if (awaited_.size() > most) awaited_.erase(awaited_.begin() + 1);
    }
}

void App::take_shots()
{
    // What was asked of a session that has failed, or of a scene that has gone, is not answered any more.
    constexpr double patience = 10.0;
    while (!awaited_.empty() && seconds_now() - awaited_.front().when > patience) awaited_.pop_front();

    for (std::size_t i = 0; i < state_.panes.size(); ++i) {
        Pane& pane = state_.panes[i];
        ShotPtr shot = pane.instead != nullptr ? pane.instead : session_->shot(i);
        if (shot == nullptr || shot == pane.shot) continue;
        pane.shot = std::move(shot);
        frames_to_draw_ = std::max(frames_to_draw_, 1);
    }
}

bool App::has_to_draw()
{
    if (script_ != nullptr && script_->wants_frame()) return true;
    if (frames_to_draw_ > 0) return true;
    const auto phase = state_.status.phase;
    const bool is_busy = phase == SessionStatus::Phase::loading || phase == SessionStatus::Phase::preparing ||
                         phase == SessionStatus::Phase::rendering;
    const double since = state_.time - drawn_at_;
    if (is_busy && since > 0.25) return true;                      // numbers go on
    if (state_.time - moved_at_ < 1.0 && since > 0.1) return true; // tooltips
    if (ImGui::GetIO().WantTextInput && since > 0.3) return true;  // the caret blinks
    if (!messages_.empty() && messages_.front().until < state_.time) return true;
    return since > 1.0;
}

void App::draw_frame()
{
    const auto begin = std::chrono::steady_clock::now();
    frames_to_draw_ = std::max(0, frames_to_draw_ - 1);
    drawn_at_ = state_.time;
    window_.set_light(state_.is_light);
    begin_items();
    window_.begin_frame(input_.pointer());
    input_.frame_drawn();
    draw_ui();
    window_.end_frame();
    ++frames_;

    const auto end = std::chrono::steady_clock::now();
    state_.timings.ui.add(std::chrono::duration<double, std::milli>(end - begin).count());
    const ShotPtr& shot = state_.panes[0].shot;
    if (shot == nullptr) return;
    const double now = seconds_now();
    if (state_.timings.first_picture_ms == 0)
        state_.timings.first_picture_ms = std::chrono::duration<double, std::milli>(end - start_).count();
    bool answers = false;
    while (!awaited_.empty() && awaited_.front().input <= shot->input) {
        state_.timings.input_to_picture.add(1e3 * (now - awaited_.front().when));
        awaited_.pop_front();
        answers = true;
    }
    if (answers) {
        constexpr double pause = 0.5; // longer: things had come to rest
        if (now - shown_at_ < pause) state_.timings.frame.add(1e3 * (now - shown_at_));
        shown_at_ = now;
    }
}

// ---- all of it ----

int run_viewer(const ViewOptions& options)
{
    App app(options);
    return app.run();
}

} // namespace snell::view
