// From the samples of a backend to the film: what is the same for all of them.
#pragma once

#include "snell/kernel/path_state.h"
#include "snell/kernel/views.h"
#include "snell/render/film.h"

#include <mutex>
#include <span>

namespace snell {

// One radiance for each sample of a batch, split by layer.
struct SampleSlot
{
    vec3 layers[layer_count];
    uint sees_through; // 1: the camera ray met nothing, and no environment to be seen
};

// Samples whose first hits are recorded: enough for smooth edges, few enough to cost nothing.
inline constexpr uint first_hit_samples = 16;

// Of the samples [first, first + count), how many are to be recorded: the first of them.
uint recorded_samples(const RenderSettings& settings, uint first, uint count);

// Adds the samples of pixel (x, y), in ascending order from number `first` on, and leaves out what is not finite: that
// is counted, under the mutex. Throws Error for it if the settings are strict.
void add_samples(Film& film, const RenderSettings& settings, int x, int y, uint first,
                 std::span<const SampleSlot> samples, std::mutex& mutex);

// Adds what one sample has met first, nullptr: nothing, but for albedo and normal; those come by add_seen().
void add_first_hit(FilmLayers& layers, std::size_t pixel, const FirstHit* hit, uint steps);
// Albedo and normal of one sample, of what is seen in mirrors and through glass; 0 if nothing is.
void add_seen(FilmLayers& layers, std::size_t pixel, vec3 albedo, vec3 normal);

// Shares a time alike among the pixels [x0, x1) x [y0, y1), which were worked on as a whole.
void add_time(Film& film, const Region& tile, double seconds);

} // namespace snell
