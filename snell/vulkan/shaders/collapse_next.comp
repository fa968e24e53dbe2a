#version 460
// Wide nodes: what the level that is done has made is the next one.
#include "snell/vulkan/shaders/collapse.glsl"

void main()
{
    if (item_index() != 0u) return;
    uint end = counters.wide;
    counters.level_begin[push.round + 2u] = end;
    uvec2 groups = dispatch_for(groups_for(end - counters.level_begin[push.round + 1u]));
    for (int i = 0; i < 2; ++i) counters.level_groups[i] = groups[i];
}
