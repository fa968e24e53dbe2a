#version 460
// Shade, for Whitted's renderer: one of the connections to lights that each path of the wave has. The vertex is made
// again: kept, it would be the largest thing in memory.
#include "snell/vulkan/shaders/stage.glsl"
#include "snell/kernel/whitted.h"

void main()
{
    uint i = gl_GlobalInvocationID.x;
    if (i >= push.count) return;
    Hit hit = job.hits.at[i];
    if (!is_hit(hit)) return;
    SceneView scene = job.scene;
    RenderParams params = job.params;
    WhittedStep step = shade_whitted(scene, params, load_state(i), load_ray(i), hit);
    if (push.which >= step.light_tasks) return;
    Connection c = whitted_connection(scene, params, step, push.which);
    c.slot = i; // of `lit`: several paths of a wave may belong to one sample
    if (!is_black(c.value)) push_connection(c);
}
