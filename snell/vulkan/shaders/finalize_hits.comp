#version 460
// Finalize, for the pictures beside the colour: what the first hits of a batch have to tell is added to the film, one
// pixel an invocation, in ascending order of samples. `count`: pixels.
#include "snell/vulkan/shaders/stage.glsl"

void main()
{
    uint p = gl_GlobalInvocationID.x;
    if (p >= push.count) return;
    uint pixel = film_pixel(p);
    PixelHits sums = job.film.layers.at[pixel].hits;
    for (uint s = 0u; s < push.samples; ++s) {
        GpuFirstHit found = job.first_hits.at[p * push.samples + s];
        FirstHit hit;
        hit.albedo = found.albedo;
        hit.normal = found.normal;
        hit.geometric_normal = found.geometric_normal;
        hit.position = found.position;
        hit.uv = found.uv;
        hit.depth = found.depth;
        hit.object = found.object;
        hit.material = found.material;
        add_hit(sums, found.has_hit, hit, found.steps);
        add_seen(sums, hit.albedo, hit.normal);
    }
    job.film.layers.at[pixel].hits = sums;
}
