#version 460
// Joining clusters: where the blocks write to, and what the next round has to do. One workgroup.
#include "snell/vulkan/shaders/clusters.glsl"
#include "snell/vulkan/shaders/scan.glsl"

void main()
{
    uint count = cluster_count();
    uint blocks = count > 1u ? (count + block_items - 1u) / block_items : 0u;
    uint left = 0u;
    uint joined = counters.nodes[push.round & 1u];
    for (uint first = 0u; first < blocks; first += 64u) {
        uint i = first + gl_LocalInvocationIndex;
        uint own_left = i < blocks ? job.sums.at[2u * i] : 0u;
        uint own_joined = i < blocks ? job.sums.at[2u * i + 1u] : 0u;
        uint all_left;
        uint all_joined;
        uint left_before = sum_before(own_left, all_left);
        uint joined_before = sum_before(own_joined, all_joined);
        if (i < blocks) {
            job.sums.at[2u * i] = left + left_before;
            job.sums.at[2u * i + 1u] = joined + joined_before;
        }
        left += all_left;
        joined += all_joined;
    }
    if (gl_LocalInvocationIndex != 0u) return;
    counters.clusters[1u - (push.round & 1u)] = blocks > 0u ? left : count;
    counters.nodes[1u - (push.round & 1u)] = joined;
}
