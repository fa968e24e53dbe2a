#version 460
// Joining clusters: how many of a block are left, and how many new nodes that makes.
#include "snell/vulkan/shaders/clusters.glsl"
#include "snell/vulkan/shaders/scan.glsl"

void main()
{
    uint first = group_index() * block_items + gl_LocalInvocationIndex * items_each;
    uint left = 0u;
    uint joined = 0u;
    for (uint i = first; i < min(first + items_each, cluster_count()); ++i) {
        uint other = agreed(i);
        if (other >= i) left += 1u;
        if (other > i) joined += 1u;
    }
    uint all_left;
    uint all_joined;
    sum_before(left, all_left);
    sum_before(joined, all_joined);
    if (gl_LocalInvocationIndex == 0u && group_index() * block_items < cluster_count()) {
        job.sums.at[2u * group_index()] = all_left;
        job.sums.at[2u * group_index() + 1u] = all_joined;
    }
}
