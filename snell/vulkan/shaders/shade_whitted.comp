#version 460
// Shade, for Whitted's renderer: light that is found, and up to two continuations, which wait for their places.
#include "snell/vulkan/shaders/stage.glsl"
#include "snell/kernel/whitted.h"

void main()
{
    uint i = gl_GlobalInvocationID.x;
    if (i >= push.count) return;
    PathState state = load_state(i);
    Hit hit = job.hits.at[i];
    SampleSlot lit;
    for (uint layer = 0u; layer < layer_count; ++layer) lit.layers[layer] = vec3(0.0f);
    lit.sees_through = 0u;
    if (!camera_sees(load_ray(i))) {
        job.lit.at[i] = lit;
        job.branch_counts.at[i] = 0u;
        return;
    }
    WhittedStep step = shade_whitted(job.scene, job.params, state, load_ray(i), hit);
    lit.layers[step.layer] = step.emitted;
    job.lit.at[i] = lit;
    note_escape(state, hit);
    // packed: what there is comes first
    CameraPath first = step.next_0;
    if (step.has_next_0 == 0u) first = step.next_1;
    job.branches.at[i].ray_0 = first.ray;
    job.branches.at[i].state_0 = first.state;
    job.branches.at[i].ray_1 = step.next_1.ray;
    job.branches.at[i].state_1 = step.next_1.state;
    job.branch_counts.at[i] = step.has_next_0 + step.has_next_1;
}
