// Directional albedos: how much of the light that comes from everywhere a scattering model sends to wo. They are
// integrals that have no formula; snell/scene/albedo_tables.cpp tabulates them, here they are looked up.
//
// A table of albedo_columns * albedo_rows numbers has cos(wo) along its rows, at the squares of equally spaced numbers
// from 0 to 1. Its rows are at alphas: squares likewise; those of the sheen run from 1 to sheen_alpha_min in equal
// ratios.
#ifndef SNELL_KERNEL_ALBEDO_H
#define SNELL_KERNEL_ALBEDO_H
#include "snell/kernel/scene_view.h"
#include "snell/kernel/sheen.h"
SNELL_BEGIN

SNELL_CONST uint albedo_columns = 58u;
SNELL_CONST uint albedo_rows = 94u;
SNELL_CONST uint albedo_table_length = 5452u; // their product

// Where the tables lie in SceneView::albedo.
SNELL_CONST uint albedo_ggx = 0u;             // GGX reflection where each facet is a perfect mirror
SNELL_CONST uint albedo_ggx_edge = 5452u;     // (that with Schlick's weight as reflectance, over the one above)^(1/5)
SNELL_CONST uint albedo_sheen = 10904u;       // logarithm of eval_sheen's
SNELL_CONST uint albedo_anisotropic = 16356u; // see anisotropic_albedo; all 1 where no material is anisotropic
SNELL_CONST uint albedo_anisotropic_edge = 26436u; // likewise; all 0
SNELL_CONST uint albedo_length = 36516u;           // of the tables that every scene has

// The nodes of albedo_anisotropic, the fastest first: cosines and alphas as above, turns at equal steps of the
// roughness along wo's azimuth, from the smaller to the greater; strengths at equal steps of the anisotropy.
SNELL_CONST uint anisotropic_cosines = 14u;
SNELL_CONST uint anisotropic_turns = 8u;
SNELL_CONST uint anisotropic_alphas = 10u;
SNELL_CONST uint anisotropic_strengths = 9u;
SNELL_CONST uint anisotropic_length = 10080u; // their product

// Rough glass of one ior has three tables more; where they begin: Principled::glass_table. F is Fresnel's reflectance
// stretched so that it is 0 at normal incidence.
SNELL_CONST uint glass_thin_side = 0u;         // reflected by F plus refracted by 1 - F, wo on the thinner side
SNELL_CONST uint glass_thin_side_edge = 5452u; // reflected by F less what F takes from refraction, likewise
SNELL_CONST uint glass_dense_side = 10904u;    // as the first, wo on the denser side
SNELL_CONST uint glass_tables_length = 16356u;

// The table that begins there at (x, y) in [0, 1]^2, bilinear: the tables are fine enough.
SNELL_FN float look_up_albedo(FloatArray albedo, uint table, float x, float y)
{
    float fx = x * float(albedo_columns - 1u);
    float fy = y * float(albedo_rows - 1u);
    float column = min(floor(fx), float(albedo_columns - 2u));
    float row = min(floor(fy), float(albedo_rows - 2u));
    fx = fx - column;
    fy = fy - row;
    uint at = table + uint(row) * albedo_columns + uint(column);
    float low = albedo.at[at] + (albedo.at[at + 1u] - albedo.at[at]) * fx;
    at += albedo_columns;
    float high = albedo.at[at] + (albedo.at[at + 1u] - albedo.at[at]) * fx;
    return low + (high - low) * fy;
}

// Likewise, for a table with its rows at alpha.
SNELL_FN float look_up_rough_albedo(FloatArray albedo, uint table, float cos_o, float alpha)
{
    return look_up_albedo(albedo, table, sqrt(clamp(cos_o, 0.0f, 1.0f)), sqrt(clamp(alpha, 0.0f, 1.0f)));
}

// x: albedo of GGX reflection with a reflectance of 1; y: with Schlick's weight (1 - cos)^5 as reflectance. So that of
// a reflectance f0 + (f90 - f0) * weight is f0 * x + (f90 - f0) * y. alpha 0: of a mirror.
SNELL_FN vec2 ggx_albedo(FloatArray albedo, float cos_o, float alpha)
{
    float edge = 1.0f - clamp(cos_o, 0.0f, 1.0f);
    float whole = 1.0f;
    if (alpha > 0.0f) {
        whole = look_up_rough_albedo(albedo, albedo_ggx, cos_o, alpha);
        edge = look_up_rough_albedo(albedo, albedo_ggx_edge, cos_o, alpha);
    }
    float edge2 = edge * edge;
    return vec2(whole, whole * edge2 * edge2 * edge);
}

// Where x in [0, 1] falls among n nodes: the node before it and how far beyond.
SNELL_FN vec2 node_before(float x, uint n)
{
    float at = clamp(x, 0.0f, 1.0f) * float(n - 1u);
    float node = min(floor(at), float(n - 2u));
    return vec2(node, at - node);
}

// Bilinear in cosine and turn.
SNELL_FN float look_up_anisotropic(FloatArray albedo, uint first, vec2 cosine, vec2 turn)
{
    uint at = first;
    float low = albedo.at[at] + (albedo.at[at + 1u] - albedo.at[at]) * cosine.y;
    at += anisotropic_cosines;
    float high = albedo.at[at] + (albedo.at[at + 1u] - albedo.at[at]) * cosine.y;
    return low + (high - low) * turn.y;
}

// The place of wo among the nodes of the anisotropic tables.
struct AnisotropicPlace
{
    uint first; // nearest node before it in all four
    vec2 cosine, turn, rough, strong;
};

// Trilinear in cosine, turn and alpha.
SNELL_FN float look_up_anisotropic_strength(FloatArray albedo, uint at, SNELL_IN(AnisotropicPlace) place)
{
    float low = look_up_anisotropic(albedo, at, place.cosine, place.turn);
    float high = look_up_anisotropic(albedo, at + anisotropic_cosines * anisotropic_turns, place.cosine, place.turn);
    return low + (high - low) * place.rough.y;
}

SNELL_FN float look_up_anisotropic_table(FloatArray albedo, uint table, SNELL_IN(AnisotropicPlace) place)
{
    uint at = table + place.first;
    float low = look_up_anisotropic_strength(albedo, at, place);
    at += anisotropic_cosines * anisotropic_turns * anisotropic_alphas;
    float high = look_up_anisotropic_strength(albedo, at, place);
    return low + (high - low) * place.strong.y;
}

// As ggx_albedo, for anisotropic GGX.
//   w         direction in the frame of the anisotropy, w.z >= 0
//   alphas    along X and Y; X has more: mix(alphas.y, 1, strength^2)
SNELL_FN_COLD vec2 anisotropic_albedo(FloatArray albedo, vec3 w, vec2 alphas, float strength)
{
    float side = max(w.x * w.x + w.y * w.y, 1e-12f);
    float seen = sqrt((sqr(alphas.x * w.x) + sqr(alphas.y * w.y)) / side);
    AnisotropicPlace place;
    place.cosine = node_before(sqrt(clamp(w.z, 0.0f, 1.0f)), anisotropic_cosines);
    place.turn = node_before((seen - alphas.y) / max(alphas.x - alphas.y, 1e-12f), anisotropic_turns);
    place.rough = node_before(sqrt(clamp(alphas.y, 0.0f, 1.0f)), anisotropic_alphas);
    place.strong = node_before(strength, anisotropic_strengths);
    place.first =
        ((uint(place.strong.x) * anisotropic_alphas + uint(place.rough.x)) * anisotropic_turns + uint(place.turn.x)) *
            anisotropic_cosines +
        uint(place.cosine.x);
    // the tables tell how it differs from isotropic roughness
    float mean = 0.5f * (alphas.x + alphas.y);
    float whole = look_up_rough_albedo(albedo, albedo_ggx, w.z, mean) *
                  look_up_anisotropic_table(albedo, albedo_anisotropic, place);
    float edge = look_up_rough_albedo(albedo, albedo_ggx_edge, w.z, mean) +
                 look_up_anisotropic_table(albedo, albedo_anisotropic_edge, place);
    edge = clamp(edge, 0.0f, 1.0f);
    float edge2 = edge * edge;
    return vec2(whole, whole * edge2 * edge2 * edge);
}

// Albedo of eval_sheen, >= 0; it may pass 1. alpha in [sheen_alpha_min, 1].
SNELL_FN float sheen_albedo(FloatArray albedo, float cos_o, float alpha)
{
    float y = log(alpha) / log(sheen_alpha_min);
    return exp(look_up_albedo(albedo, albedo_sheen, sqrt(clamp(cos_o, 0.0f, 1.0f)), clamp(y, 0.0f, 1.0f)));
}

SNELL_END
#endif
