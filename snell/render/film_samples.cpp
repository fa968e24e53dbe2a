#include "snell/render/film_samples.h"

#include "snell/core/error.h"

#include <algorithm>

namespace snell {

constexpr std::size_t max_dropped_pixels = 16;

uint recorded_samples(const RenderSettings& settings, uint first, uint count)
{
    const uint end = settings.first_sample + std::min(settings.spp, first_hit_samples);
    return settings.layers && first < end ? std::min(count, end - first) : 0;
}

// Keeps the first pixels of the picture, in order: the same ones whatever the threads did.
static void note_dropped(Film& film, std::uint64_t pixel)
{
    film.dropped_samples += 1;
    const auto place = std::lower_bound(film.dropped.begin(), film.dropped.end(), pixel);
    if (place != film.dropped.end() && *place == pixel) return;
    film.dropped.insert(place, pixel);
    if (film.dropped.size() > max_dropped_pixels) film.dropped.pop_back();
}

void add_samples(Film& film, const RenderSettings& settings, int x, int y, uint first,
                 std::span<const SampleSlot> samples, std::mutex& mutex)
{
    const std::size_t pixel =
        static_cast<std::size_t>(y) * static_cast<std::size_t>(film.width) + static_cast<std::size_t>(x);
    for (std::size_t s = 0; s < samples.size(); ++s) {
        const vec3* layers = samples[s].layers;
        const vec3 radiance = layers[layer_emission] + layers[layer_direct] + layers[layer_indirect];
        if (!is_finite3(radiance)) {
            if (settings.strict)
                throw Error(fmt::format("sample {} of pixel {},{} is not finite: {} {} {}", first + s, x, y, radiance.x,
                                        radiance.y, radiance.z),
                            "render that pixel alone with --pixel to look at it, or leave out --strict");
            const std::lock_guard lock(mutex);
            note_dropped(film, pixel);
            continue;
        }
        film.add_sample(pixel, radiance);
        if (!film.seen_through.empty()) film.seen_through[pixel] += samples[s].sees_through;
        if (settings.layers) {
            film.layers.emission[pixel] += layers[layer_emission];
            film.layers.direct[pixel] += layers[layer_direct];
            film.layers.indirect[pixel] += layers[layer_indirect];
        }
    }
}

void add_first_hit(FilmLayers& layers, std::size_t pixel, const FirstHit* hit, uint steps)
{
    layers.sample_count[pixel] += 1;
    layers.steps[pixel] += static_cast<float>(steps);
    if (hit == nullptr) return;
    if (layers.hit_count[pixel]++ == 0) {
        layers.object[pixel] = hit->object;
        layers.material[pixel] = hit->material;
    }
    layers.geometric_normal[pixel] += hit->geometric_normal;
    layers.position[pixel] += hit->position;
    layers.uv[pixel] += hit->uv;
    layers.depth[pixel] += hit->depth;
}

void add_seen(FilmLayers& layers, std::size_t pixel, vec3 albedo, vec3 normal)
{
    layers.albedo[pixel] += albedo;
    layers.normal[pixel] += normal;
}

void add_time(Film& film, const Region& tile, double seconds)
{
    if (film.seconds.empty()) return;
    const auto share = static_cast<float>(seconds / (static_cast<double>(tile.x1 - tile.x0) * (tile.y1 - tile.y0)));
    for (int y = tile.y0; y < tile.y1; ++y)
        for (int x = tile.x0; x < tile.x1; ++x)
            film.seconds[static_cast<std::size_t>(y) * static_cast<std::size_t>(film.width) +
                         static_cast<std::size_t>(x)] += share;
}

} // namespace snell
