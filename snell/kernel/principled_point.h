// The principled surface at one point, as glTF 2.0 and its material extensions define it. From top to bottom:
//
//   clearcoat   GGX, index 1.5, with its own roughness and normal
//   sheen       sheen.h
//   base        a mix by `metallic` of a metal and a dielectric; the dielectric is a mix by `transmission` of glass and
//               of an opaque body that reflects at its surface and diffusely (or lets light through diffusely)
//
// Each layer passes on what its directional albedo leaves, and GGX lobes are scaled up by what single scattering loses
// (Turquin 2019, Practical multiple scattering compensation for microfacet models), so that where nothing absorbs, all
// light returns. Albedos are taken at wo alone. Such a BSDF is not quite reciprocal; docs/materials.md says why.
#ifndef SNELL_KERNEL_PRINCIPLED_POINT_H
#define SNELL_KERNEL_PRINCIPLED_POINT_H
#include "snell/kernel/albedo.h"
#include "snell/kernel/features.h"
#include "snell/kernel/fresnel.h"
#include "snell/kernel/iridescence.h"
#include "snell/kernel/sheen.h"
SNELL_BEGIN

SNELL_CONST float principled_smooth_alpha = 1e-4f; // less rough than this is a mirror
SNELL_CONST float principled_straight_eta = 1e-3f; // so close to 1, an index does not bend light
// The tables of rough glass are within 0.003; light that bounces about in it shall not grow by that.
SNELL_CONST float glass_gain_margin = 0.997f;
SNELL_CONST float principled_grazing = 1e-7f; // closer to the horizon nothing is scattered to
SNELL_CONST float clearcoat_f0 = 0.04f;

// The first part is given by the caller, with all textures looked up; resolve_principled fills the second.
struct PrincipledPoint
{
    vec3 base_color;
    float metallic;
    float alpha;               // GGX roughness, the square of the perceptual one; 0: perfectly smooth
    float anisotropy;          // in [0, 1]; roughness along the direction becomes mix(alpha, 1, anisotropy^2)
    vec2 anisotropy_direction; // unit length, in the local frame
    float ior;                 // of the dielectric, inside over outside; 0: reflects everything
    float specular;            // strength of the dielectric's reflection, in [0, 1]
    vec3 specular_color;       // tints it at normal incidence, >= 0
    float clearcoat;
    float clearcoat_alpha;
    vec3 clearcoat_normal; // local, unit length
    vec3 sheen_color;
    float sheen_alpha; // the square of the perceptual roughness
    float transmission;
    uint thin_walled; // light passes straight through; 0: the surface of a solid
    uint glass_table; // Principled::glass_table; none: rough solid glass loses some light
    float iridescence;
    float iridescence_ior;
    float iridescence_thickness; // nanometres
    float diffuse_transmission;
    vec3 diffuse_transmission_color;

    // For one wo. "reflected" are the coefficients of Schlick's weight 1 and (1 - cos)^5 of metal and opaque body.
    vec2 alphas;         // along X and Y of the anisotropy's frame; both 0: smooth
    vec3 reflected_f0;   // GGX lobe of metal and opaque body at normal incidence
    vec3 reflected_edge; // added at grazing incidence
    vec3 glass_weight;
    vec3 glass_f0;
    float glass_f90;
    float eta;     // glass: transmitted side over wo's side; 1: light goes straight on
    vec3 straight; // what passes unbent because the indices are the same
    vec3 diffuse;  // Lambert's albedo
    vec3 diffuse_through;
    vec3 sheen;  // factor of eval_sheen
    float coat;  // factor of the clearcoat's lobe
    vec3 albedo; // of it all, in [0, 1]
    // probabilities of the lobes; their sum is 1, or all are 0
    float p_coat, p_sheen, p_facets, p_straight, p_diffuse, p_through;
};

SNELL_FN float mean3(vec3 v)
{
    return (v.x + v.y + v.z) * (1.0f / 3.0f);
}

// The second part, empty.
SNELL_FN_COLD void clear_principled(SNELL_INOUT(PrincipledPoint) p)
{
    p.alphas = vec2(0.0f);
    p.reflected_f0 = vec3(0.0f);
    p.reflected_edge = vec3(0.0f);
    p.glass_weight = vec3(0.0f);
    p.glass_f0 = vec3(0.0f);
    p.glass_f90 = 1.0f;
    p.eta = 1.0f;
    p.straight = vec3(0.0f);
    p.diffuse = vec3(0.0f);
    p.diffuse_through = vec3(0.0f);
    p.sheen = vec3(0.0f);
    p.coat = 0.0f;
    p.albedo = vec3(0.0f);
    p.p_coat = 0.0f;
    p.p_sheen = 0.0f;
    p.p_facets = 0.0f;
    p.p_straight = 0.0f;
    p.p_diffuse = 0.0f;
    p.p_through = 0.0f;
}

// The parameters that leave a surface without layers: a grey opaque dielectric of index 1.5, white, of that alpha.
SNELL_FN_COLD PrincipledPoint plain_principled_point(float alpha)
{
    PrincipledPoint p;
    p.base_color = vec3(1.0f);
    p.metallic = 0.0f;
    p.alpha = alpha;
    p.anisotropy = 0.0f;
    p.anisotropy_direction = vec2(1.0f, 0.0f);
    p.ior = 1.5f;
    p.specular = 1.0f;
    p.specular_color = vec3(1.0f);
    p.clearcoat = 0.0f;
    p.clearcoat_alpha = 0.0f;
    p.clearcoat_normal = vec3(0.0f, 0.0f, 1.0f);
    p.sheen_color = vec3(0.0f);
    p.sheen_alpha = 0.0f;
    p.transmission = 0.0f;
    p.thin_walled = 1u;
    p.glass_table = none;
    p.iridescence = 0.0f;
    p.iridescence_ior = 1.3f;
    p.iridescence_thickness = 0.0f;
    p.diffuse_transmission = 0.0f;
    p.diffuse_transmission_color = vec3(1.0f);
    clear_principled(p);
    return p;
}

// KHR_materials_dispersion: indices for red, green and blue of a glass of that index and 20 / Abbe number.
SNELL_FN vec3 dispersed_ior(float ior, float dispersion)
{
    float half_spread = (ior - 1.0f) * 0.025f * dispersion;
    return vec3(ior - half_spread, ior, ior + half_spread);
}

// Reflectance at normal incidence between media of that relative index.
SNELL_FN float f0_of_ior(float ior)
{
    return sqr((ior - 1.0f) / (ior + 1.0f));
}

// The two roughnesses, both 0 or both at least principled_smooth_alpha.
SNELL_FN vec2 principled_alphas(float alpha, float anisotropy)
{
    float a = clamp(alpha, 0.0f, 1.0f);
    float along = a + (1.0f - a) * sqr(clamp(anisotropy, 0.0f, 1.0f));
    if (along < principled_smooth_alpha) return vec2(0.0f);
    return vec2(along, max(a, principled_smooth_alpha));
}

// To the frame of the anisotropy, and back.
SNELL_FN vec3 to_facet_frame(SNELL_IN(PrincipledPoint) p, vec3 w)
{
    vec2 d = p.anisotropy_direction;
    return vec3(w.x * d.x + w.y * d.y, w.y * d.x - w.x * d.y, w.z);
}
SNELL_FN vec3 from_facet_frame(SNELL_IN(PrincipledPoint) p, vec3 w)
{
    vec2 d = p.anisotropy_direction;
    return vec3(w.x * d.x - w.y * d.y, w.y * d.x + w.x * d.y, w.z);
}

// How far F is on its way from normal (0) to grazing (1) incidence, between glass and air: Fresnel's equations, not
// Schlick's approximation, so that refraction and total reflection are right.
SNELL_FN float glass_edge(DielectricSplit split)
{
    if (split.reflectance >= 1.0f) return 1.0f;
    float f0 = f0_of_ior(split.eta);
    return clamp((split.reflectance - f0) / (1.0f - f0), 0.0f, 1.0f);
}

// The f0 with which f0 + (f90 - f0) * edge is `reflectance`.
SNELL_FN vec3 f0_behind(vec3 reflectance, float f90, float edge)
{
    return clamp((reflectance - f90 * edge) / max(1.0f - edge, 1e-4f), 0.0f, 1.0f);
}

// What Turquin's compensation multiplies a lobe with, of which a part `whole` of the light leaves.
SNELL_FN vec3 scattering_gain(vec3 f0, float whole)
{
    return 1.0f + f0 * ((1.0f - whole) / whole);
}

SNELL_END
#endif
