#version 460
// Wide nodes: they are written, and the blocks of their leaves. `count`: how many there are; none: the tree is one leaf.
#include "snell/vulkan/shaders/collapse.glsl"
#include "snell/vulkan/shaders/scan.glsl"

// The primitives of a leaf, as child words.
struct Few
{
    uint at[4];
    uint count;
};
Few primitives_of(uint leaf)
{
    Few few;
    few.count = 0u;
    uint waiting[4];
    uint top = 1u;
    waiting[0] = leaf;
    while (top > 0u) {
        BuildNode node = job.nodes.at[waiting[--top]];
        if (node.right == none) {
            few.at[few.count++] = node.left;
        } else {
            waiting[top++] = node.right;
            waiting[top++] = node.left;
        }
    }
    return few;
}

// A TriangleBlock of snell/bvh/triangle_block.h. Lanes that are not used repeat the first triangle.
void write_block(uint line, uint leaf)
{
    Few few = primitives_of(leaf);
    uint at = line * 16u;
    uvec3 corners = uvec3(0u);
    for (uint lane = 0u; lane < 8u; ++lane) {
        uint first = lane < few.count ? 3u * lane : 0u;
        corners |= uvec3(first, first + 1u, first + 2u) << uvec3(4u * lane);
        job.out_lines.at[at + 4u + lane] = few.at[lane < few.count ? lane : 0u] & child_index_mask;
    }
    for (uint v = 0u; v < 3u; ++v) job.out_lines.at[at + v] = corners[v];
    job.out_lines.at[at + 3u] = few.count | 12u << 8 | ((1u << few.count) - 1u) << 16;
    for (uint i = 0u; i < 12u; ++i) {
        uint lane = i / 3u < few.count ? i / 3u : 0u;
        Triangle tri = job.triangles.at[few.at[lane] & child_index_mask];
        vec3 p = job.positions.at[i % 3u == 0u ? tri.v0 : i % 3u == 1u ? tri.v1 : tri.v2];
        for (int axis = 0; axis < 3; ++axis)
            job.out_lines.at[at + 12u + 12u * uint(axis) + i] = floatBitsToUint(p[axis]);
    }
}

void write_spheres(uint block, uint leaf)
{
    Few few = primitives_of(leaf);
    for (uint lane = 0u; lane < 8u; ++lane)
        job.out_spheres.at[8u * block + lane] = lane < few.count ? few.at[lane] & child_index_mask : none;
}

// Returns what the node adds to the tree's cost.
float write_node(uint i, float scale)
{
    WidePlan plan = job.plans.at[i];
    Family f = children_of(plan.root);
    ChildBoxes boxes;
    float cost = 0.0f;
    for (uint slot = 0u; slot < node_width(); ++slot) {
        boxes.at[slot] = empty_aabb();
        uint word = job.no_child;
        if (slot < f.count) {
            uint id = f.node[slot];
            BuildNode child = job.nodes.at[id];
            boxes.at[slot].lower = child.lower;
            boxes.at[slot].upper = child.upper;
            float visit = block_cost;
            if (!is_leaf(child)) {
                word = plan.node++;
                visit = node_cost;
            } else if (kind_below(child) == kind_block) {
                word = kind_block << 30 | plan.line;
                write_block(plan.line, id);
                plan.line += lines_of_block;
            } else if (kind_below(child) == kind_sphere_block) {
                word = kind_sphere_block << 30 | plan.sphere;
                write_spheres(plan.sphere, id);
                plan.sphere += 1u;
            } else {
                word = child.left;
                visit = node_cost + job.cost_below;
            }
            cost += half_area(boxes.at[slot], scale) * visit;
        }
        job.out_nodes.at[first_child_word(i) + slot] = word;
    }
    write_boxes(i, boxes);
    return cost;
}

void main()
{
    uint i = item_index();
    float cost = 0.0f;
    if (i < push.count) cost = write_node(i, scale_for(box_of_all()));
    if (push.count == 0u && i == 0u) {
        uint top = 2u * job.count - 2u;
        if (counters.lines > 0u) write_block(0u, top);
        if (counters.spheres > 0u) write_spheres(0u, top);
        cost = block_cost;
    }
    float sum = sum_of_group(cost);
    if (gl_LocalInvocationIndex == 0u && i < max(push.count, 1u)) job.costs.at[group_index()] = floatBitsToUint(sum);
}
