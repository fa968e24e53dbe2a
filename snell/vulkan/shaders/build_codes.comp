#version 460
// Building a tree: where the primitives lie on a Morton curve of 10 bits an axis, by cubic cells. What has no box (it is
// not finite) gets a point: it stays in the tree, where nothing hits it, and a refit finds it again once it is finite.
#include "snell/vulkan/shaders/build.glsl"

// Two zeros between the bits.
uint spread_bits(uint x)
{
    x = (x | x << 16) & 0x030000ffu;
    x = (x | x << 8) & 0x0300f00fu;
    x = (x | x << 4) & 0x030c30c3u;
    return (x | x << 2) & 0x09249249u;
}

void main()
{
    uint i = item_index();
    if (i >= job.count) return;
    Aabb all = box_of_all();
    Aabb box = job.boxes.at[i];
    uint code = 0u;
    if (is_empty(all)) {
        all.lower = vec3(0.0f);
        all.upper = vec3(0.0f);
    }
    if (is_empty(box)) {
        box.lower = all.lower;
        box.upper = all.lower;
        job.boxes.at[i] = box;
    }
    float size = max3(0.5f * all.upper - 0.5f * all.lower); // halves and quarters: nothing overflows
    if (size > 0.0f) {
        vec3 at = (0.25f * box.lower + 0.25f * box.upper - 0.5f * all.lower) / size;
        uvec3 cell = uvec3(clamp(at * 1024.0f, vec3(0.0f), vec3(1023.0f)));
        code = spread_bits(cell.x) << 2 | spread_bits(cell.y) << 1 | spread_bits(cell.z);
    }
    job.codes_0.at[i] = code;
    job.places_0.at[i] = i;
}
