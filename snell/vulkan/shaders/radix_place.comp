#version 460
// Radix sort: keys go to their places, and equal digits stay in their order. push.count: blocks; push.round: the digit.
#include "snell/vulkan/shaders/build.glsl"

shared uint found[16][64]; // of each digit by each invocation, then how many come before

void main()
{
    uint lane = gl_LocalInvocationIndex;
    uint first = group_index() * block_items + lane * items_each;
    uint end = min(first + items_each, job.count);
    uint shift = digit_bits * push.round;
    bool even = (push.round & 1u) == 0u;
    for (uint digit = 0u; digit < digit_count; ++digit) found[digit][lane] = 0u;
    for (uint i = first; i < end; ++i) {
        uint code = even ? job.codes_0.at[i] : job.codes_1.at[i];
        found[code >> shift & (digit_count - 1u)][lane] += 1u;
    }
    barrier();
    if (lane < digit_count && group_index() < push.count) {
        uint sum = job.sums.at[lane * push.count + group_index()];
        for (uint other = 0u; other < 64u; ++other) {
            uint value = found[lane][other];
            found[lane][other] = sum;
            sum += value;
        }
    }
    barrier();
    for (uint i = first; i < end; ++i) {
        uint code = even ? job.codes_0.at[i] : job.codes_1.at[i];
        uint place = even ? job.places_0.at[i] : job.places_1.at[i];
        uint digit = code >> shift & (digit_count - 1u);
        uint to = found[digit][lane];
        found[digit][lane] = to + 1u;
        if (even) {
            job.codes_1.at[to] = code;
            job.places_1.at[to] = place;
        } else {
            job.codes_0.at[to] = code;
            job.places_0.at[to] = place;
        }
    }
}
