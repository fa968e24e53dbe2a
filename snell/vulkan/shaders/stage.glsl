// What the entry points share: their parameters, and access to the queues.
#include "snell/vulkan/shaders/features.glsl"
#include "snell/vulkan/shaders/job.h"

#extension GL_KHR_shader_subgroup_ballot : require

layout(local_size_x = 64) in; // group_size
layout(push_constant, scalar) uniform Parameters
{
    GpuPush push;
};

#define job push.job.at[0]

Ray load_ray(uint i)
{
    if (push.queue == 0u) return job.rays_0.at[i];
    return job.rays_1.at[i];
}
PathState load_state(uint i)
{
    if (push.queue == 0u) return job.states_0.at[i];
    return job.states_1.at[i];
}
void store_path(uint queue, uint i, Ray ray, PathState state)
{
    if (queue == 0u) {
        job.rays_0.at[i] = ray;
        job.states_0.at[i] = state;
    } else {
        job.rays_1.at[i] = ray;
        job.states_1.at[i] = state;
    }
}

// A place for one more path of the next wave, or connection of this one; one atomic operation for all invocations that
// ask together. The order is any: nothing that a picture shows depends on it.
uint place_of_path()
{
    uvec4 asking = subgroupBallot(true);
    uint place = 0u;
    if (subgroupElect())
        place = atomicAdd(job.counters.at[0].paths[push.wave + 1u], subgroupBallotBitCount(asking));
    return subgroupBroadcastFirst(place) + subgroupBallotExclusiveBitCount(asking);
}
uint place_of_connection()
{
    uvec4 asking = subgroupBallot(true);
    uint place = 0u;
    if (subgroupElect())
        place = atomicAdd(job.counters.at[0].connections[push.wave], subgroupBallotBitCount(asking));
    return subgroupBroadcastFirst(place) + subgroupBallotExclusiveBitCount(asking);
}

void push_path(CameraPath path)
{
    store_path(1u - push.queue, place_of_path(), path.ray, path.state);
}
void push_connection(Connection connection)
{
    job.connections.at[place_of_connection()] = connection;
}

// Notes for the picture's alpha that a camera ray has left a scene whose environment is hidden.
void note_escape(PathState state, Hit hit)
{
    if (is_hit(hit) || state.depth > 0u || job.scene.environment.is_visible != 0u) return;
    job.slots.at[state.slot].sees_through = 1u;
}

// The place in the film of a batch's pixel.
uint film_pixel(uint p)
{
    uint place = push.first_pixel + p;
    uint x = push.x0 + place % push.columns;
    uint y = push.y0 + place / push.columns;
    return (y - job.film.y0) * job.film.columns + (x - job.film.x0);
}

bool is_in_wave(uint i)
{
    return i < job.counters.at[0].paths[push.wave];
}
