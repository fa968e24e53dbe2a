// What a probe wants to know of a step of a path beside its result.
//
// The shade stages are compiled once more for probes (snell/lab/path_probe.cpp), with SNELL_RECORD defined: they then
// take a VertexRecord behind their other parameters and note in it what they find. Everywhere else the macros are
// empty, and nothing of this is left in the code.
#ifndef SNELL_KERNEL_RECORD_H
#define SNELL_KERNEL_RECORD_H
#include "snell/kernel/path_state.h"

#ifdef SNELL_RECORD
#define SNELL_RECORD_PARAMETER , SNELL_INOUT(VertexRecord) record
#define SNELL_RECORD_ARGUMENT , record
#define SNELL_NOTE(member, value) record.member = value
#else
#define SNELL_RECORD_PARAMETER
#define SNELL_RECORD_ARGUMENT
#define SNELL_NOTE(member, value)
#endif

SNELL_BEGIN

// What happens to a path at a vertex.
SNELL_CONST uint event_none = 0u; // nothing was drawn
SNELL_CONST uint event_diffuse_reflection = 1u;
SNELL_CONST uint event_glossy_reflection = 2u;
SNELL_CONST uint event_specular_reflection = 3u;
SNELL_CONST uint event_diffuse_transmission = 4u;
SNELL_CONST uint event_glossy_refraction = 5u;
SNELL_CONST uint event_specular_refraction = 6u; // or straight on through something thin

// Why a path ends at a vertex.
SNELL_CONST uint ending_none = 0u;     // it goes on
SNELL_CONST uint ending_escaped = 1u;  // it met nothing
SNELL_CONST uint ending_depth = 2u;    // as many bounces as were asked for
SNELL_CONST uint ending_absorbed = 3u; // there was no direction to go on to, or nothing is scattered to it
SNELL_CONST uint ending_leak = 4u;     // the shading normal would send it through the true surface
SNELL_CONST uint ending_roulette = 5u; // Russian roulette
SNELL_CONST uint ending_faint = 6u;    // Whitted's cut-off
SNELL_CONST uint ending_direct = 7u;   // Whitted's renderer does not follow diffuse reflection

struct VertexRecord
{
    uint has_vertex;       // 0: the ray met nothing
    Vertex vertex;         // after dispersion
    PathState state;       // with the absorption on the way, and dispersion's choice
    vec3 emission;         // radiance that the ray found: an emitter's, or that of the environment
    float emission_pdf;    // per steradian, with which light sampling would have found it; 0: never
    float emission_weight; // of BSDF sampling, by multiple importance sampling
    uint has_light;        // 1: a light was sampled
    uint light_index;      // none: the environment
    LightSample light;
    vec3 light_bsdf;           // BSDF * |cos| towards it
    float light_bsdf_pdf;      // per steradian, with which BSDF sampling would have found it; 0: never, or nobody asked
    float light_weight;        // of light sampling, by multiple importance sampling
    BsdfSample bsdf_0, bsdf_1; // of the continuations; whitted has two at a dielectric
    uint event_0, event_1;     // event_*
    float survival;            // probability of the path to survive Russian roulette; 1: it was not played
    uint ending;               // ending_*
};

SNELL_FN VertexRecord empty_record()
{
    VertexRecord r;
    r.has_vertex = 0u;
    r.emission = vec3(0.0f);
    r.emission_pdf = 0.0f;
    r.emission_weight = 1.0f;
    r.has_light = 0u;
    r.light_index = none;
    r.light = no_light_sample();
    r.light_bsdf = vec3(0.0f);
    r.light_bsdf_pdf = 0.0f;
    r.light_weight = 1.0f;
    r.bsdf_0 = no_bsdf_sample();
    r.bsdf_0.pdf = 0.0f;
    r.bsdf_1 = r.bsdf_0;
    r.event_0 = event_none;
    r.event_1 = event_none;
    r.survival = 1.0f;
    r.ending = ending_none;
    return r;
}

// The kind of event that sample_bsdf has drawn with u_lobe: event_*.
SNELL_FN uint scattering_event(SNELL_IN(MaterialPoint) m, vec3 wo, BsdfSample s, float u_lobe)
{
    if (s.pdf == 0.0f) return event_none;
    bool through = s.wi.z * wo.z < 0.0f;
    if (s.is_delta != 0u) return through ? event_specular_refraction : event_specular_reflection;
    bool is_diffuse = m.kind == material_diffuse || (m.kind == material_mix && u_lobe >= mix_specular_probability(m));
    if (m.kind == material_principled) {
        uint lobe = principled_lobe(m.principled, u_lobe);
        is_diffuse = lobe == lobe_diffuse || lobe == lobe_through;
    }
    if (is_diffuse) return through ? event_diffuse_transmission : event_diffuse_reflection;
    return through ? event_glossy_refraction : event_glossy_reflection;
}

SNELL_END
#endif
