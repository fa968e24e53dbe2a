// A session's thread: it takes what was asked for, and renders.
#include "snell/core/error.h"
#include "snell/core/parallel.h"
#include "snell/core/timer.h"
#include "snell/render/render_stats.h"
#include "snell/render/session_impl.h"

#include <sys/resource.h>

#include <algorithm>
#include <utility>

namespace snell {

// Seconds of work between two looks at the requests that can wait for it: while nobody asks anything, and for a while
// after somebody did.
constexpr double long_chunk = 0.1, short_chunk = 0.02;
// A preview that takes that many times its target is given up for a coarser one, if there is something newer to show.
constexpr double patience = 2.0;
constexpr std::size_t most_panes = 4;

static std::size_t peak_memory()
{
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<std::size_t>(usage.ru_maxrss) * 1024; // Linux counts in KiB
}

void Session::Impl::run()
{
    const CancelScope scope(stop); // trees that are being built as well
    try {
        while (!stop) {
            Requests requests;
            {
                std::unique_lock lock(mutex);
                wake.wait(lock, [&] { return stop || pending.any || has_work(); });
                if (stop) return;
                requests = std::exchange(pending, {});
                input = last_number;
                urgent = false;
            }
            if (requests.any) serve(std::move(requests));
            work();
            tell();
        }
    } catch (const Cancelled&) {
        SNELL_CHECK_EQ(stop.load(), true);
    }
}

// With the mutex.
bool Session::Impl::has_work() const
{
    for (const SessionPane& pane : panes)
        if (pane.wants_preview() || (pane.wants_more() && !paused)) return true;
    return false;
}

void Session::Impl::serve(Requests requests)
{
    if (requests.governor) governor.set(*requests.governor);
    for (Task& task : requests.tasks) waiting.push_back(std::move(task));
    const auto run_tasks = [&] {
        for (; !waiting.empty(); waiting.pop_front()) run_task(waiting.front());
    };
    if (requests.panes) set_panes(std::move(*requests.panes));
    if (requests.camera) camera = *requests.camera;
    if (requests.camera || requests.restart)
        for (SessionPane& pane : panes) pane.try_again();
    // Edits that came before the new scene were meant for the old one, if there is one.
    if (opened != 0 || (!requests.scene && !is_scene_to_come())) run_tasks();
    if (requests.scene) {
        replace_scene(std::move(requests.scene));
        run_tasks();
    }
    follow_changes();
    prepare_panes();
    for (SessionPane& pane : panes)
        if (pane.is_torn()) pane.begin();
}

bool Session::Impl::is_scene_to_come() const
{
    if (loader.is_busy()) return true;
    const std::lock_guard lock(mutex); // it has delivered before it was no longer busy
    return pending.scene != nullptr;
}

void Session::Impl::run_task(const Task& task)
{
    if (task.query) {
        follow_changes();
        prepare_panes();
        std::vector<const Prepared*> by_pane;
        for (const SessionPane& pane : panes) by_pane.push_back(pane.prepared());
        try {
            task.query({*scene, requests_of_panes, by_pane, camera, opened});
        } catch (const std::exception& e) {
            const std::lock_guard lock(mutex);
            edit_error = e.what();
        }
        return;
    }
    if (opened == 0 || (task.meant_for != 0 && task.meant_for != opened)) return;
    std::string error;
    try {
        changes |= task.edit(*scene);
    } catch (const std::exception& e) {
        error = e.what();
        changes |= change_everything; // it may have come half way
    }
    version += 1;
    const std::lock_guard lock(mutex);
    edit_error = error;
}

void Session::Impl::follow_changes()
{
    const uint bits = std::exchange(changes, 0u);
    if ((bits & ~uint{change_camera}) == 0) return;
    for (SessionPane& pane : panes) pane.begin(); // and let go of what changes now
    prepared.follow(*scene, bits);
    for (SessionPane& pane : panes)
        if (pane.is_rendered()) pane.use(prepared.find(pane.settings()));
}

void Session::Impl::replace_scene(std::unique_ptr<LoadedScene> loaded)
{
    for (SessionPane& pane : panes) pane.use(nullptr);
    scene = std::move(loaded->scene);
    prepared = std::move(loaded->prepared);
    opened = loaded->opened;
    camera = scene->cameras.front();
    changes = 0;
    version += 1;
    governor.restart();
    for (SessionPane& pane : panes) {
        pane.begin();
        pane.take_stats();
    }
    std::size_t triangles = 0;
    for (const Mesh& mesh : scene->meshes) triangles += mesh.triangles.size();
    const std::lock_guard lock(mutex);
    status.name = loaded->name;
    status.scene_triangles = triangles;
    status.stats = {};
    status.stats.load_seconds = loaded->load_seconds;
    status.opened = opened;
    status.scene_version = version;
    edit_error.clear();
}

void Session::Impl::set_panes(std::vector<PaneRequest> requests)
{
    if (requests.size() > most_panes) requests.resize(most_panes);
    while (panes.size() > requests.size()) panes.pop_back();
    for (std::size_t i = 0; i < requests.size(); ++i) {
        if (i == panes.size()) panes.emplace_back(requests[i], pool);
        panes[i].ask(requests[i]);
    }
    requests_of_panes = std::move(requests);
    const std::lock_guard lock(mutex);
    slots.resize(panes.size());
}

// Gives every pane what its settings ask for.
void Session::Impl::prepare_panes()
{
    if (opened == 0) return;
    std::vector<RenderSettings> needed;
    for (const SessionPane& pane : panes)
        if (pane.is_rendered()) needed.push_back(pane.settings());
    for (SessionPane& pane : panes) {
        if (!pane.is_rendered()) pane.use(nullptr);
        if (!pane.is_rendered() || !pane.error().empty()) continue; // until it is asked for something else
        const Prepared* found = prepared.find(pane.settings());
        std::string error;
        if (found == nullptr) {
            {
                const std::lock_guard lock(mutex);
                is_preparing = true;
            }
            try {
                found = prepared.get(*scene, pane.settings());
            } catch (const std::exception& e) {
                error = e.what();
            }
            const std::lock_guard lock(mutex);
            is_preparing = false;
        }
        pane.use(found, error);
    }
    if (!needed.empty()) prepared.keep_for(needed);
}

void Session::Impl::work()
{
    const auto wants = [](const SessionPane& pane) { return pane.wants_preview(); };
    if (std::any_of(panes.begin(), panes.end(), wants))
        render_previews();
    else
        refine_one();
}

// One preview of every pane that wants one. What comes meanwhile waits for it, or slow scenes would never show anything
// while the camera moves.
void Session::Impl::render_previews()
{
    const Timer timer;
    bool is_all = true;
    std::size_t done = 0;
    double rendered = 0;
    bool stopped = false;
    const double limit = 1e-3 * patience * governor.settings().target_ms;
    const bool may_give_up = governor.settings().enabled && !gave_up;
    for (std::size_t i = 0; i < panes.size(); ++i) {
        SessionPane& pane = panes[i];
        if (!pane.wants_preview()) {
            is_all = is_all && pane.prepared() == nullptr;
            continue;
        }
        const bool complete = pane.preview(
            camera, governor.state(), [&] { return !stop && !(may_give_up && urgent && timer.seconds() > limit); });
        if (!complete) {
            stopped = true;
            rendered += pane.fraction();
            pane.begin();
            break;
        }
        rendered += 1;
        done += 1;
        publish(i, false);
    }
    gave_up = stopped;
    if (stop || !is_all || rendered <= 0) return;
    const std::size_t all = stopped ? panes.size() : done;
    governor.measured(1e3 * timer.seconds() * static_cast<double>(all) / rendered);
}

// A while of work on the pane that has got the least.
void Session::Impl::refine_one()
{
    SessionPane* least = nullptr;
    std::size_t index = 0;
    for (std::size_t i = 0; i < panes.size(); ++i)
        if (panes[i].wants_more() && (least == nullptr || panes[i].seconds() < least->seconds()))
            least = &panes[i], index = i;
    bool is_paused = false, is_asked = false;
    {
        const std::lock_guard lock(mutex);
        is_paused = paused;
        is_asked = Clock::now() < asking_until;
    }
    if (least != nullptr && !is_paused)
        least->refine(camera, is_asked ? short_chunk : long_chunk, [&] { return !urgent; });
    else
        index = panes.size();
    for (std::size_t i = 0; i < panes.size(); ++i)
        if (i == index || is_paused || !panes[i].wants_more()) publish(i, is_paused);
}

void Session::Impl::publish(std::size_t pane, bool is_paused)
{
    bool is_awaited = false;
    {
        const std::lock_guard lock(mutex);
        is_awaited = slots[pane].is_awaited;
    }
    ShotPtr shot = panes[pane].publish(input, is_awaited, is_paused);
    if (!shot) return;
    const std::lock_guard lock(mutex);
    slots[pane].shot.swap(shot); // the old one is freed after the lock
    slots[pane].is_awaited = false;
    status.copy_seconds = panes[pane].copy_seconds();
}

// What status() says of the work.
void Session::Impl::tell()
{
    RenderStats more;
    std::string error;
    for (SessionPane& pane : panes) {
        add(more, pane.take_stats());
        if (error.empty()) error = pane.error();
    }
    const std::lock_guard lock(mutex);
    add(status.stats, more);
    status.stats.scene_bytes = status.stats.accel_bytes = 0;
    const Prepared* last = nullptr;
    for (const SessionPane& pane : panes) {
        const Prepared* p = pane.prepared();
        if (p == nullptr || p == last) continue;
        last = p;
        status.stats.scene_bytes += p->packed.bytes();
        status.stats.accel_bytes += p->accel->stats.bytes;
        status.stats.pack_seconds = p->pack_seconds;
        status.stats.build_seconds = p->build_seconds;
    }
    pane_error = error;
    status.governor = governor.state();
    status.prepare_seconds = prepared.prepare_seconds;
    status.update_seconds = prepared.update_seconds;
    status.peak_memory_bytes = peak_memory();
    status.scene_version = version;
    is_idle = !pending.any && !has_work();
}

} // namespace snell
