#version 460
// Between the stages: how many workgroups the next ones need.
#include "snell/vulkan/shaders/stage.glsl"

void main()
{
    if (gl_GlobalInvocationID.x != 0u) return;
    uint next = push.wave + 1u;
    job.counters.at[0].path_groups[3u * next] = (job.counters.at[0].paths[next] + group_size - 1u) / group_size;
    job.counters.at[0].path_groups[3u * next + 1u] = 1u;
    job.counters.at[0].path_groups[3u * next + 2u] = 1u;
    uint connections = job.counters.at[0].connections[push.wave];
    job.counters.at[0].connection_groups[3u * push.wave] = (connections + group_size - 1u) / group_size;
    job.counters.at[0].connection_groups[3u * push.wave + 1u] = 1u;
    job.counters.at[0].connection_groups[3u * push.wave + 2u] = 1u;
}
