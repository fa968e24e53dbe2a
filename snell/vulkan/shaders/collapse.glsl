// Which nodes of the binary tree become the children of a wide one: the largest are opened until all slots are taken.
#include "snell/vulkan/shaders/build.glsl"
#include "snell/vulkan/shaders/wide.glsl"

// Few primitives of one kind. An instance is alone.
bool is_leaf(BuildNode node)
{
    if (node.right == none) return true;
    uint kinds = node.below >> 8;
    return (node.below & 255u) <= leaf_most && (kinds & (kinds - 1u)) == 0u && kinds != 1u << kind_instance;
}
uint kind_below(BuildNode leaf) { return uint(findLSB(leaf.below >> 8)); }

struct Family
{
    uint node[8]; // of the binary tree, the smallest first
    uint count;
};

Family children_of(uint root)
{
    float scale = scale_for(box_of_all());
    Family f;
    float area[8]; // < 0: not to be opened
    f.count = 2u;
    f.node[0] = job.nodes.at[root].left;
    f.node[1] = job.nodes.at[root].right;
    float size[8];
    for (uint i = 0u; i < 2u; ++i) {
        BuildNode child = job.nodes.at[f.node[i]];
        Aabb box = {child.lower, child.upper};
        size[i] = half_area(box, scale);
        area[i] = is_leaf(child) ? -1.0f : size[i];
    }
    while (f.count < node_width()) {
        uint largest = 0u;
        for (uint i = 1u; i < f.count; ++i)
            if (area[i] > area[largest]) largest = i;
        if (area[largest] < 0.0f) break;
        BuildNode opened = job.nodes.at[f.node[largest]];
        for (uint side = 0u; side < 2u; ++side) {
            uint id = side == 0u ? opened.left : opened.right;
            uint place = side == 0u ? largest : f.count++;
            BuildNode child = job.nodes.at[id];
            Aabb box = {child.lower, child.upper};
            f.node[place] = id;
            size[place] = half_area(box, scale);
            area[place] = is_leaf(child) ? -1.0f : size[place];
        }
    }
    // Rays that look for any hit begin with the last slot: the largest child blocks most.
    for (uint i = 1u; i < f.count; ++i)
        for (uint k = i; k > 0u && size[k] < size[k - 1u]; --k) {
            float s = size[k];
            size[k] = size[k - 1u];
            size[k - 1u] = s;
            uint n = f.node[k];
            f.node[k] = f.node[k - 1u];
            f.node[k - 1u] = n;
        }
    return f;
}
