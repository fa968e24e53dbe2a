#version 460
// Connect: light that nothing blocks is added to its sample.
#include "snell/vulkan/shaders/stage.glsl"
#include "snell/vulkan/shaders/trace.glsl"

void main()
{
    uint i = gl_GlobalInvocationID.x;
    if (i >= job.counters.at[0].connections[push.wave]) return;
    SceneView scene = job.scene;
    Connection c = job.connections.at[i];
    if (is_blocked(scene, c.ray, c.seed)) return;
    // Nobody else adds to this slot in this wave: a path makes one connection, and Whitted's has slots of its own.
    if (push.which == 0u)
        job.slots.at[c.slot].layers[c.layer] += c.value;
    else
        job.lit.at[c.slot].layers[c.layer] += c.value;
}
