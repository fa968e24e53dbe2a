#version 460
// Sorting by material: the paths of a wave go to the list in the order of their kinds. Those of one kind come in any
// order.
#include "snell/vulkan/shaders/stage.glsl"

shared uint found[sort_bins];
shared uint begin[sort_bins]; // of this workgroup's part of each bin

void main()
{
    uint i = gl_GlobalInvocationID.x;
    uint lane = gl_LocalInvocationIndex;
    if (lane < sort_bins) found[lane] = 0u;
    barrier();
    uint bin = 0u;
    uint rank = 0u;
    if (is_in_wave(i)) {
        bin = job.bins.at[i];
        rank = atomicAdd(found[bin], 1u);
    }
    barrier();
    if (lane < sort_bins && found[lane] > 0u) {
        uint place = atomicAdd(job.counters.at[0].bin_filled[sort_bins * push.wave + lane], found[lane]);
        for (uint k = 0u; k < lane; ++k) place += job.counters.at[0].bin_sizes[sort_bins * push.wave + k];
        begin[lane] = place;
    }
    barrier();
    if (is_in_wave(i)) job.sorted.at[begin[bin] + rank] = i;
}
