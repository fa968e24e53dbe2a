#version 460
// Wide nodes: the root, or the leaf that a small tree is.
#include "snell/vulkan/shaders/collapse.glsl"

void main()
{
    if (item_index() != 0u) return;
    counters.root = word_done;
    counters.wide = 0u;
    counters.lines = 0u;
    counters.spheres = 0u;
    counters.leaves = 0u;
    if (!is_empty(box_of_all())) {
        uint top = 2u * job.count - 2u;
        BuildNode root = job.nodes.at[top];
        if (!is_leaf(root)) {
            counters.root = 0u;
            counters.wide = 1u;
            job.plans.at[0].root = top;
        } else {
            uint kind = kind_below(root);
            counters.leaves = 1u;
            counters.root = kind == kind_instance ? root.left : kind << 30;
            if (kind == kind_block) counters.lines = lines_of_block;
            if (kind == kind_sphere_block) counters.spheres = 1u;
        }
    }
    counters.level_begin[0] = 0u;
    counters.level_begin[1] = counters.wide;
    counters.level_groups[0] = counters.wide;
}
