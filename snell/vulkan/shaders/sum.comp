#version 460
// Places in a queue, upwards: sums over 64 counts each, from branch_counts[offset...] to branch_counts[to...].
#include "snell/vulkan/shaders/stage.glsl"

void main()
{
    uint i = gl_GlobalInvocationID.x;
    if (64u * i >= push.count) return;
    uint sum = 0u;
    for (uint k = 64u * i; k < min(64u * i + 64u, push.count); ++k) sum += job.branch_counts.at[push.offset + k];
    job.branch_counts.at[push.to + i] = sum;
}
