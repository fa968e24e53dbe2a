// Pictures of how two pictures differ.
#pragma once

#include "snell/io/image/image.h"

#include <span>
#include <string_view>

namespace snell {

enum class Difference
{
    signed_difference, // 0.5 + gain / 2 * (x - r), a channel: grey where they agree
    absolute,          // gain * |x - r|, a channel
    relative,          // heat map of gain * |x - r| / (|r| + 0.01), on luminance
    squared            // heat map of gain^2 * (x - r)^2, on luminance
};
inline constexpr std::string_view difference_names[] = {"signed", "absolute", "relative", "squared error"};

// Values to be shown as they are, without exposure and tone curve (but not cut to [0, 1] where there is no heat map).
// Pixels where one of the pictures is not finite are magenta. Throws Error if the sizes differ. In parallel.
Picture picture_of_difference(const Picture& picture, const Picture& reference, Difference kind, float gain = 1.0f);

} // namespace snell
