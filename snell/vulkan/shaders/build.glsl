// What the kernels that build and refit trees share.
#include "snell/vulkan/shaders/build.h"
#include "snell/vulkan/shaders/child_words.glsl"

layout(local_size_x = 64) in; // group_size
layout(push_constant, scalar) uniform Parameters
{
    BuildPush push;
};

// Workgroups lie in rows of wide_dispatch: devices need not take more than 65535 side by side. Those behind the last one
// that is asked for have nothing to do.
uint group_index() { return gl_WorkGroupID.y * wide_dispatch + gl_WorkGroupID.x; }
uint item_index() { return group_index() * 64u + gl_LocalInvocationIndex; }

#define job push.job.at[0]
#define counters job.counters.at[0]

// Floats as integers of the same order, and back.
uint order_of_float(float x)
{
    uint bits = floatBitsToUint(x);
    return (bits & 0x80000000u) != 0u ? ~bits : bits | 0x80000000u;
}
float float_of_order(uint order)
{
    return uintBitsToFloat((order & 0x80000000u) != 0u ? order & 0x7fffffffu : ~order);
}

// The box of all; empty if nothing has one.
Aabb box_of_all()
{
    Aabb box = empty_aabb();
    if (counters.low[0] == 0xffffffffu) return box;
    for (int axis = 0; axis < 3; ++axis) {
        box.lower[axis] = float_of_order(counters.low[axis]);
        box.upper[axis] = float_of_order(counters.high[axis]);
    }
    return box;
}
void set_box_of_all(Aabb box)
{
    for (int axis = 0; axis < 3; ++axis) {
        counters.low[axis] = is_empty(box) ? 0xffffffffu : order_of_float(box.lower[axis]);
        counters.high[axis] = is_empty(box) ? 0u : order_of_float(box.upper[axis]);
    }
}

// What boxes in `box` are scaled by for half_area().
float scale_for(Aabb box)
{
    float size = is_empty(box) ? 0.0f : max3(box.upper - box.lower);
    return size > 0.0f && is_finite(size) && is_finite(1.0f / size) ? 1.0f / size : 1.0f;
}

uint groups_for(uint items) { return (items + 63u) / 64u; }
// The numbers for vkCmdDispatchIndirect.
uvec2 dispatch_for(uint groups)
{
    return uvec2(min(groups, wide_dispatch), (groups + wide_dispatch - 1u) / wide_dispatch);
}
