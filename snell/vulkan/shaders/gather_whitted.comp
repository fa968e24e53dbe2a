#version 460
// Whitted's renderer: what the paths of one sample have found is added up, by the first of them. They lie side by side
// and in the same order in every run, so sums are the same to the bit.
#include "snell/vulkan/shaders/stage.glsl"

void main()
{
    uint i = gl_GlobalInvocationID.x;
    if (i >= push.count) return;
    uint slot = load_state(i).slot;
    if (i > 0u && load_state(i - 1u).slot == slot) return;
    for (uint k = i; k < push.count && load_state(k).slot == slot; ++k)
        for (uint layer = 0u; layer < layer_count; ++layer)
            job.slots.at[slot].layers[layer] += job.lit.at[k].layers[layer];
}
