// What a renderer does a second, measured while it runs.
#pragma once

#include "snell/render/render.h"

#include <array>
#include <deque>

namespace snell {

struct RenderRates
{
    double camera_rays = 0, extension_rays = 0, shadow_rays = 0, samples = 0; // a second
    // Parts of the threads' time: generate, extend, shade, connect, finalize. They add up to 1, or are all 0.
    std::array<double, 5> stages{};

    double rays() const { return camera_rays + extension_rays + shadow_rays; }
};
inline constexpr std::array<const char*, 5> stage_names = {"generate", "extend", "shade", "connect", "finalize"};

// Means over a sliding window.
class RateMeter
{
  public:
    explicit RateMeter(double window_seconds = 1.0) : window_(window_seconds) {}

    // total: of all that was rendered until `time`, which never goes back. If a total falls, somebody counts anew: so
    // does the meter.
    void add(double time, const RenderStats& total);
    // Zeros before the second add().
    RenderRates rates() const;

  private:
    struct Entry
    {
        double time = 0;
        RenderStats total;
    };
    double window_;
    std::deque<Entry> entries_;
};

} // namespace snell
