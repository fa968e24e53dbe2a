// What the principled surface is made of: anisotropic GGX, sheen, films and the tables of albedos.
#ifndef TWIN_CASES
#include "snell/kernel/albedo.h"
#include "snell/kernel/ggx_anisotropic.h"
#include "snell/kernel/iridescence.h"
#else

TWIN(anisotropic_ggx, 1e-4f, 1e-6f, 0.0f)
{
    vec3 m = direction();
    float a = magnitude(1e-3f, 1.0f);
    float b = magnitude(1e-3f, 1.0f);
    give(anisotropic_d(m, vec2(a, b)));
    give(anisotropic_lambda(m, vec2(a, b)));
}
TWIN(sample_anisotropic_visible, 1e-4f, 1e-4f, 0.01f) // see sample_ggx_visible
{
    vec3 w = upper_direction();
    float a = magnitude(1e-3f, 1.0f);
    float b = magnitude(1e-3f, 1.0f);
    vec2 u = unit2();
    give(sample_anisotropic_visible(w, vec2(a, b), u));
}
TWIN_BUILTIN(sheen, 1e-3f, 1e-6f, 0.002f) // high powers
{
    vec3 wo = direction();
    vec3 wi = direction();
    float alpha = range(0.01f, 1.0f);
    float c = unit();
    give(sheen_d(c, alpha));
    give(sheen_curve(0.5f * c, alpha));
    give(sheen_lambda(c, alpha));
    give(eval_sheen(alpha, wo, wi));
}
TWIN(schlick_weight, 1e-5f, 1e-7f, 0.0f)
{
    float c = unit();
    float turns = range(-50.0f, 50.0f);
    give(schlick_weight(c));
    give(cos_turns(turns));
}
TWIN_BUILTIN(film_sensitivity, 1e-3f, 1e-3f, 0.001f) // many turns
{
    float path_difference = 1e-6f * range(0.0f, 4.0f);
    vec3 shift = 6.0f * color();
    give(film_sensitivity(path_difference, shift));
}
TWIN_BUILTIN(film_reflectance, 1e-3f, 1e-3f, 0.001f)
{
    float cos_i = unit();
    float ior = range(1.0f, 2.5f);
    float thickness = range(0.0f, 1000.0f);
    vec3 f0 = color();
    give(film_reflectance(cos_i, ior, thickness, f0));
}
TWIN(look_up_albedo, 1e-4f, 1e-4f, 0.0f)
{
    float x = unit();
    float y = unit();
    give(look_up_albedo(scene.albedo, albedo_ggx_edge, x, y));
    give(look_up_rough_albedo(scene.albedo, albedo_length + glass_dense_side, x, y));
    give(ggx_albedo(scene.albedo, x, y));
}
TWIN_BUILTIN(sheen_albedo, 1e-3f, 1e-5f, 0.0f)
{
    float x = unit();
    float alpha = range(0.01f, 1.0f);
    give(sheen_albedo(scene.albedo, x, alpha));
}
TWIN(look_up_anisotropic, 1e-4f, 1e-4f, 0.0f)
{
    float x = unit();
    float y = unit();
    float z = unit();
    float w = unit();
    AnisotropicPlace place;
    place.cosine = node_before(x, anisotropic_cosines);
    place.turn = node_before(y, anisotropic_turns);
    place.rough = node_before(z, anisotropic_alphas);
    place.strong = node_before(w, anisotropic_strengths);
    place.first = uint(place.turn.x) * anisotropic_cosines + uint(place.cosine.x);
    give(place.cosine);
    give(place.turn);
    give(look_up_anisotropic(scene.albedo, albedo_anisotropic + place.first, place.cosine, place.turn));
    give(look_up_anisotropic_strength(scene.albedo, albedo_anisotropic + place.first, place));
    give(look_up_anisotropic_table(scene.albedo, albedo_anisotropic_edge, place));
}
TWIN(anisotropic_albedo, 1e-3f, 1e-4f, 0.001f)
{
    vec3 w = upper_direction();
    float alpha = unit();
    float strength = range(0.1f, 1.0f);
    vec2 alphas = vec2(alpha + (1.0f - alpha) * strength * strength, alpha);
    give(anisotropic_albedo(scene.albedo, w, alphas, strength));
}

#endif
