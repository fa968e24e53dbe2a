#version 460
// Shade, for the views.
#include "snell/vulkan/shaders/stage.glsl"
#include "snell/kernel/views.h"

void main()
{
    uint i = gl_GlobalInvocationID.x;
    if (!is_in_wave(i) || !camera_sees(load_ray(i))) return;
    uint steps = push.which == view_steps ? job.steps.at[i] : 0u;
    job.slots.at[load_state(i).slot].layers[layer_emission] =
        view_value(job.scene, job.params, push.which, load_ray(i), job.hits.at[i], steps);
}
