#version 460
// Shade, for path tracing.
#include "snell/vulkan/shaders/stage.glsl"
#include "snell/kernel/path.h"

layout(constant_id = 1) const uint is_sorted = 0u; // 1: paths come by the list that sort_place has made

void main()
{
    uint i = gl_GlobalInvocationID.x;
    if (!is_in_wave(i)) return;
    if (is_sorted != 0u) i = job.sorted.at[i];
    if (!camera_sees(load_ray(i))) return;
    PathState state = load_state(i);
    Hit hit = job.hits.at[i];
    PathStep step = shade_path(job.scene, job.params, state, load_ray(i), hit);
    job.slots.at[state.slot].layers[step.layer] += step.emitted;
    note_escape(state, hit);
    if (step.has_connection != 0u) push_connection(step.connection);
    if (step.has_next != 0u) push_path(step.next);
}
