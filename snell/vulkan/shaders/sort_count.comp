#version 460
// Sorting by material: how many paths of a wave have met each kind. A counting sort; this and sort_place.
#include "snell/vulkan/shaders/stage.glsl"

shared uint found[sort_bins];

void main()
{
    uint i = gl_GlobalInvocationID.x;
    uint lane = gl_LocalInvocationIndex;
    if (lane < sort_bins) found[lane] = 0u;
    barrier();
    if (is_in_wave(i)) {
        Hit hit = job.hits.at[i];
        uint bin = bin_of_misses;
        if (is_hit(hit)) bin = job.scene.materials.at[material_of(job.scene, hit.primitive)].kind;
        job.bins.at[i] = bin;
        atomicAdd(found[bin], 1u);
    }
    barrier();
    if (lane < sort_bins && found[lane] > 0u)
        atomicAdd(job.counters.at[0].bin_sizes[sort_bins * push.wave + lane], found[lane]);
}
