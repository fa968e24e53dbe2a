#version 460
// Extend: the nearest hits of the paths of a wave.
#include "snell/vulkan/shaders/stage.glsl"
#include "snell/vulkan/shaders/trace.glsl"

layout(constant_id = 6) const uint takes_blocks = 0u; // 1: the workgroups fetch rays until there are no more

shared uint taken;

uint take_block()
{
    if (gl_LocalInvocationIndex == 0u) taken = atomicAdd(job.counters.at[0].paths_taken[push.wave], group_size);
    barrier();
    uint first = taken;
    barrier(); // before the next one is taken
    return first;
}

void main()
{
    uint count = job.counters.at[0].paths[push.wave];
    uint first = takes_blocks != 0u ? take_block() : gl_WorkGroupID.x * group_size;
    while (first < count) {
        uint i = first + gl_LocalInvocationIndex;
        if (i < count) {
            uint steps = 0u;
            SceneView scene = job.scene;
            bool from_camera = push.from_camera != 0u;
            job.hits.at[i] = trace_covered(scene, load_ray(i), extension_seed(load_state(i)), from_camera, steps);
            if (counts_steps != 0u) job.steps.at[i] = steps;
        }
        if (takes_blocks == 0u) break;
        first = take_block();
    }
}
