// The state of light paths between the stages of a backend: generate, extend, shade, connect, finalize.
#ifndef SNELL_KERNEL_PATH_STATE_H
#define SNELL_KERNEL_PATH_STATE_H
#include "snell/kernel/camera.h"
#include "snell/kernel/coverage.h"
#include "snell/kernel/light.h"
#include "snell/kernel/principled_material.h"
#include "snell/kernel/random.h"
#include "snell/kernel/tangent.h"
SNELL_BEGIN

// Switches of RenderParams::flags.
SNELL_CONST uint render_nee = 1u;      // next event estimation: sample the lights
SNELL_CONST uint render_mis = 2u;      // weigh light and BSDF sampling against each other
SNELL_CONST uint render_roulette = 4u; // Russian roulette
SNELL_CONST uint render_jitter = 8u;   // sample all of the pixel, not only its centre
SNELL_CONST uint render_furnace = 16u; // no emitters; environment 1 from everywhere

// What all paths of a render have in common.
struct RenderParams
{
    Camera camera;
    uint width, height; // of the whole picture
    uint seed;
    uint sampler_kind; // sampler_*
    uint max_depth;    // number of bounces after which a path ends: 0 sees emitters only, 1 adds direct light
    uint flags;        // render_*
    float distance;    // ambient occlusion: how far a surface shades another
    float max_steps;   // traversal heat map: steps at the hot end of the scale
};
SNELL_LAYOUT(RenderParams, 208)

// Which part of a pixel's value a contribution belongs to.
SNELL_CONST uint layer_emission = 0u; // emitters seen directly
SNELL_CONST uint layer_direct = 1u;   // light that was scattered once
SNELL_CONST uint layer_indirect = 2u; // more than once
SNELL_CONST uint layer_count = 3u;

// One path on its way: what the next hit of its ray will be multiplied with.
struct PathState
{
    vec3 throughput;
    uint slot; // of the sample in its batch: where contributions are added up
    float
        pdf; // per steradian, of the ray's direction; 0: camera ray or a delta bounce, which light sampling cannot draw
    float eta_scale; // product of eta^2 over refractions so far: undoes the scaling of radiance for the roulette
    uint depth;      // bounces so far
    uint medium;     // material of the dielectric that the ray is in, or none
    uint key_pixel;  // SampleKey::pixel
    uint key_reversed_index; // SampleKey::reversed_index
    uint channel;            // the colour that dispersion has left of the path: red 0, green 1, blue 2; none: all
};
SNELL_LAYOUT(PathState, 44)

// A shadow ray, and what to add to the sample if nothing blocks it.
struct Connection
{
    Ray ray;
    vec3 value;
    uint slot;
    uint layer;
    uint seed; // for passes_through
};
SNELL_LAYOUT(Connection, 56)

SNELL_FN SampleKey state_key(SNELL_IN(RenderParams) params, SNELL_IN(PathState) state)
{
    SampleKey key;
    key.kind = params.sampler_kind;
    key.pixel = state.key_pixel;
    key.reversed_index = state.key_reversed_index;
    return key;
}

// Random dimensions: pair 0 is the position in the pixel, 1 the point on the lens; each vertex has four from 2 on.
SNELL_CONST uint dimension_bsdf = 0u;   // direction
SNELL_CONST uint dimension_lobe = 1u;   // x: part of the BSDF; y: roulette
SNELL_CONST uint dimension_light = 2u;  // point on the light
SNELL_CONST uint dimension_select = 3u; // x: which light

SNELL_FN uint vertex_dimension(uint depth, uint which)
{
    return 2u + 4u * depth + which;
}

// The seeds for passes_through of a path's ray, and of the connection from where it arrives; it mixes them.
SNELL_FN uint extension_seed(SNELL_IN(PathState) state)
{
    return state.key_pixel ^ ((state.key_reversed_index + 2u * state.depth) * 0x9e3779b9u);
}
SNELL_FN uint connection_seed(SNELL_IN(PathState) state)
{
    return state.key_pixel ^ ((state.key_reversed_index + 2u * state.depth + 1u) * 0x9e3779b9u);
}

struct CameraPath
{
    Ray ray;
    PathState state;
};

// Keeps one colour of light: red 0, green 1, blue 2; what is left counts three times.
SNELL_FN vec3 one_color(uint channel)
{
    return vec3(channel == 0u ? 3.0f : 0.0f, channel == 1u ? 3.0f : 0.0f, channel == 2u ? 3.0f : 0.0f);
}

// The generate stage: the camera ray of a sample of pixel (x, y). Where the camera sees nothing it is a ray that meets
// nothing, with a throughput of 0.
SNELL_FN CameraPath generate_camera_path(SNELL_IN(RenderParams) params, uint x, uint y, uint sample_index, uint slot)
{
    SampleKey key = make_sample_key(params.sampler_kind, y * params.width + x, sample_index, params.seed);
    vec2 jitter = (params.flags & render_jitter) != 0u ? random_2d(key, 0u) : vec2(0.5f, 0.5f);
    CameraPath path;
    path.state.throughput = vec3(1.0f);
    path.state.channel = none;
    uint channel = camera_green;
    if (camera_disperses(params.camera)) {
        channel = choose_color_channel(key.pixel, key.reversed_index);
        path.state.channel = channel;
        path.state.throughput = one_color(channel);
    }
    vec2 on_lens = camera_has_lens(params.camera) ? random_2d(key, 1u) : vec2(0.5f, 0.5f);
    CameraSample seen = sample_camera(params.camera, vec2(float(x), float(y)) + jitter, on_lens, channel);
    path.ray = seen.ray;
    path.state.throughput = seen.weight * path.state.throughput;
    path.state.slot = slot;
    path.state.pdf = 0.0f;
    path.state.eta_scale = 1.0f;
    path.state.depth = 0u;
    path.state.medium = none;
    path.state.key_pixel = key.pixel;
    path.state.key_reversed_index = key.reversed_index;
    return path;
}

// A hit, ready for scattering.
struct Vertex
{
    SurfacePoint surface;
    MaterialPoint material;
    Frame frame;   // around the shading normal
    vec3 wo;       // local, back along the ray
    vec3 emission; // radiance emitted back along the ray
};

// What only some materials need stands in functions of its own, which get copies: a reference into the vertex would
// keep all of it in memory, for all materials.

// The frame after normal maps, turned along the tangents. back: unit length, to where the ray came from.
SNELL_FN_COLD Frame bent_frame(SNELL_IN(SceneView) scene, SurfacePoint surface, Hit hit, vec3 back)
{
    Material material = scene.materials.at[surface.material];
    uint uv_set = material.normal_slot != none ? scene.slots.at[material.normal_slot].uv_set : 0u;
    vec3 tangent = surface_tangents(scene, surface, hit, uv_set).u;
    vec3 n = surface.shading_normal;
    if (material.normal_slot != none)
        n = mapped_normal(scene, surface, hit, material.normal_slot, material.normal_scale, back);
    return make_tangent_frame(n, tangent);
}

// Of a principled material, resolved for wo.
SNELL_FN_COLD PrincipledPoint vertex_principled(SNELL_IN(SceneView) scene, SurfacePoint surface, Hit hit,
                                                vec3 base_color, Frame frame, vec3 back, vec3 wo)
{
    PrincipledPoint p =
        principled_point(scene, scene.materials.at[surface.material], surface, hit, base_color, frame, back);
    if (wo.z != 0.0f) p = resolve_principled(scene.albedo, p, wo);
    return p;
}

// ray.direction has unit length.
SNELL_FN Vertex make_vertex(SNELL_IN(SceneView) scene, Ray ray, Hit hit)
{
    Vertex v;
    v.surface = surface_point(scene, ray, hit);
    Material material = scene.materials.at[v.surface.material];
    v.material = material_point(scene, material, v.surface);
    vec3 back = -ray.direction;
    if (may_have(feature_tangents) && (material.flags & material_needs_tangents) != 0u) {
        v.frame = bent_frame(scene, v.surface, hit, back);
        v.surface.shading_normal = v.frame.n;
    } else {
        v.frame = make_frame(v.surface.shading_normal);
    }
    v.wo = to_local(v.frame, back);
    if (is_material(material.kind, material_principled)) {
        PrincipledPoint p = vertex_principled(scene, v.surface, hit, v.material.base_color, v.frame, back, v.wo);
        v.material.principled = p;
    }
    bool lit_side =
        dot(v.surface.geometric_normal, back) > 0.0f || (material.flags & material_two_sided_emission) != 0u;
    v.emission = lit_side ? material.emission : vec3(0.0f);
    if (material.emission_slot != none) v.emission = v.emission * emission_texture(scene, material, v.surface);
    if (material.kind == material_unlit) v.emission = v.material.base_color;
    return v;
}

// A surface with dispersion: leaves one colour of the path, with its index of refraction.
SNELL_FN_COLD void disperse(SNELL_IN(SceneView) scene, float dispersion, SNELL_INOUT(PathState) state,
                            SNELL_INOUT(Vertex) v)
{
    if (state.channel == none) {
        state.channel = choose_color_channel(state.key_pixel, state.key_reversed_index);
        state.throughput = state.throughput * one_color(state.channel);
    }
    vec3 iors = dispersed_ior(v.material.ior, dispersion);
    v.material.principled.ior = state.channel == 0u ? iors.x : state.channel == 1u ? iors.y : iors.z;
    if (v.wo.z != 0.0f) v.material.principled = resolve_principled(scene.albedo, v.material.principled, v.wo);
}

// BSDF * |cos| towards a world direction. Light must not leak through where shading and geometric normal disagree
// about the side that a direction is on.
SNELL_FN vec3 vertex_eval(SNELL_IN(Vertex) v, vec3 direction)
{
    vec3 wi = to_local(v.frame, direction);
    if (wi.z * dot(v.surface.geometric_normal, direction) <= 0.0f) return vec3(0.0f);
    return eval_bsdf(v.material, v.wo, wi);
}

// What is left of light after a segment of the path, by Beer and Lambert.
SNELL_FN vec3 medium_transmittance(SNELL_IN(SceneView) scene, uint medium, float distance)
{
    vec3 sigma = scene.materials.at[medium].absorption;
    return exp(-sigma * distance);
}

// The medium behind a surface of this material after passing it from the side that `from_outside` tells.
SNELL_FN uint medium_behind(SNELL_IN(SceneView) scene, uint material, bool from_outside)
{
    return from_outside && !is_black(scene.materials.at[material].absorption) ? material : none;
}

// What absorption leaves of a light sample on its way to the surface; the ray that arrives there is in `medium`. Light
// from infinitely far away has no way inside, as a ray that misses everything has none.
SNELL_FN vec3 light_transmittance(SNELL_IN(SceneView) scene, uint medium, SNELL_IN(Vertex) v, LightSample s)
{
    if (s.is_infinite != 0u) return vec3(1.0f);
    vec3 local = to_local(v.frame, s.direction);
    uint inside = local.z * v.wo.z > 0.0f ? medium : medium_behind(scene, v.surface.material, v.wo.z > 0.0f);
    if (inside == none) return vec3(1.0f);
    return medium_transmittance(scene, inside, length(s.target - v.surface.position));
}

// The state after a BSDF sample; its ray starts off the surface on the side that it goes to.
SNELL_FN CameraPath scatter(SNELL_IN(SceneView) scene, SNELL_IN(PathState) state, SNELL_IN(Vertex) v, BsdfSample s)
{
    CameraPath next;
    vec3 direction = to_world(v.frame, s.wi);
    next.ray =
        make_ray(offset_toward(v.surface.position, v.surface.geometric_normal, direction), direction, infinity());
    next.state = state;
    next.state.throughput = state.throughput * s.weight;
    next.state.pdf = s.is_delta != 0u ? 0.0f : s.pdf;
    next.state.depth = state.depth + 1u;
    if (s.eta != 1.0f || s.wi.z * v.wo.z < 0.0f) {
        next.state.eta_scale = state.eta_scale * s.eta * s.eta;
        next.state.medium = medium_behind(scene, v.surface.material, v.wo.z > 0.0f);
    }
    return next;
}

SNELL_END
#endif
