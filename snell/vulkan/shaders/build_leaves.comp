#version 460
// Building a tree: its leaves in the order of the curve, each a cluster of its own.
#include "snell/vulkan/shaders/build.glsl"

void main()
{
    uint i = item_index();
    if (i >= job.count) return;
    uint place = job.places_0.at[i];
    Aabb box = job.boxes.at[place];
    uint kind = kind_block;
    uint index = job.first_triangle + place;
    if (job.instance_count > 0u) {
        kind = kind_instance;
        index = place == job.instance_count ? word_world & child_index_mask : place;
    } else if (place >= job.triangle_count) {
        kind = kind_sphere_block;
        index = job.first_sphere + place - job.triangle_count;
    }
    BuildNode leaf;
    leaf.lower = box.lower;
    leaf.upper = box.upper;
    leaf.left = kind << 30 | index;
    leaf.right = none;
    leaf.below = 1u | 256u << kind;
    job.nodes.at[i] = leaf;
    job.clusters_0.at[i] = i;
}
