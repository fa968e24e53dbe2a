// Whitted's renderer (1980) as a shade stage: direct light at every surface, and rays in the directions of perfect
// reflection and refraction, both of them at a dielectric. What Whitted did not have is estimated with one ray, so that
// the picture converges to direct light plus specular transport: a random point on an area light, a random direction
// for the environment, a random direction for a rough reflection.
#ifndef SNELL_KERNEL_WHITTED_H
#define SNELL_KERNEL_WHITTED_H
#include "snell/kernel/path.h"
SNELL_BEGIN

// A ray whose throughput has fallen below this is not followed. Since reflected and refracted parts add up to no more
// than 1, it also bounds the number of rays alive a sample by 1 / whitted_cutoff.
SNELL_CONST float whitted_cutoff = 1.0f / 256.0f;

// Inside glass radiance is scaled by 1 / eta^2 until it comes out again: that is no loss.
SNELL_FN bool is_worth_following(PathState state)
{
    return max3(state.throughput) * state.eta_scale > whitted_cutoff;
}

// The lobes that are followed of a principled surface.
SNELL_FN_COLD PrincipledPoint without_diffuse(PrincipledPoint point)
{
    PrincipledPoint p = point;
    p.diffuse = vec3(0.0f);
    p.diffuse_through = vec3(0.0f);
    p.sheen = vec3(0.0f);
    p.p_diffuse = 0.0f;
    p.p_through = 0.0f;
    p.p_sheen = 0.0f;
    float rest = p.p_coat + p.p_facets + p.p_straight;
    float scale = rest > 0.0f ? 1.0f / rest : 0.0f;
    p.p_coat = p.p_coat * scale;
    p.p_facets = p.p_facets * scale;
    p.p_straight = p.p_straight * scale;
    return p;
}

struct WhittedStep
{
    vec3 emitted;
    uint layer;
    Vertex vertex;
    PathState state;   // with the absorption on the way taken into account
    uint light_tasks;  // number of connections to ask whitted_connection for
    CameraPath next_0; // reflection, or the only continuation
    CameraPath next_1; // refraction
    uint has_next_0, has_next_1;
};

SNELL_FN WhittedStep shade_whitted(SNELL_IN(SceneView) scene, SNELL_IN(RenderParams) params,
                                   SNELL_IN(PathState) arriving, SNELL_IN(Ray) ray,
                                   SNELL_IN(Hit) hit SNELL_RECORD_PARAMETER)
{
    WhittedStep step;
    step.emitted = vec3(0.0f);
    step.layer = scatter_layer(arriving.depth);
    step.state = arriving;
    step.light_tasks = 0u;
    step.has_next_0 = 0u;
    step.has_next_1 = 0u;
    // after a rough bounce the lights have been sampled there
    bool counts_emission = arriving.pdf == 0.0f;
    SNELL_NOTE(state, arriving);
    SNELL_NOTE(emission_weight, counts_emission ? 1.0f : 0.0f);
    if (!is_hit(hit)) {
        if (counts_emission)
            step.emitted = arriving.throughput * escaped_radiance(scene, params, arriving.depth, ray.direction);
        SNELL_NOTE(emission, escaped_radiance(scene, params, arriving.depth, ray.direction));
        SNELL_NOTE(ending, ending_escaped);
        return step;
    }
    if (arriving.medium != none)
        step.state.throughput = arriving.throughput * medium_transmittance(scene, arriving.medium, hit.t);
    Vertex v = make_vertex(scene, ray, hit);
    step.vertex = v;
    SNELL_NOTE(has_vertex, 1u);
    SNELL_NOTE(vertex, v);
    SNELL_NOTE(state, step.state);
    SNELL_NOTE(emission, v.emission);
    if (counts_emission) step.emitted = step.state.throughput * v.emission;

    if (has_smooth_part(v.material)) {
        step.light_tasks = scene.delta_light_count;
        if (scene.light_count > scene.delta_light_count) step.light_tasks += 1u;
        if (!is_black(scene.environment.radiance)) step.light_tasks += 1u;
    }
    SNELL_NOTE(ending, arriving.depth >= params.max_depth ? ending_depth : ending_direct);
    if (arriving.depth >= params.max_depth || v.material.kind == material_diffuse || v.wo.z == 0.0f) return step;

    SampleKey key = state_key(params, step.state);
    if (is_material(v.material.kind, material_dielectric) && v.material.alpha == 0.0f) {
        // sample_smooth_dielectric reflects for u = 0 and refracts for the largest u; take both, with their weights
        BsdfSample s0 = sample_smooth_dielectric(v.material, v.wo, 0.0f);
        s0.weight = s0.weight * s0.pdf;
        SNELL_NOTE(bsdf_0, s0);
        SNELL_NOTE(event_0, scattering_event(v.material, v.wo, s0, 0.0f));
        step.next_0 = scatter(scene, step.state, v, s0);
        step.has_next_0 = is_worth_following(step.next_0.state) ? 1u : 0u;
        if (s0.pdf < 1.0f) {
            BsdfSample s1 = sample_smooth_dielectric(v.material, v.wo, 1.0f);
            s1.weight = s1.weight * s1.pdf;
            SNELL_NOTE(bsdf_1, s1);
            SNELL_NOTE(event_1, scattering_event(v.material, v.wo, s1, 1.0f));
            step.next_1 = scatter(scene, step.state, v, s1);
            step.has_next_1 = is_worth_following(step.next_1.state) ? 1u : 0u;
        }
        SNELL_NOTE(ending, step.has_next_0 + step.has_next_1 > 0u ? ending_none : ending_faint);
        return step;
    }
    vec2 u = random_2d(key, vertex_dimension(arriving.depth, dimension_bsdf));
    float u_lobe = random_1d(key, vertex_dimension(arriving.depth, dimension_lobe));
    // of a mix only the specular part is followed: its diffuse part has had its direct light
    if (is_material(v.material.kind, material_mix)) {
        if (is_black(v.material.specular)) return step;
        v.material.base_color = vec3(0.0f);
    }
    if (is_material(v.material.kind, material_principled))
        v.material.principled = without_diffuse(v.material.principled);
    BsdfSample s = sample_bsdf(v.material, v.wo, u, u_lobe);
    SNELL_NOTE(bsdf_0, s);
    SNELL_NOTE(event_0, scattering_event(v.material, v.wo, s, u_lobe));
    SNELL_NOTE(ending, ending_absorbed);
    if (s.pdf == 0.0f) return step;
    step.next_0 = scatter(scene, step.state, v, s);
    SNELL_NOTE(ending, ending_leak);
    if (s.wi.z * dot(v.surface.geometric_normal, step.next_0.ray.direction) <= 0.0f) return step;
    step.has_next_0 = is_worth_following(step.next_0.state) ? 1u : 0u;
    SNELL_NOTE(ending, step.has_next_0 != 0u ? ending_none : ending_faint);
    return step;
}

// Connection number `task` of a vertex; value 0: nothing to test. Delta lights come first, one each.
SNELL_FN Connection whitted_connection(SNELL_IN(SceneView) scene, SNELL_IN(RenderParams) params,
                                       SNELL_IN(WhittedStep) step, uint task SNELL_RECORD_PARAMETER)
{
    SampleKey key = state_key(params, step.state);
    LightSample s;
    SNELL_NOTE(light_index, none);
    if (task < scene.delta_light_count) {
        SNELL_NOTE(light_index, task);
        s = sample_light(scene.lights.at[task], step.vertex.surface.position, vec2(0.0f, 0.0f));
    } else {
        uint area_lights = scene.light_count - scene.delta_light_count;
        vec2 u = random_2d(key, vertex_dimension(step.state.depth, task == scene.delta_light_count && area_lights > 0u
                                                                       ? dimension_light
                                                                       : dimension_select));
        if (task == scene.delta_light_count && area_lights > 0u) {
            float x = u.x * float(area_lights); // one number chooses the light and, stretched again, the point on it
            uint i = min(uint(x), area_lights - 1u);
            Light light = scene.lights.at[scene.delta_light_count + i];
            SNELL_NOTE(light_index, scene.delta_light_count + i);
            vec2 u_light = vec2(min(x - float(i), 0.99999994f), u.y);
            s = sample_light(light, step.vertex.surface.position, u_light);
            if ((light.flags & light_textured) != 0u)
                s.radiance = s.radiance * light_texture(scene, light, u_light, s.target);
            s.pdf /= float(area_lights);
        } else {
            s = sample_environment(scene, u);
        }
    }
    SNELL_NOTE(has_light, 1u);
    SNELL_NOTE(light, s);
    SNELL_NOTE(light_bsdf, vertex_eval(step.vertex, s.direction));
    Connection c;
    c.slot = step.state.slot;
    c.layer = scatter_layer(step.state.depth + 1u);
    c.seed = connection_seed(step.state) + task;
    c.value = vec3(0.0f);
    if (s.pdf > 0.0f)
        c.value = step.state.throughput * vertex_eval(step.vertex, s.direction) * s.radiance / s.pdf *
                  light_transmittance(scene, step.state.medium, step.vertex, s);
    c.ray = shadow_ray(step.vertex.surface, s);
    return c;
}

SNELL_END
#endif
