// From the samples of a backend to the film: what is the same for all of them.
#pragma once

#include "snell/kernel/film.h"
#include "snell/render/film.h"

#include <mutex>
#include <span>

namespace snell {

// Samples whose first hits are recorded: enough for smooth edges, few enough to cost nothing.
inline constexpr uint first_hit_samples = 16;

// Of the samples [first, first + count), how many are to be recorded: the first of them.
uint recorded_samples(const RenderSettings& settings, uint first, uint count);

// Adds the samples of pixel (x, y), in ascending order from number `first` on, and leaves out what is not finite: that
// is counted, under the mutex. Throws Error for it if the settings are strict.
void add_samples(Film& film, const RenderSettings& settings, int x, int y, uint first,
                 std::span<const SampleSlot> samples, std::mutex& mutex);

// Notes `samples` that were left out, in these pixels among others: numbers of pixels, in ascending order, the first
// max_dropped_pixels of those that there are. A film keeps the first of the picture: the same ones whatever the order.
inline constexpr std::size_t max_dropped_pixels = 16;
void note_dropped(Film& film, std::uint64_t samples, std::span<const std::uint64_t> pixels);
// What a strict render says of one.
[[noreturn]] void refuse_sample(uint sample, int x, int y, vec3 radiance);

// Adds what one sample has met first, nullptr: nothing, but for albedo and normal; those come by add_seen().
void add_first_hit(FilmLayers& layers, std::size_t pixel, const FirstHit* hit, uint steps);
// As add_seen() of snell/kernel/film.h.
void add_seen(FilmLayers& layers, std::size_t pixel, vec3 albedo, vec3 normal);

// Shares a time alike among the pixels [x0, x1) x [y0, y1), which were worked on as a whole.
void add_time(Film& film, const Region& tile, double seconds);

} // namespace snell
