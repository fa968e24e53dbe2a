// Wide nodes of a binary tree, and how they lie in memory: snell/bvh/node.h.
#include "snell/kernel/wide_boxes.h"

layout(constant_id = 0) const uint tree_layout = 1u; // layout_*

// What a visit costs: wide_node_cost and wide_block_cost of snell/bvh/wide.h.
const float node_cost = 1.0f;
const float block_cost = 3.2f;

uint node_width() { return tree_layout == layout_quantised ? 8u : 2u; }
uint first_child_word(uint node) { return tree_layout == layout_quantised ? node * 32u + 18u : node * 16u + 12u; }

// Writes the boxes of a node's children and their orders.
void write_boxes(uint node, ChildBoxes boxes)
{
    if (tree_layout == layout_quantised) {
        uint at = node * 32u;
        QuantisedBoxes q = quantise_boxes(boxes);
        for (int axis = 0; axis < 3; ++axis) {
            job.out_nodes.at[at + uint(axis)] = floatBitsToUint(q.origin[axis]);
            job.out_nodes.at[at + 3u + uint(axis)] = floatBitsToUint(q.scale[axis]);
        }
        for (uint i = 0u; i < 12u; ++i) job.out_nodes.at[at + 6u + i] = q.planes[i];
        uint words[6];
        for (uint i = 0u; i < 6u; ++i) words[i] = 0u;
        for (uint octant = 0u; octant < 8u; ++octant) {
            uint order = order_child_boxes(boxes, 8u, octant);
            uint bit = 24u * octant;
            uint shift = bit & 31u;
            words[bit >> 5] |= order << shift;
            if (shift > 8u) words[(bit >> 5) + 1u] |= order >> (32u - shift);
        }
        for (uint i = 0u; i < 6u; ++i) job.out_nodes.at[at + 26u + i] = words[i];
        return;
    }
    uint at = node * 16u;
    for (uint slot = 0u; slot < 2u; ++slot)
        for (int axis = 0; axis < 3; ++axis) {
            job.out_nodes.at[at + 4u * uint(axis) + slot] = floatBitsToUint(boxes.at[slot].lower[axis]);
            job.out_nodes.at[at + 4u * uint(axis) + 2u + slot] = floatBitsToUint(boxes.at[slot].upper[axis]);
        }
    for (uint half_word = 0u; half_word < 2u; ++half_word) {
        uint word = 0u;
        for (uint i = 0u; i < 4u; ++i) word |= order_child_boxes(boxes, 2u, 4u * half_word + i) << (8u * i);
        job.out_nodes.at[at + 14u + half_word] = word;
    }
}
