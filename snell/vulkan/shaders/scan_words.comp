#version 460
// Each of `count` words becomes the sum of all before it. One workgroup.
#include "snell/vulkan/shaders/build.glsl"
#include "snell/vulkan/shaders/scan.glsl"

void main()
{
    uint carried = 0u;
    for (uint first = 0u; first < push.count; first += block_items) {
        uint from = first + gl_LocalInvocationIndex * items_each;
        uint own = 0u;
        for (uint i = from; i < min(from + items_each, push.count); ++i) own += job.sums.at[i];
        uint total;
        uint sum = carried + sum_before(own, total);
        for (uint i = from; i < min(from + items_each, push.count); ++i) {
            uint value = job.sums.at[i];
            job.sums.at[i] = sum;
            sum += value;
        }
        carried += total;
    }
}
