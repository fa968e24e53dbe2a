#version 460
// Radix sort: how often each digit comes in each block of keys. push.count: blocks; push.round: the digit, from the last
// one on.
#include "snell/vulkan/shaders/build.glsl"

shared uint found[16];

void main()
{
    uint lane = gl_LocalInvocationIndex;
    if (lane < digit_count) found[lane] = 0u;
    barrier();
    for (uint k = 0u; k < items_each; ++k) {
        uint i = group_index() * block_items + k * 64u + lane;
        if (i >= job.count) break;
        uint code = (push.round & 1u) == 0u ? job.codes_0.at[i] : job.codes_1.at[i];
        atomicAdd(found[code >> (digit_bits * push.round) & (digit_count - 1u)], 1u);
    }
    barrier();
    if (lane < digit_count && group_index() < push.count) job.sums.at[lane * push.count + group_index()] = found[lane];
}
