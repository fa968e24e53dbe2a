// One sample of one pixel, replayed vertex by vertex: what a path met, what was drawn, what it added to the picture.
#pragma once

#include "snell/kernel/path_state.h"
#include "snell/render/render.h"

#include <string>
#include <string_view>
#include <vector>

namespace snell {

// Next event estimation at a vertex, and what its shadow ray found.
struct ProbedLight
{
    uint light = none;       // index into PackedScene::lights; none: the environment (of ambient occlusion: no light)
    LightSample drawn;       // pdf 0: no sample. Ambient occlusion: its direction, pdf of the cosine
    vec3 bsdf{0.0f};         // BSDF * |cos| towards it
    float bsdf_pdf = 0;      // per steradian, with which BSDF sampling would have drawn that direction; 0: never
    float weight = 1;        // of light sampling, by multiple importance sampling
    bool was_traced = false; // false: it would have added nothing, so no ray was sent
    bool is_blocked = false;
    float blocked_at = 0; // distance to what blocks it, in scene units
    Ray ray;              // to it
    vec3 value{0.0f};     // what it adds if it is not blocked
    uint layer = layer_direct;
};

struct ProbedVertex
{
    int parent = -1;           // index of the vertex that the ray comes from; -1: the camera
    Ray ray;                   // that led here
    Hit hit;                   // the end of that ray
    bool passed_holes = false; // the ray went through a surface before, which is not there for it
    uint steps = 0;            // of traversal, up to the first surface in the ray's way
    PathState arriving;        // as the ray set out: throughput, BSDF pdf, medium, bounces
    vec3 throughput{1.0f};     // on arrival: with absorption on the way, and the choice of a colour by dispersion

    bool is_surface = false; // false: the ray left the scene, and the members below mean nothing
    SurfacePoint surface;
    uint material_kind = 0; // material_*
    float alpha = 0;        // GGX roughness; of a principled surface that of its facets

    vec3 emission{0.0f};       // radiance that the ray found here, of an emitter or of the environment
    float emission_pdf = 0;    // per steradian, with which light sampling would have found it; 0: never
    float emission_weight = 1; // of BSDF sampling, by multiple importance sampling
    vec3 emitted{0.0f};        // what it adds to the sample
    uint layer = layer_emission;

    std::vector<ProbedLight> lights; // path: at most one; whitted: one for each task

    // The continuation; whitted has two at smooth glass.
    struct Continuation
    {
        uint event = 0;        // event_* of snell/kernel/record.h
        vec3 direction{0.0f};  // of the next ray; zero if there is none
        float pdf = 0;         // of the BSDF per steradian; a probability if the event is specular
        vec3 weight{0.0f};     // what throughput is multiplied with: BSDF * |cos| / pdf; of two, times the pdf
        vec3 throughput{0.0f}; // after it, roulette's division included
        int vertex = -1;       // where it led; -1: it was not followed
    };
    std::vector<Continuation> continuations;
    float survival = 1; // probability of surviving Russian roulette; 1: it was not played
    uint ending = 0;    // ending_* of snell/kernel/record.h
};

// One term of a sample, in the order of summation.
struct Contribution
{
    int vertex = 0;
    int light = -1; // index into ProbedVertex::lights; -1: what the vertex emits
    uint layer = layer_emission;
    vec3 value{0.0f};
};

struct ProbedPath
{
    int x = 0, y = 0;
    uint sample = 0;
    vec2 film_position{0.0f};           // where in the picture, in pixels
    std::vector<ProbedVertex> vertices; // in the order in which the renderer shades them
    std::vector<Contribution> contributions;
    vec3 layers[layer_count] = {vec3(0.0f), vec3(0.0f), vec3(0.0f)}; // sums of the contributions, in their order
    vec3 radiance{0.0f};                                             // emission + direct + indirect
};

// Replays sample number `sample` (RenderSettings::first_sample not added) of pixel (x, y) with the kernel functions of
// the integrator that the settings name, seen by `camera` (Prepared::camera, or another), compiled once more so that
// they note what they find. `radiance` is, bit for bit, what render() adds to that pixel for that sample. Of a view and
// of an integrator of one's own there is one vertex, the first, and one contribution. Throws Error as render() does.
ProbedPath probe_path(const Prepared& prepared, const CameraDesc& camera, const RenderSettings& settings, int x, int y,
                      uint sample);

// The same sample by the renderer's backend, on its own: what probe_path() must equal. 0 if it is not finite.
vec3 render_sample(const Prepared& prepared, const CameraDesc& camera, const RenderSettings& settings, int x, int y,
                   uint sample);

// Words for tables.
std::string_view event_name(uint event);
std::string_view ending_name(uint ending);
std::string_view layer_name(uint layer);
std::string_view material_kind_name(uint kind);

} // namespace snell
