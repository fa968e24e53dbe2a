#version 460
// Extend: the nearest hits of the paths of a wave.
#include "snell/vulkan/shaders/stage.glsl"
#include "snell/vulkan/shaders/trace.glsl"

void main()
{
    uint i = gl_GlobalInvocationID.x;
    if (!is_in_wave(i)) return;
    uint steps = 0u;
    SceneView scene = job.scene;
    job.hits.at[i] = trace_covered(scene, load_ray(i), extension_seed(load_state(i)), push.from_camera != 0u, steps);
    if (counts_steps != 0u) job.steps.at[i] = steps;
}
