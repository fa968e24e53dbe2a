// What a film knows beside its colours, as heat maps: how many samples, how sure, how dear.
#pragma once

#include "snell/render/film.h"

#include <string_view>

namespace snell {

enum class FilmView
{
    sample_count,
    standard_error, // of the pixel's mean, on luminance
    relative_error, // the same over the mean; where it is dark, over 0.01
    seconds         // of a thread's time, in blocks: see Film::seconds
};

struct FilmViewInfo
{
    std::string_view name, summary, unit;
};
const FilmViewInfo& info_of(FilmView view);
inline constexpr int film_view_count = 4;

// The numbers of a view, one a pixel; 0 where there are no samples.
std::vector<float> film_values(const Film& film, FilmView view);

// Colours from heat_color(0) for 0 to heat_color(1) for `most` and beyond.
struct HeatMap
{
    Picture picture;
    float most = 1; // at the bright end
};
// most <= 0: chosen so that 99 of 100 pixels are below it.
HeatMap heat_map(int width, int height, const std::vector<float>& values, float most = 0);

} // namespace snell
