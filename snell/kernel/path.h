// The path tracer's shade stage (Kajiya 1986): next event estimation, multiple importance sampling with the power
// heuristic (Veach 1997) and Russian roulette, each of which can be switched off.
#ifndef SNELL_KERNEL_PATH_H
#define SNELL_KERNEL_PATH_H
#include "snell/kernel/environment.h"
#include "snell/kernel/mis.h"
#include "snell/kernel/record.h"
SNELL_BEGIN

struct PathStep
{
    vec3 emitted; // to add to the sample at once
    uint layer;   // layer_* of it
    Connection connection;
    CameraPath next;
    uint has_connection; // 0: connection means nothing
    uint has_next;       // 0: the path ends
};

SNELL_FN uint scatter_layer(uint bounces)
{
    return min(bounces, layer_indirect);
}

// What a path sees that has left the scene.
SNELL_FN vec3 escaped_radiance(SNELL_IN(SceneView) scene, SNELL_IN(RenderParams) params, uint depth, vec3 direction)
{
    if ((params.flags & render_furnace) != 0u) return vec3(1.0f);
    if (depth == 0u && scene.environment.is_visible == 0u) return vec3(0.0f);
    return environment_radiance(scene, direction);
}

// Probability of sampling the environment instead of a light. A constant environment is better found by BSDF sampling
// alone; only where that does not count (light sampling without MIS) is it sampled.
SNELL_FN float environment_probability(SNELL_IN(SceneView) scene, SNELL_IN(RenderParams) params)
{
    bool is_furnace = (params.flags & render_furnace) != 0u;
    if (!is_furnace && is_black(scene.environment.radiance)) return 0.0f;
    if (!is_furnace && scene.environment.columns > 0u) return scene.environment.select_pdf;
    if ((params.flags & render_mis) != 0u) return 0.0f;
    return scene.light_count > 0u && !is_furnace ? 0.5f : 1.0f;
}

// Density per steradian of the environment's directions in next event estimation, its choice included.
SNELL_FN float escaped_pdf(SNELL_IN(SceneView) scene, SNELL_IN(RenderParams) params, vec3 direction)
{
    float p = environment_probability(scene, params);
    if (p == 0.0f) return 0.0f;
    return p * ((params.flags & render_furnace) != 0u ? pdf_uniform_sphere() : pdf_environment(scene, direction));
}

// Weight of light that a BSDF sample found. pdf_light_sampling: with which light sampling would have found it.
SNELL_FN float bsdf_sampling_weight(SNELL_IN(RenderParams) params, float pdf_bsdf_sampling, float pdf_light_sampling)
{
    if (pdf_bsdf_sampling == 0.0f || (params.flags & render_nee) == 0u) return 1.0f;
    if ((params.flags & render_mis) == 0u) return 0.0f;
    return power_heuristic(pdf_bsdf_sampling, pdf_light_sampling);
}

// Next event estimation at a vertex.
SNELL_FN LightSample sample_direct(SNELL_IN(SceneView) scene, SNELL_IN(RenderParams) params, SampleKey key,
                                   SNELL_IN(PathState) state, vec3 point SNELL_RECORD_PARAMETER)
{
    float p_environment = environment_probability(scene, params);
    bool has_lights = scene.light_count > 0u && (params.flags & render_furnace) == 0u;
    if (!has_lights && p_environment == 0.0f) return no_light_sample();
    vec2 u = random_2d(key, vertex_dimension(state.depth, dimension_light));
    float select = 0.0f;
    if (scene.light_count > 1u || p_environment > 0.0f)
        select = random_1d(key, vertex_dimension(state.depth, dimension_select));

    LightSample s;
    SNELL_NOTE(has_light, 1u);
    if (select < p_environment || !has_lights) {
        if ((params.flags & render_furnace) != 0u) {
            s = no_light_sample();
            s.direction = sample_uniform_sphere(u);
            s.radiance = vec3(1.0f);
            s.pdf = pdf_uniform_sphere();
            s.is_infinite = 1u;
        } else {
            s = sample_environment(scene, u);
        }
        s.pdf *= p_environment;
    } else {
        uint i = select_light(scene, min((select - p_environment) / (1.0f - p_environment), 0.99999994f));
        Light light = scene.lights.at[i];
        SNELL_NOTE(light_index, i);
        s = sample_light(light, point, u);
        if ((light.flags & light_textured) != 0u) s.radiance = s.radiance * light_texture(scene, light, u, s.target);
        s.pdf *= light.select_pdf * (1.0f - p_environment);
    }
    SNELL_NOTE(light, s);
    return s;
}

SNELL_FN PathStep shade_path(SNELL_IN(SceneView) scene, SNELL_IN(RenderParams) params, SNELL_IN(PathState) arriving,
                             SNELL_IN(Ray) ray, SNELL_IN(Hit) hit SNELL_RECORD_PARAMETER)
{
    PathStep step;
    step.emitted = vec3(0.0f);
    step.layer = scatter_layer(arriving.depth);
    step.has_connection = 0u;
    step.has_next = 0u;
    PathState state = arriving;

    if (!is_hit(hit)) {
        float p = state.pdf > 0.0f ? escaped_pdf(scene, params, ray.direction) : 0.0f;
        float weight = p > 0.0f ? bsdf_sampling_weight(params, state.pdf, p) : 1.0f;
        step.emitted = state.throughput * escaped_radiance(scene, params, state.depth, ray.direction) * weight;
        SNELL_NOTE(emission, escaped_radiance(scene, params, state.depth, ray.direction));
        SNELL_NOTE(emission_pdf, p);
        SNELL_NOTE(emission_weight, weight);
        SNELL_NOTE(state, state);
        SNELL_NOTE(ending, ending_escaped);
        return step;
    }
    if (state.medium != none) state.throughput = state.throughput * medium_transmittance(scene, state.medium, hit.t);

    Vertex v = make_vertex(scene, ray, hit);
    SNELL_NOTE(has_vertex, 1u);
    SNELL_NOTE(vertex, v);
    SNELL_NOTE(state, state);
    if (!is_black(v.emission) && (params.flags & render_furnace) == 0u) {
        float pdf = 0.0f;
        if (state.pdf > 0.0f && v.surface.light != none) {
            Light light = scene.lights.at[v.surface.light];
            pdf = light.select_pdf * pdf_light(light, ray.origin, v.surface.position, v.surface.geometric_normal) *
                  (1.0f - environment_probability(scene, params)); // as sample_direct chooses
        }
        // an emitter that light sampling never draws is found by BSDF sampling alone
        float weight = pdf > 0.0f ? bsdf_sampling_weight(params, state.pdf, pdf) : 1.0f;
        step.emitted = state.throughput * v.emission * weight;
        SNELL_NOTE(emission, v.emission);
        SNELL_NOTE(emission_pdf, pdf);
        SNELL_NOTE(emission_weight, weight);
    }
    SNELL_NOTE(ending, ending_depth);
    if (state.depth >= params.max_depth) return step;
    if (may_have(feature_dispersion) && is_material(v.material.kind, material_principled)) {
        float dispersion = scene.principled.at[scene.materials.at[v.surface.material].principled].dispersion;
        if (dispersion > 0.0f) { // on copies: see make_vertex
            PathState one_color = state;
            Vertex dispersed = v;
            disperse(scene, dispersion, one_color, dispersed);
            state = one_color;
            v = dispersed;
            SNELL_NOTE(vertex, v);
            SNELL_NOTE(state, state);
        }
    }

    SampleKey key = state_key(params, state);
    if ((params.flags & render_nee) != 0u && has_smooth_part(v.material)) {
        LightSample light = sample_direct(scene, params, key, state, v.surface.position SNELL_RECORD_ARGUMENT);
        if (light.pdf > 0.0f) {
            vec3 f = vertex_eval(v, light.direction);
            if (!is_black(f)) {
                float weight = 1.0f;
                if (light.is_delta == 0u && (params.flags & render_mis) != 0u) {
                    float pdf = pdf_bsdf(v.material, v.wo, to_local(v.frame, light.direction));
                    SNELL_NOTE(light_bsdf_pdf, pdf);
                    weight = power_heuristic(light.pdf, pdf);
                }
                SNELL_NOTE(light_bsdf, f);
                SNELL_NOTE(light_weight, weight);
                step.connection.ray = shadow_ray(v.surface, light);
                step.connection.value = state.throughput * f * light.radiance * (weight / light.pdf) *
                                        light_transmittance(scene, state.medium, v, light);
                step.connection.slot = state.slot;
                step.connection.layer = scatter_layer(state.depth + 1u);
                step.connection.seed = connection_seed(state);
                step.has_connection = 1u;
            }
        }
    }

    vec2 u = random_2d(key, vertex_dimension(state.depth, dimension_bsdf));
    vec2 u_lobe = vec2(0.0f, 0.0f);
    if (v.material.kind != material_diffuse) u_lobe = random_2d(key, vertex_dimension(state.depth, dimension_lobe));
    BsdfSample s = sample_bsdf(v.material, v.wo, u, u_lobe.x);
    SNELL_NOTE(bsdf_0, s);
    SNELL_NOTE(event_0, scattering_event(v.material, v.wo, s, u_lobe.x));
    SNELL_NOTE(ending, ending_absorbed);
    if (s.pdf == 0.0f || is_black(s.weight)) return step;
    step.next = scatter(scene, state, v, s);
    SNELL_NOTE(ending, ending_leak);
    // the same rule as in vertex_eval
    if (s.wi.z * dot(v.surface.geometric_normal, step.next.ray.direction) <= 0.0f) return step;

    SNELL_NOTE(ending, ending_roulette);
    if ((params.flags & render_roulette) != 0u && state.depth >= 1u) {
        float survival = max3(step.next.state.throughput) * step.next.state.eta_scale;
        if (survival < 1.0f) {
            if (v.material.kind == material_diffuse)
                u_lobe = random_2d(key, vertex_dimension(state.depth, dimension_lobe));
            SNELL_NOTE(survival, survival);
            if (u_lobe.y >= survival) return step;
            step.next.state.throughput = step.next.state.throughput / survival;
        }
    }
    SNELL_NOTE(ending, ending_none);
    step.has_next = 1u;
    return step;
}

SNELL_END
#endif
