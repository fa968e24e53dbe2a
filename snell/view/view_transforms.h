// The view transforms by name.
#pragma once

#include "snell/kernel/tone.h"

#include <array>
#include <span>

namespace snell::view {

// By number, as in snell/kernel/tone.h.
inline std::span<const char* const> view_transform_labels()
{
    static constexpr std::array labels = {"None (clip)", "Reinhard", "ACES (Narkowicz's fit)"};
    return labels;
}

} // namespace snell::view
