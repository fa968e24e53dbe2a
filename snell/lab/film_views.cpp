#include "snell/lab/film_views.h"

#include "snell/kernel/views.h"

#include <algorithm>
#include <cmath>

namespace snell {

const FilmViewInfo& info_of(FilmView view)
{
    static constexpr FilmViewInfo infos[film_view_count] = {
        {"sample count", "samples of each pixel", "samples"},
        {"standard error", "of the pixel's mean, on luminance: its spread if it were rendered again", ""},
        {"relative error", "standard error over the mean, which counts as 0.01 where it is darker", ""},
        {"time", "seconds of a thread's time that went into each pixel; those of a tile share its time alike", "s"}};
    return infos[static_cast<int>(view)];
}

static float film_value(const Film& film, FilmView view, std::size_t pixel)
{
    const uint count = film.sample_count[pixel];
    if (count == 0) return 0.0f;
    switch (view) {
    case FilmView::sample_count:
        return static_cast<float>(count);
    case FilmView::standard_error:
        return static_cast<float>(std::sqrt(film.mean_variance(pixel)));
    case FilmView::relative_error: {
        const double mean = static_cast<double>(luminance(film.sum[pixel])) / count;
        return static_cast<float>(std::sqrt(film.mean_variance(pixel)) / std::max(mean, 0.01));
    }
    default:
        return film.seconds.empty() ? 0.0f : film.seconds[pixel];
    }
}

std::vector<float> film_values(const Film& film, FilmView view)
{
    std::vector<float> values(film.sample_count.size());
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = film_value(film, view, i);
    return values;
}

HeatMap heat_map(int width, int height, const std::vector<float>& values, float most)
{
    HeatMap map;
    map.most = most;
    if (!(most > 0) && !values.empty()) {
        std::vector<float> sorted = values;
        const std::size_t at = (sorted.size() - 1) * 99 / 100;
        std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(at), sorted.end());
        map.most = sorted[at];
    }
    if (!(map.most > 0)) map.most = 1.0f;
    map.picture = {width, height, std::vector<vec3>(values.size())};
    for (std::size_t i = 0; i < values.size(); ++i) map.picture.pixels[i] = heat_color(values[i] / map.most);
    return map;
}

} // namespace snell
