// The view transforms by name.
#pragma once

#include "snell/kernel/tone.h"

#include <array>
#include <span>
#include <string>

namespace snell::view {

// By number, as in snell/kernel/tone.h: for people, and as the command line has them.
inline std::span<const char* const> view_transform_labels()
{
    static constexpr std::array<const char*, tone_count> labels = {
        "None (clip)", "Reinhard", "ACES, Narkowicz's fit", "ACES, Hill's fit", "AgX", "Khronos PBR Neutral"};
    return labels;
}
inline std::span<const char* const> view_transform_names()
{
    static constexpr std::array<const char*, tone_count> names = {"none",      "reinhard", "aces-narkowicz",
                                                                  "aces-hill", "agx",      "neutral"};
    return names;
}

// Throws Error if there is none of that name.
uint find_view_transform(const std::string& name);

} // namespace snell::view
