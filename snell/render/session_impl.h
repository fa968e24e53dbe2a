// The inside of a Session: what its caller and its thread share, and what is the thread's own.
#pragma once

#include "snell/render/session_loader.h"
#include "snell/render/session_pane.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <thread>

namespace snell {

using Clock = std::chrono::steady_clock;

// An edit or a query.
struct Task
{
    std::uint64_t number = 0;
    std::uint64_t meant_for = 0; // SessionStatus::opened as the caller has seen it last
    std::function<uint(Scene&)> edit;
    std::function<void(const SessionAccess&)> query;
};

// What was asked since the session's thread has looked last.
struct Requests
{
    std::optional<std::vector<PaneRequest>> panes;
    std::optional<CameraDesc> camera;
    std::optional<GovernorSettings> governor;
    std::deque<Task> tasks;
    std::unique_ptr<LoadedScene> scene;
    bool restart = false;
    bool any = false;
};

struct Session::Impl
{
    Impl();
    ~Impl();

    // What write() makes of `pending` is seen at once if it is urgent, else between chunks.
    std::uint64_t post(bool is_urgent, bool moves, const std::function<void()>& write);
    void tell_thread(bool is_urgent, const std::function<void()>& write); // the same, without a number

    // ---- on the session's thread ----
    void run();
    void serve(Requests requests);
    void run_task(const Task& task);
    void follow_changes();
    void replace_scene(std::unique_ptr<LoadedScene> loaded);
    void set_panes(std::vector<PaneRequest> requests);
    void prepare_panes();
    void work();
    void render_previews();
    void refine_one();
    void publish(std::size_t pane, bool is_paused);
    void tell();
    bool has_work() const;
    bool is_scene_to_come() const;

    // ---- shared; the mutex is held for moments only ----
    mutable std::mutex mutex;
    std::condition_variable wake;
    Requests pending;
    std::uint64_t last_number = 0;
    std::vector<PaneRequest> asked_panes;
    bool paused = false;
    Clock::time_point moving_until{}, asking_until{};
    SessionStatus status;
    bool is_idle = true, is_preparing = false;
    std::string edit_error, pane_error;
    mutable std::uint64_t seen_opened = 0; // by the caller, in status()
    struct Slot
    {
        ShotPtr shot;
        bool is_awaited = true; // nobody has taken `shot` yet: false
    };
    mutable std::vector<Slot> slots;
    std::atomic<bool> stop = false, urgent = false;

    // ---- the session's thread's own ----
    std::unique_ptr<Scene> scene = std::make_unique<Scene>();
    std::uint64_t opened = 0; // 0: there is no scene
    CameraDesc camera;
    PreparedSet prepared;
    std::vector<PaneRequest> requests_of_panes;
    std::vector<SessionPane> panes;
    Governor governor;
    bool gave_up = false; // the last preview
    std::uint64_t input = 0;
    uint changes = 0; // that `prepared` has not followed yet
    std::uint64_t version = 0;
    std::deque<Task> waiting; // for the first scene
    std::shared_ptr<ShotPool> pool = std::make_shared<ShotPool>();

    SceneLoader loader; // its thread ends before what it writes to goes
    std::thread thread;
};

} // namespace snell
