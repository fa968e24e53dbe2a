// From what was rendered to what the screen shows: exposure, view transform, 8 bits a channel.
#pragma once

#include "snell/render/session.h"

#include <cstdint>
#include <vector>

namespace snell::view {

struct DisplaySettings
{
    float exposure_ev = 0.0f;
    uint curve = 0; // tone_*
    bool operator==(const DisplaySettings&) const = default;
};

// Red, green, blue and 255 in the order of memory, row 0 at the top; as large as the shot's film.
struct ScreenPicture
{
    int width = 0, height = 0;
    std::vector<std::uint32_t> texels;
};

// Within one step of 255 of display_value() (snell/kernel/tone.h), by tables and in parallel. Data (Shot::is_data) are
// shown as they are: encoded as sRGB, without exposure and view transform. Pixels without samples show Shot::under,
// enlarged, or black. `to` keeps its memory from picture to picture.
void to_screen(const Shot& shot, const DisplaySettings& settings, ScreenPicture& to);

// The same for radiances in a row.
void to_screen(const vec3* radiance, std::size_t count, const DisplaySettings& settings, std::uint32_t* to);

} // namespace snell::view
