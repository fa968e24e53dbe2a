// What MTL materials mean here.
#pragma once

#include "snell/io/obj/mtl.h"
#include "snell/scene/scene.h"

namespace snell::obj {

// MTL is from the time of Phong shading, and writers disagree; the rules, of which the first that applies counts:
//
//   principled  any of Pr Pm Ps Pc Pcr aniso or their maps, as Blender and others write them: base colour Kd, metallic
//             Pm, roughness Pr (or from Ns: the square root of what alpha is below), clear coat Pc and Pcr, sheen Ps
//             (of roughness 0.3), anisotropy aniso and anisor (parts of a full turn), index of refraction Ni if it is
//             above 1; twice Ks's largest component, at most 1, is the strength of the reflection, for 0.5 is what
//             exporters write for the usual 4%. d below 1: the surface is there with that probability. Glass by illum:
//             light goes through, tinted with Kd.
//   glass     illum 4, 6, 7 or 9: a smooth dielectric of index Ni (1.5 if Ni is not above 1). Tf is taken for its hue
//             only (divided by its largest component), for some writers mean what passes and others what does not; half
//             of it acts at each surface, so that a body shows Tf's hue once.
//   see-through  d below 1 (or Tr above 0), without map_d: as glass, of index Ni as it is written (1 if not: light
//             passes straight), tinted with Kd as far as it is opaque: by 1 - d + d Kd.
//   mirror    illum 3, 5 or 8 and Kd less than a tenth of Ks: a perfect mirror of reflectance Ks.
//   mix       Ks above 0 and illum not 1: diffuse Kd and specular Ks, scaled down where they exceed 1 together. alpha
//             is 0 with illum 3, 5 or 8, else sqrt(2 / (Ns + 2)) (Walter et al. 2007).
//   diffuse   Kd.
//
// Ke is emitted radiance, on the front only. Without Kd: 0.8, or 0 for an emitter; with map_Kd a Kd of 0 counts as 1,
// and so do Ke, Pr, Pm, Ps and d with their maps. Textures are not part of the result.
MaterialDesc to_material(const MtlMaterial& m);

} // namespace snell::obj
