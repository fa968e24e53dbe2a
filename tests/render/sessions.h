// Sessions for tests: opened, waited for, and compared with what render() gives.
#pragma once

#include "snell/core/timer.h"
#include "snell/render/session.h"
#include "tests/render/scenes.h"

#include <chrono>
#include <functional>
#include <thread>

namespace snell::test {

using Phase = SessionStatus::Phase;

// Loaded machines and sanitizers are slow; what hangs, hangs for ever.
inline constexpr double generous = 30.0;

inline bool wait_until(const std::function<bool()>& done, double seconds = generous)
{
    const Timer timer;
    while (!done()) {
        if (timer.seconds() > seconds) return false;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return true;
}

inline PaneRequest pane_of(const std::string& integrator, int width = 40, int height = 30, uint spp = 5)
{
    PaneRequest pane;
    pane.settings.width = width;
    pane.settings.height = height;
    pane.settings.spp = spp;
    pane.settings.integrator = integrator;
    return pane;
}

inline const PaneRequest endless = pane_of("path", 640, 360, 1'000'000);

inline std::uint64_t open(Session& session, std::function<Scene()> make = mixed_scene, const char* name = "mixed")
{
    return session.open(name, [make = std::move(make)](const LoadProgressCallback&) { return make(); });
}

// The finished picture of a pane that answers everything so far.
inline ShotPtr rested(Session& session, std::uint64_t input, std::size_t pane = 0)
{
    ShotPtr shot;
    EXPECT_TRUE(wait_until([&] {
        shot = session.shot(pane);
        return shot && shot->finished && shot->input >= input;
    })) << "pane "
        << pane << ": " << session.status().what;
    return shot;
}

inline void expect_rendered(const ShotPtr& shot, const Film& film)
{
    ASSERT_TRUE(shot);
    Film shown = shot->film;
    EXPECT_TRUE(shown.excess.empty());
    shown.excess = film.excess;
    expect_same_film(shown, film);
}

inline Film rendered(const Scene& scene, const PaneRequest& pane)
{
    RenderSettings settings = pane.settings;
    settings.keep_motion = true;
    return render(scene, settings).film;
}

} // namespace snell::test
