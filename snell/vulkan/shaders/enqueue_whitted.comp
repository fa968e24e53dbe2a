#version 460
// Whitted's renderer: the continuations go to their places in the queue, in the order of the paths that they come from.
#include "snell/vulkan/shaders/stage.glsl"

void main()
{
    uint i = gl_GlobalInvocationID.x;
    if (i >= push.count) return;
    uint begin = job.branch_counts.at[i];
    uint end = i + 1u < push.count ? job.branch_counts.at[i + 1u] : job.counters.at[0].paths[1];
    GpuBranches b = job.branches.at[i];
    if (end > begin) store_path(1u - push.queue, begin, b.ray_0, b.state_0);
    if (end > begin + 1u) store_path(1u - push.queue, begin + 1u, b.ray_1, b.state_1);
}
