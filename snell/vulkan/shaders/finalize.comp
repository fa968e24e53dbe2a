#version 460
// Finalize: the samples of a batch are added to the film, one pixel an invocation, in ascending order. `count`: pixels.
#include "snell/vulkan/shaders/stage.glsl"

// Counts a sample that is left out. The list keeps the lowest numbers of pixels whatever the order in which they come:
// each place keeps the lower of two and hands the other one on.
void note_dropped(uint pixel, uint number, vec3 radiance)
{
    if (atomicAdd(job.film.dropped.at[0].samples, 1u) == 0u) {
        job.film.dropped.at[0].sample_number = number;
        job.film.dropped.at[0].pixel = pixel;
        job.film.dropped.at[0].radiance = radiance;
    }
    uint carried = pixel;
    for (uint k = 0u; k < dropped_pixels && carried != none; ++k) {
        uint there = atomicMin(job.film.dropped.at[0].pixels[k], carried);
        if (there == carried) return;
        carried = max(there, carried);
    }
}

void main()
{
    uint p = gl_GlobalInvocationID.x;
    if (p >= push.count) return;
    uint pixel = film_pixel(p);
    PixelSums sums = job.film.sums.at[pixel];
    for (uint s = 0u; s < push.samples; ++s) {
        SampleSlot slot = job.slots.at[p * push.samples + s];
        vec3 radiance = sample_radiance(slot);
        if (!is_finite3(radiance)) {
            note_dropped(pixel, push.first_sample + s, radiance);
            continue;
        }
        add_radiance(sums, radiance);
        sums.seen_through += slot.sees_through;
        if (job.film.has_layers != 0u) {
            PixelLight light = job.film.layers.at[pixel].light;
            add_light(light, slot);
            job.film.layers.at[pixel].light = light;
        }
    }
    job.film.sums.at[pixel] = sums;
}
