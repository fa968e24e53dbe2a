#version 460
// The cost of a tree from those of its nodes, of `count` workgroups; see WideTree::sah_cost. `which` 1: the tree is one
// leaf. One workgroup.
#include "snell/vulkan/shaders/build.glsl"
#include "snell/vulkan/shaders/scan.glsl"
#include "snell/vulkan/shaders/wide.glsl"

void main()
{
    float own = 0.0f;
    for (uint i = gl_LocalInvocationIndex; i < push.count; i += 64u) own += uintBitsToFloat(job.costs.at[i]);
    float sum = sum_of_group(own);
    if (gl_LocalInvocationIndex != 0u) return;
    if (push.which == 1u) {
        counters.cost = sum;
        return;
    }
    Aabb box = box_of_all();
    Aabb before = {job.tree.lower, job.tree.upper};
    float area = half_area(box, scale_for(push.to == 1u ? before : box));
    counters.cost = node_cost + (area > 0.0f ? sum / area : sum);
}
