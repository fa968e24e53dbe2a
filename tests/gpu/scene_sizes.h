// How many elements of each kind random_scene() has, for index_below() in cases.
#ifndef SNELL_TESTS_GPU_SCENE_SIZES_H
#define SNELL_TESTS_GPU_SCENE_SIZES_H
#include "snell/kernel/lang.h"
SNELL_BEGIN

SNELL_CONST uint scene_vertices = 48u; // in each of the meshes
SNELL_CONST uint scene_triangles = 120u;
SNELL_CONST uint scene_surfaces = 12u;
SNELL_CONST uint scene_spheres = 8u;
SNELL_CONST uint scene_planes = 4u;
SNELL_CONST uint scene_instances = 5u;
SNELL_CONST uint scene_materials = 32u; // every fourth is principled
SNELL_CONST uint scene_principled = 8u;
SNELL_CONST uint scene_lights = 20u;
SNELL_CONST uint scene_textures = 12u;
SNELL_CONST uint scene_slots = 16u;
SNELL_CONST uint scene_columns = 8u; // of the environment's cells
SNELL_CONST uint scene_rows = 5u;
SNELL_CONST uint scene_lens_first = 192u; // in colors: a LensSystem::table, and rear_z, entrance_z, gain, film_radius
SNELL_CONST uint scene_lens_interfaces = 11u;
SNELL_CONST uint scene_lens_pupils = 64u;

SNELL_END
#endif
