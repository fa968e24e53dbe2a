// The clusters that are left of the binary tree's bottom-up building (parallel locally-ordered clustering: Meister,
// Bittner 2018; on GPUs: Benthin et al. 2022, PLOC++), in the order of the curve.
#include "snell/vulkan/shaders/build.glsl"

bool is_even() { return (push.round & 1u) == 0u; }
uint cluster_count() { return counters.clusters[push.round & 1u]; }
uint cluster_at(uint i)
{
    if (is_even()) return job.clusters_0.at[i];
    return job.clusters_1.at[i];
}

// The cluster that i is joined with: both want each other. i itself: it stays alone.
uint agreed(uint i)
{
    uint other = job.wanted.at[i];
    return other != none && job.wanted.at[other] == i ? other : i;
}
