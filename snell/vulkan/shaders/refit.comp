#version 460
// Refit: the nodes of one level, `count` of them, after those below. Corners are read anew, and boxes and orders made
// anew; see snell/bvh/refit.h, to whose bits this comes. `first`: of the nodes in the order of levels; `to`: of the
// workgroups in `costs`. `which` 1: the order is that of memory; 2: the tree's one leaf, or root, gives the box of all.
#include "snell/vulkan/shaders/build.glsl"
#include "snell/vulkan/shaders/scan.glsl"
#include "snell/vulkan/shaders/wide.glsl"

// What corner of which triangle is where in a block, if that has changed: the vertices are the same, in other places.
struct Numbers
{
    uint at[16];
};
Numbers number_corners(uint at)
{
    Numbers numbers;
    uint used = 0u;
    uvec3 corners = uvec3(0u);
    for (uint lane = 0u; lane < 8u; ++lane) {
        Triangle tri = job.triangles.at[job.out_lines.at[at + 4u + lane]];
        uvec3 vertices = uvec3(tri.v0, tri.v1, tri.v2);
        for (int v = 0; v < 3; ++v) {
            uint place = 0u;
            while (place < used && numbers.at[place] != vertices[v]) ++place;
            if (place == used) numbers.at[used++] = vertices[v];
            corners[v] |= place << (4u * lane);
        }
    }
    for (uint i = used; i < 16u; ++i) numbers.at[i] = numbers.at[0];
    for (int v = 0; v < 3; ++v) job.out_lines.at[at + uint(v)] = corners[v];
    return numbers;
}

Aabb refill_block(uint at, uint capacity)
{
    Numbers numbers;
    for (uint i = 0u; i < 16u; ++i) numbers.at[i] = none;
    bool agree = true;
    uvec3 corners = uvec3(job.out_lines.at[at], job.out_lines.at[at + 1u], job.out_lines.at[at + 2u]);
    for (uint lane = 0u; lane < 8u; ++lane) {
        Triangle tri = job.triangles.at[job.out_lines.at[at + 4u + lane]];
        uvec3 vertices = uvec3(tri.v0, tri.v1, tri.v2);
        for (int v = 0; v < 3; ++v) {
            uint place = corners[v] >> (4u * lane) & 15u;
            if (numbers.at[place] != none && numbers.at[place] != vertices[v]) agree = false;
            numbers.at[place] = vertices[v];
        }
    }
    if (!agree) numbers = number_corners(at);
    Aabb box = empty_aabb();
    for (uint i = 0u; i < capacity; ++i) {
        uint number = numbers.at[i] != none ? numbers.at[i] : numbers.at[0];
        vec3 p = job.positions.at[number];
        bool seen = is_finite3(p);
        if (seen) {
            box.lower = min(box.lower, p);
            box.upper = max(box.upper, p);
        }
        for (int axis = 0; axis < 3; ++axis)
            job.out_lines.at[at + 12u + capacity * uint(axis) + i] = seen ? floatBitsToUint(p[axis]) : 0x7fc00000u;
    }
    box.lower = plain_zero(box.lower);
    box.upper = plain_zero(box.upper);
    return box;
}

// blocks: how many the leaf has.
Aabb refit_leaf(uint word, out uint blocks)
{
    Aabb box = empty_aabb();
    uint index = word & child_index_mask;
    blocks = 0u;
    if (word >> 30 == kind_block) {
        uint more = 1u;
        while (more != 0u) {
            uint at = index * 16u;
            uint sizes = job.out_lines.at[at + 3u]; // count, capacity, lanes, more
            uint capacity = sizes >> 8 & 255u;
            more = sizes >> 24;
            box = join(box, refill_block(at, capacity));
            blocks += 1u;
            index += capacity == 12u ? 3u : 4u;
        }
        return box;
    }
    for (uint lane = 0u; lane < 8u; ++lane) {
        uint id = job.out_spheres.at[8u * index + lane];
        if (id == none) break;
        Sphere ball = job.spheres.at[id];
        box = join(box, sphere_bounds(ball.center, ball.radius));
    }
    blocks = 1u;
    return box;
}

float refit_node(uint node, float scale)
{
    ChildBoxes boxes;
    Aabb all = empty_aabb();
    float cost = 0.0f;
    for (uint slot = 0u; slot < node_width(); ++slot) {
        boxes.at[slot] = empty_aabb();
        uint word = job.out_nodes.at[first_child_word(node) + slot];
        if (word == job.no_child) continue;
        float visit = node_cost;
        if (word >> 30 == kind_node) {
            boxes.at[slot] = job.boxes.at[word];
        } else {
            uint blocks;
            boxes.at[slot] = refit_leaf(word, blocks);
            visit = block_cost * float(blocks);
        }
        all = join(all, boxes.at[slot]);
        cost += half_area(boxes.at[slot], scale) * visit;
    }
    job.boxes.at[node] = all;
    write_boxes(node, boxes);
    return cost;
}

void main()
{
    uint i = item_index();
    if (push.which == 2u) {
        if (i != 0u) return;
        uint root = job.tree.root;
        Aabb box = empty_aabb();
        if (root >> 30 == kind_node) {
            box = job.boxes.at[root];
        } else {
            uint blocks;
            box = refit_leaf(root, blocks);
            job.costs.at[0] = floatBitsToUint(block_cost * float(blocks));
        }
        set_box_of_all(box);
        return;
    }
    float cost = 0.0f;
    if (i < push.count) {
        Aabb before = {job.tree.lower, job.tree.upper};
        uint at = push.first + i;
        cost = refit_node(push.which == 1u ? at : job.order.at[at], scale_for(before));
    }
    float sum = sum_of_group(cost);
    if (gl_LocalInvocationIndex == 0u && i < push.count) job.costs.at[push.to + group_index()] = floatBitsToUint(sum);
}
