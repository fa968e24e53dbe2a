// The frame governor: what to leave out so that pictures follow the hand while things move.
#pragma once

#include "snell/core/vec.h"

#include <array>

namespace snell {

struct GovernorSettings
{
    double target_ms = 16.0; // for one picture of all panes while things move
    bool enabled = true;     // false: always at full resolution and depth

    bool operator==(const GovernorSettings&) const = default;
};

// Its present decision.
struct GovernorState
{
    float scale = 1.0f;     // side of the rendered picture over that of the pane, in [1/8, 1]
    uint max_depth = 0;     // bounces that paths are held to; 0: as the settings ask
    double measured_ms = 0; // of the last picture; 0: none yet
};

// Its decisions are a function of its settings and of the times that it was told, in their order. It takes resolution
// first, down to an eighth, then bounces, and gives back in the opposite order. The scale goes in steps of 2^(1/8), and
// times between 0.65 and 1.05 of the target change nothing, so that it comes to rest.
class Governor
{
  public:
    void set(const GovernorSettings& settings);
    const GovernorSettings& settings() const { return settings_; }
    const GovernorState& state() const { return state_; }

    // For another scene, of which nothing is known: at the lowest scale and full depth.
    void restart();
    // What a picture with state() has taken.
    void measured(double ms);

  private:
    // Bounces by depth step.
    static constexpr std::array<uint, 7> depths = {0, 8, 6, 4, 3, 2, 1};

    bool fits_whole(double part) const;
    void lower(double ratio);
    void raise(double ratio);
    void learn(double ms);
    void decide();

    GovernorSettings settings_;
    GovernorState state_;
    int scale_step_ = lowest_scale_step;
    std::size_t depth_step_ = 0;
    int slow_ = 0, fast_ = 0;                // pictures in a row that took too long, or less than they may
    std::array<double, depths.size()> gain_; // how much dearer step i - 1 is than step i
    bool stepped_ = false;                   // the last decision changed the depth, by one step and alone
    std::size_t stepped_from_ = 0;
    double stepped_ms_ = 0;

    static constexpr int lowest_scale_step = 24;
    static constexpr double assumed_gain = 1.5;

  public:
    Governor() { restart(); }
};

} // namespace snell
