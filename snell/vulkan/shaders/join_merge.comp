#version 460
// Joining clusters: pairs become nodes, and what is left moves together.
#include "snell/vulkan/shaders/clusters.glsl"
#include "snell/vulkan/shaders/scan.glsl"

void main()
{
    uint first = group_index() * block_items + gl_LocalInvocationIndex * items_each;
    uint end = min(first + items_each, cluster_count());
    uint left = 0u;
    uint joined = 0u;
    for (uint i = first; i < end; ++i) {
        uint other = agreed(i);
        if (other >= i) left += 1u;
        if (other > i) joined += 1u;
    }
    uint total;
    uint to = job.sums.at[2u * group_index()] + sum_before(left, total);
    uint node = job.sums.at[2u * group_index() + 1u] + sum_before(joined, total);
    for (uint i = first; i < end; ++i) {
        uint other = agreed(i);
        if (other < i) continue;
        uint id = cluster_at(i);
        if (other > i) {
            BuildNode a = job.nodes.at[id];
            uint right = cluster_at(other);
            BuildNode b = job.nodes.at[right];
            BuildNode both;
            both.lower = min(a.lower, b.lower);
            both.upper = max(a.upper, b.upper);
            both.left = id;
            both.right = right;
            both.below = min((a.below & 255u) + (b.below & 255u), 255u) | ((a.below | b.below) & ~255u);
            id = node++;
            job.nodes.at[id] = both;
        }
        if (is_even())
            job.clusters_1.at[to++] = id;
        else
            job.clusters_0.at[to++] = id;
    }
}
