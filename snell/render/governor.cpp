#include "snell/render/governor.h"

#include <algorithm>
#include <cmath>

namespace snell {

// Of the target: what is aimed at, and the times with which it is content.
constexpr double aim = 0.85, too_slow = 1.05, too_fast = 0.65;
// Beyond these, one picture is enough to act; else two must agree, for the machine does other things as well.
constexpr double far_too_slow = 1.5, far_too_fast = 0.35;
// Steps that one picture may give back: what was measured at a low resolution says little about a high one.
constexpr int most_steps_up = 8;

void Governor::set(const GovernorSettings& settings)
{
    settings_ = settings;
    settings_.target_ms = std::isfinite(settings.target_ms) ? std::max(settings.target_ms, 1.0) : GovernorSettings{}.target_ms;
    decide();
}

void Governor::restart()
{
    scale_step_ = lowest_scale_step;
    depth_step_ = 0;
    slow_ = fast_ = 0;
    stepped_ = false;
    gain_.fill(assumed_gain);
    state_.measured_ms = 0;
    decide();
}

void Governor::measured(double ms)
{
    state_.measured_ms = ms;
    if (!settings_.enabled || !(ms > 0)) return;
    learn(ms);
    const double part = ms / settings_.target_ms;
    slow_ = part > too_slow ? slow_ + 1 : 0;
    fast_ = part < too_fast || fits_whole(part) ? fast_ + 1 : 0;
    if (slow_ >= 2 || part > far_too_slow)
        lower(part / aim);
    else if (fast_ >= 2 || part < far_too_fast)
        raise(aim / part);
    decide();
}

// Whether a picture with nothing left out would take less than the target, where one with state() takes that part of it.
bool Governor::fits_whole(double part) const
{
    return depth_step_ == 0 && scale_step_ > 0 && part * std::exp2(scale_step_ / 4.0) < 0.95;
}

// What a step of the depth was worth, so that it is not tried again and again.
void Governor::learn(double ms)
{
    if (!stepped_) return;
    stepped_ = false;
    const std::size_t deeper = std::min(stepped_from_, depth_step_), shallower = std::max(stepped_from_, depth_step_);
    const double gain = stepped_from_ < depth_step_ ? stepped_ms_ / ms : ms / stepped_ms_;
    if (shallower == deeper + 1) gain_[shallower] = std::clamp(gain, 1.05, 8.0);
}

void Governor::lower(double ratio)
{
    slow_ = fast_ = 0;
    const int before = scale_step_;
    const int steps = std::max(1, static_cast<int>(std::lround(4.0 * std::log2(ratio))));
    scale_step_ = std::min(before + steps, lowest_scale_step);
    if (before < lowest_scale_step || depth_step_ + 1 == depths.size()) return;
    stepped_ = true;
    stepped_from_ = depth_step_;
    stepped_ms_ = state_.measured_ms;
    double left = ratio;
    do {
        depth_step_ += 1;
        left /= gain_[depth_step_];
    } while (left > 1.2 && depth_step_ + 1 < depths.size());
}

void Governor::raise(double ratio)
{
    if (depth_step_ > 0) {
        if (ratio < gain_[depth_step_]) return;
        stepped_ = true;
        stepped_from_ = depth_step_;
        stepped_ms_ = state_.measured_ms;
        depth_step_ -= 1;
    } else {
        const int steps = static_cast<int>(std::floor(4.0 * std::log2(ratio)));
        scale_step_ = fits_whole(aim / ratio) && scale_step_ <= most_steps_up
                          ? 0
                          : std::max(0, scale_step_ - std::clamp(steps, 1, most_steps_up));
    }
    slow_ = fast_ = 0;
}

void Governor::decide()
{
    state_.scale = settings_.enabled ? std::exp2(-static_cast<float>(scale_step_) / 8.0f) : 1.0f;
    state_.max_depth = settings_.enabled ? depths[depth_step_] : 0;
}

} // namespace snell
