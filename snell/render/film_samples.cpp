#include "snell/render/film_samples.h"

#include "snell/core/error.h"

#include <algorithm>

namespace snell {

uint recorded_samples(const RenderSettings& settings, uint first, uint count)
{
    const uint end = settings.first_sample + std::min(settings.spp, first_hit_samples);
    return settings.layers && first < end ? std::min(count, end - first) : 0;
}

void note_dropped(Film& film, std::uint64_t samples, std::span<const std::uint64_t> pixels)
{
    film.dropped_samples += samples;
    for (const std::uint64_t pixel : pixels) {
        const auto place = std::lower_bound(film.dropped.begin(), film.dropped.end(), pixel);
        if (place != film.dropped.end() && *place == pixel) continue;
        film.dropped.insert(place, pixel);
        if (film.dropped.size() > max_dropped_pixels) film.dropped.pop_back();
    }
}

void refuse_sample(uint sample, int x, int y, vec3 radiance)
{
    throw Error(fmt::format("sample {} of pixel {},{} is not finite: {} {} {}", sample, x, y, radiance.x, radiance.y,
                            radiance.z),
                "render that pixel alone with --pixel to look at it, or leave out --strict");
}

void add_samples(Film& film, const RenderSettings& settings, int x, int y, uint first,
                 std::span<const SampleSlot> samples, std::mutex& mutex)
{
    const std::size_t pixel =
        static_cast<std::size_t>(y) * static_cast<std::size_t>(film.width) + static_cast<std::size_t>(x);
    PixelSums sums = film.sums(pixel);
    for (std::size_t s = 0; s < samples.size(); ++s) {
        const vec3 radiance = sample_radiance(samples[s]);
        if (!is_finite3(radiance)) {
            if (settings.strict) refuse_sample(first + static_cast<uint>(s), x, y, radiance);
            const std::lock_guard lock(mutex);
            const std::uint64_t number = pixel;
            note_dropped(film, 1, {&number, 1});
            continue;
        }
        add_radiance(sums, radiance);
        sums.seen_through += samples[s].sees_through;
        if (settings.layers) {
            PixelLight light = film.layers.light(pixel);
            add_light(light, samples[s]);
            film.layers.set(pixel, light);
        }
    }
    film.set(pixel, sums);
}

void add_first_hit(FilmLayers& layers, std::size_t pixel, const FirstHit* hit, uint steps)
{
    PixelHits hits = layers.hits(pixel);
    add_hit(hits, hit != nullptr ? 1u : 0u, hit != nullptr ? *hit : FirstHit{}, steps);
    layers.set(pixel, hits);
}

void add_seen(FilmLayers& layers, std::size_t pixel, vec3 albedo, vec3 normal)
{
    PixelHits hits = layers.hits(pixel);
    add_seen(hits, albedo, normal);
    layers.set(pixel, hits);
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
