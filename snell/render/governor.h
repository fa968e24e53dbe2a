// The frame governor: what to leave out so that pictures follow the hand while things move.
#pragma once

#include "snell/core/vec.h"

namespace snell {

struct GovernorSettings
{
    double target_ms = 33.0; // for one picture of all panes while things move
    bool enabled = true;     // false: always at full resolution and depth
};

// Its present decision.
struct GovernorState
{
    float scale = 1.0f;     // side of the rendered picture over that of the pane, in (0, 1]
    uint max_depth = 0;     // bounces that paths are held to; 0: as the settings ask
    double measured_ms = 0; // of the last picture
};

} // namespace snell
