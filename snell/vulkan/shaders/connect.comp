#version 460
// Connect: light that nothing blocks is added to its sample.
#include "snell/vulkan/shaders/stage.glsl"
#include "snell/vulkan/shaders/trace.glsl"

layout(constant_id = 6) const uint takes_blocks = 0u; // 1: the workgroups fetch connections until there are no more

shared uint taken;

uint take_block()
{
    if (gl_LocalInvocationIndex == 0u) taken = atomicAdd(job.counters.at[0].connections_taken[push.wave], group_size);
    barrier();
    uint first = taken;
    barrier(); // before the next one is taken
    return first;
}

void connect(uint i)
{
    SceneView scene = job.scene;
    Connection c = job.connections.at[i];
    if (is_blocked(scene, c.ray, c.seed)) return;
    // Nobody else adds to this slot in this wave: a path makes one connection, and Whitted's has slots of its own.
    if (push.which == 0u)
        job.slots.at[c.slot].layers[c.layer] += c.value;
    else
        job.lit.at[c.slot].layers[c.layer] += c.value;
}

void main()
{
    uint count = job.counters.at[0].connections[push.wave];
    uint first = takes_blocks != 0u ? take_block() : gl_WorkGroupID.x * group_size;
    while (first < count) {
        uint i = first + gl_LocalInvocationIndex;
        if (i < count) connect(i);
        if (takes_blocks == 0u) break;
        first = take_block();
    }
}
