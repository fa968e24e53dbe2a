// The viewer's main loop and what it owns.
#pragma once

#include "snell/view/input.h"
#include "snell/view/panel.h"
#include "snell/view/viewer.h"
#include "snell/view/window.h"

#include <SDL_events.h>

#include <chrono>
#include <deque>
#include <mutex>

namespace snell::view {

class Recorder;
class Script;

class App
{
  public:
    explicit App(const ViewOptions& options);
    ~App();
    App(const App&) = delete;
    App& operator=(const App&) = delete;

    int run();

    // ---- for scripts ----
    ViewState& state() { return state_; }
    Window& window() { return window_; }
    std::vector<std::unique_ptr<Panel>>& panels() { return panels_; }
    Panel* find_panel(const std::string& name);
    void act(KeyPress press);
    void save_screenshot(const std::filesystem::path& file); // .png or .exr, of the active pane
    std::uint64_t frames() const { return frames_; }
    bool is_settled() const; // the picture that is shown answers all input
    bool is_opening() const { return !opening_.empty(); }
    // Nothing but a script's end closes the window: for random input.
    void hold_open(bool is_held) { is_held_open_ = is_held; }
    void quit(int code);
    void set_size(int width, int height) { window_.set_size(width, height); }

  private:
    // app.cpp: the loop
    void wait_for_events();
    void handle_events();
    void handle(const InputEvent& input);
    void move_by_keys(double seconds);
    void send_requests();
    void take_shots();
    void draw_frame();
    bool has_to_draw();
    void show_camera(const CameraDesc& camera, double when);
    vec3 pivot() const;
    void pick(float x, float y);
    std::optional<PickedPixel> pixel_at(float x, float y) const;
    bool is_picture_at(float x, float y) const;

    // app_draw.cpp: what is on the screen
    void draw_ui();
    void draw_menu();
    void draw_status();
    void draw_column(float top, float bottom);
    void draw_floating();
    void draw_panes();
    void draw_divider();
    void draw_sketch();
    void draw_messages(float bottom);
    void lay_out_panes(float x, float y, float w, float h);
    void draw_panel_header(Panel& panel);
    void draw_empty(float x, float y, float w, float h);
    void draw_loading(float x, float y, float w, float h);
    void draw_failure(float x, float y, float w, float h);
    void draw_dialogs();

    // app_files.cpp: scenes and pictures as files
    void open(const std::string& name, bool keeps_camera = false);
    void follow_opening();
    void drop(const std::string& file);
    void drop_environment(const std::string& file);
    void drop_texture(const std::string& file, uint material);
    void watch_file();
    void take_screenshot();
    void copy_camera();
    void load_recent();
    void remember(const std::string& name);
    void write_timings() const;

    struct Texel;
    // What the session's thread hands over; shared with the queries under way.
    struct Arrived
    {
        std::mutex mutex;
        std::optional<Scene> outline;
        std::vector<Note> notes;
        Bounds bounds;
        CameraDesc camera;
        std::uint64_t opened = 0;
        std::optional<std::optional<PickedPoint>> picked;
    };
    struct Message
    {
        std::string text;
        double until = 0;
    };
    struct PaneTexture
    {
        Texture texture;
        ShotPtr shot;
        DisplaySettings settings;
    };
    struct AwaitedPicture
    {
        std::uint64_t input = 0;
        double when = 0; // of the event, as seconds_now() counts
    };

    const ViewOptions options_;
    const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
    Window window_;
    std::unique_ptr<Session> session_;
    ViewState state_;
    std::vector<std::unique_ptr<Panel>> panels_;
    std::shared_ptr<Arrived> arrived_ = std::make_shared<Arrived>();
    Input input_;
    std::vector<SDL_Event> waiting_; // for the next frame
    std::uint64_t frames_at_events_ = 0;
    std::unique_ptr<Script> script_;
    std::unique_ptr<Recorder> recorder_; // of --record: the viewer ends with it

    std::vector<PaneRequest> sent_panes_;
    GovernorSettings sent_governor_;
    bool sent_paused_ = false;
    std::optional<CameraDesc> camera_to_send_;
    double camera_when_ = 0; // the first event that is in it
    double camera_sent_ = 0;
    std::deque<AwaitedPicture> awaited_;
    std::vector<std::unique_ptr<PaneTexture>> textures_;
    ScreenPicture screen_;
    double shown_at_ = 0; // the last picture
    int sized_w_ = 0, sized_h_ = 0;
    double sized_at_ = 0;

    std::string opening_; // name of what is being opened
    std::uint64_t opening_number_ = 0;
    std::uint64_t asked_outline_ = 0;
    bool keeps_camera_ = false; // the scene that is being opened is the old one, read again
    std::string failed_;        // name of what could not be opened, last
    std::string dismissed_failure_;
    std::filesystem::file_time_type file_time_{}, opening_time_{}; // of what is shown; of what is being opened
    double watched_at_ = 0;

    std::deque<Message> messages_;
    int frames_to_draw_ = 3;
    double drawn_at_ = 0, moved_at_ = 0, moved_by_keys_at_ = 0;
    std::uint64_t frames_ = 0;
    bool shows_column_ = true, asks_to_quit_ = false, opens_file_dialog_ = false, asks_undo_ = false;
    float column_width_ = 0;
    std::string typed_file_;
    bool is_done_ = false, is_held_open_ = false;
    bool is_dragging_divider_ = false;
    int code_ = 0;
};

} // namespace snell::view
