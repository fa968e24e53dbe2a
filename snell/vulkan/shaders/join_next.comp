#version 460
// Joining clusters: the workgroups of the next round; none once there is one cluster. Of an own kernel, for the round
// that reads the numbers must be over.
#include "snell/vulkan/shaders/clusters.glsl"

void main()
{
    if (item_index() != 0u) return;
    uint count = cluster_count();
    uvec2 clusters = dispatch_for(count > 1u ? groups_for(count) : 0u);
    uvec2 blocks = dispatch_for(count > 1u ? (count + block_items - 1u) / block_items : 0u);
    for (int i = 0; i < 2; ++i) {
        counters.cluster_groups[i] = clusters[i];
        counters.block_groups[i] = blocks[i];
    }
}
