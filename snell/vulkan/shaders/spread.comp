#version 460
// Places in a queue, downwards: each count becomes the sum of all before it. The sums over 64 of them, at `to`, have
// been through this already; `which` 1: there are none, for these are the topmost.
#include "snell/vulkan/shaders/stage.glsl"

void main()
{
    uint i = gl_GlobalInvocationID.x;
    if (64u * i >= push.count) return;
    uint sum = push.which == 1u ? 0u : job.branch_counts.at[push.to + i];
    for (uint k = 64u * i; k < min(64u * i + 64u, push.count); ++k) {
        uint count = job.branch_counts.at[push.offset + k];
        job.branch_counts.at[push.offset + k] = sum;
        sum += count;
    }
    // The topmost level is one invocation's: it knows how many there are in all.
    if (push.which == 1u) job.counters.at[0].paths[1] = sum;
}
