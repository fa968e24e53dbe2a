// A session as its caller sees it: requests are written down, and what the thread has made is handed out.
#include "snell/render/session.h"

#include "snell/render/session_impl.h"

namespace snell {

// How long a request to move makes the session say that something moves.
constexpr std::chrono::milliseconds moving_time{150};
// How long a question makes the session look for others more often.
constexpr std::chrono::seconds asking_time{2};

Session::Impl::Impl()
    : loader([this](std::unique_ptr<LoadedScene> loaded) {
          const bool is_scene = loaded != nullptr;
          tell_thread(is_scene, [&] {
              if (is_scene) pending.scene = std::move(loaded);
          });
      })
{
    status.governor = governor.state();
    thread = std::thread([this] { run(); });
}

Session::Impl::~Impl()
{
    stop = true;
    loader.stop();
    {
        const std::lock_guard lock(mutex);
        urgent = true;
    }
    wake.notify_all();
    thread.join();
}

std::uint64_t Session::Impl::post(bool is_urgent, bool moves, const std::function<void()>& write)
{
    std::uint64_t number = 0;
    tell_thread(is_urgent, [&] {
        number = ++last_number;
        write();
        if (moves) moving_until = Clock::now() + moving_time;
    });
    return number;
}

void Session::Impl::tell_thread(bool is_urgent, const std::function<void()>& write)
{
    {
        const std::lock_guard lock(mutex);
        write();
        pending.any = true;
        if (is_urgent) urgent = true;
        is_idle = false;
    }
    wake.notify_one();
}

Session::Session() : impl_(std::make_unique<Impl>()) {}

Session::~Session() = default;

std::uint64_t Session::open(std::string name, std::function<Scene(const LoadProgressCallback& progress)> load)
{
    std::vector<RenderSettings> settings;
    const std::uint64_t number = impl_->post(false, false, [&] {
        for (const PaneRequest& pane : impl_->asked_panes)
            if (pane.is_rendered) settings.push_back(pane.settings);
    });
    impl_->loader.open({number, std::move(name), std::move(load), std::move(settings)});
    return number;
}

void Session::cancel_open()
{
    impl_->loader.cancel();
    impl_->tell_thread(false, [] {}); // that there is nothing to wait for
}

std::uint64_t Session::set_panes(std::vector<PaneRequest> panes)
{
    return impl_->post(false, false, [&] {
        impl_->asked_panes = panes;
        impl_->pending.panes = std::move(panes);
        impl_->asking_until = Clock::now() + asking_time;
    });
}

std::uint64_t Session::set_camera(const CameraDesc& camera)
{
    return impl_->post(true, true, [&] { impl_->pending.camera = camera; });
}

std::uint64_t Session::edit(std::function<uint(Scene&)> edit)
{
    return impl_->post(true, true, [&] {
        impl_->pending.tasks.push_back({impl_->last_number, impl_->seen_opened, std::move(edit), {}});
    });
}

void Session::query(std::function<void(const SessionAccess&)> query)
{
    impl_->tell_thread(false, [&] {
        impl_->pending.tasks.push_back({impl_->last_number, 0, {}, std::move(query)});
        impl_->asking_until = Clock::now() + asking_time;
    });
}

void Session::set_paused(bool paused)
{
    impl_->tell_thread(false, [&] { impl_->paused = paused; });
}

std::uint64_t Session::restart()
{
    return impl_->post(true, false, [&] { impl_->pending.restart = true; });
}

void Session::set_governor(const GovernorSettings& settings)
{
    impl_->tell_thread(false, [&] { impl_->pending.governor = settings; });
}

ShotPtr Session::shot(std::size_t pane) const
{
    const std::lock_guard lock(impl_->mutex);
    if (pane >= impl_->slots.size()) return nullptr;
    impl_->slots[pane].is_awaited = true;
    return impl_->slots[pane].shot;
}

SessionStatus Session::status() const
{
    LoadStatus load = impl_->loader.status();
    const std::lock_guard lock(impl_->mutex);
    if (load.number == impl_->status.opened) load = {}; // it is here
    impl_->seen_opened = impl_->status.opened;
    SessionStatus status = impl_->status;
    status.is_moving = Clock::now() < impl_->moving_until;
    status.sketch = load.sketch;
    using Phase = SessionStatus::Phase;
    const bool is_arriving = impl_->pending.scene != nullptr;
    if (load.is_busy || is_arriving) {
        status.phase = load.is_busy && !load.is_preparing ? Phase::loading : Phase::preparing;
        status.name = load.name;
        status.what = load.what;
        status.fraction = load.fraction;
    } else if (!load.error.empty() || !impl_->edit_error.empty() || !impl_->pane_error.empty()) {
        status.phase = Phase::failed;
        status.what = !load.error.empty()          ? load.error
                      : !impl_->edit_error.empty() ? impl_->edit_error
                                                   : impl_->pane_error;
    } else if (status.opened == 0) {
        status.phase = Phase::empty;
    } else if (impl_->is_preparing) {
        status.phase = Phase::preparing;
        status.what = "building trees";
    } else {
        status.phase = impl_->is_idle ? Phase::resting : Phase::rendering;
    }
    return status;
}

} // namespace snell
