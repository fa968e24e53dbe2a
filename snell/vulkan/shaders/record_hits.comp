#version 460
// The pictures beside the colour: what the first hits of a batch have to tell, and then what is seen in mirrors and
// through glass. `which`: the bounce.
#include "snell/vulkan/shaders/stage.glsl"
#include "snell/kernel/views.h"

void main()
{
    uint i = gl_GlobalInvocationID.x;
    if (!is_in_wave(i)) return;
    SceneView scene = job.scene;
    PathState state = load_state(i);
    Ray ray = load_ray(i);
    Hit hit = job.hits.at[i];
    if (push.which == 0u) {
        GpuFirstHit none_yet;
        none_yet.albedo = vec3(0.0f);
        none_yet.normal = vec3(0.0f);
        none_yet.steps = camera_sees(ray) ? job.steps.at[i] : 0u;
        none_yet.has_hit = is_hit(hit) ? 1u : 0u;
        job.first_hits.at[state.slot] = none_yet;
    }
    if (!is_hit(hit)) return;
    FirstHit first = first_hit(scene, ray, hit);
    if (push.which == 0u) {
        job.first_hits.at[state.slot].geometric_normal = first.geometric_normal;
        job.first_hits.at[state.slot].position = first.position;
        job.first_hits.at[state.slot].uv = first.uv;
        job.first_hits.at[state.slot].depth = first.depth;
        job.first_hits.at[state.slot].object = first.object;
        job.first_hits.at[state.slot].material = first.material;
    }
    if (push.which < look_through_bounces) {
        LookThrough seen = look_through(scene, job.params, state, ray, hit);
        if (seen.ok != 0u) {
            push_path(seen.path);
            return;
        }
    }
    job.first_hits.at[state.slot].albedo = first.albedo;
    job.first_hits.at[state.slot].normal = first.normal;
}
