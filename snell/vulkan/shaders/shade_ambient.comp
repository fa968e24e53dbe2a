#version 460
// Shade, for ambient occlusion.
#include "snell/vulkan/shaders/stage.glsl"
#include "snell/kernel/views.h"

void main()
{
    uint i = gl_GlobalInvocationID.x;
    if (!is_in_wave(i) || !camera_sees(load_ray(i))) return;
    PathState state = load_state(i);
    Hit hit = job.hits.at[i];
    if (!is_hit(hit)) {
        job.slots.at[state.slot].layers[layer_emission] += vec3(1.0f);
        return;
    }
    Connection c = ambient_connection(job.scene, job.params, state, load_ray(i), hit);
    if (!is_black(c.value)) push_connection(c);
}
