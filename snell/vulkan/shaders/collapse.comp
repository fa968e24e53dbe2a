#version 460
// Wide nodes: room for the children of all nodes of a level.
#include "snell/vulkan/shaders/collapse.glsl"

void main()
{
    uint i = counters.level_begin[push.round] + item_index();
    if (i >= counters.level_begin[push.round + 1u]) return;
    Family f = children_of(job.plans.at[i].root);
    uint inner = 0u;
    uint blocks = 0u;
    uint balls = 0u;
    for (uint k = 0u; k < f.count; ++k) {
        BuildNode child = job.nodes.at[f.node[k]];
        if (!is_leaf(child))
            inner += 1u;
        else if (kind_below(child) == kind_block)
            blocks += 1u;
        else if (kind_below(child) == kind_sphere_block)
            balls += 1u;
    }
    uint node = inner > 0u ? atomicAdd(counters.wide, inner) : 0u;
    job.plans.at[i].node = node;
    job.plans.at[i].line = blocks > 0u ? atomicAdd(counters.lines, lines_of_block * blocks) : 0u;
    job.plans.at[i].sphere = balls > 0u ? atomicAdd(counters.spheres, balls) : 0u;
    atomicAdd(counters.leaves, f.count - inner);
    for (uint k = 0u; k < f.count; ++k)
        if (!is_leaf(job.nodes.at[f.node[k]])) job.plans.at[node++].root = f.node[k];
}
