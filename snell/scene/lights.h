// The light list: what emits, as kernels sample it.
#pragma once

#include "snell/scene/packed.h"

#include <span>

namespace snell {

// A point, directional or spot light; directions become unit vectors, angles cosines.
Light make_light(const LightDesc& desc);

// An emissive triangle with world-space corners. It emits on the side of cross(direction, edge).
Light make_triangle_light(vec3 a, vec3 b, vec3 c, const Material& material, uint primitive, uint instance);

// An emissive sphere in world space.
Light make_sphere_light(vec3 center, float radius, const Material& material, uint primitive, uint instance);

// Emitted power (of its luminance) of one light in a scene of that radius; what lights are chosen by.
double light_power(const Light& light, double scene_radius);

// Fills select_pdf, alias_threshold and alias (Vose 1991, A linear algorithm for generating random numbers with a
// given distribution). powers: one for each light, >= 0; a light without power is never chosen, unless all are.
// select_pdf is what the finished table, with its thresholds rounded to floats, really chooses by.
void build_alias_table(std::span<Light> lights, std::span<const double> powers);

// Fills packed.lights with the alias table and numbers the lights in surfaces, spheres and instances. Everything else
// of `packed` must be finished; lights that are there already are replaced. Throws Error for an emissive sphere that an
// instance would make an ellipsoid.
void pack_lights(const Scene& scene, PackedScene& packed);

} // namespace snell
