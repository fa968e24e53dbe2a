// Surfaces with holes: rays that meet a surface that is not there go on as if they had met nothing.
#ifndef SNELL_KERNEL_COVERAGE_H
#define SNELL_KERNEL_COVERAGE_H
#include "snell/kernel/random.h"
#include "snell/kernel/surface.h"
SNELL_BEGIN

// True if the ray passes through what it has hit. A half-transparent surface lets rays through by chance: by a number
// that is a function of the seed, the primitive and the distance (a ray may leave a sphere that it has entered), so that
// every order of asking gets the same answer.
SNELL_FN_COLD bool passes_through(SNELL_IN(SceneView) scene, SNELL_IN(Ray) ray, SNELL_IN(Hit) hit, uint seed)
{
    uint kind = primitive_kind(hit.primitive);
    uint index = primitive_index(hit.primitive);
    uint material_index = 0u;
    if (kind == kind_triangle)
        material_index = scene.surfaces.at[scene.triangles.at[index].surface].material;
    else if (kind == kind_sphere)
        material_index = scene.spheres.at[index].material;
    else
        material_index = scene.planes.at[index].material;
    Material material = scene.materials.at[material_index];
    if (material.coverage == coverage_opaque) return false;
    float coverage = surface_coverage(scene, material, surface_point(scene, ray, hit));
    uvec3 r = pcg3d(uvec3(seed ^ hash_uint(floatBitsToUint(hit.t)), hit.primitive, hit.instance));
    return unit_float(r.x) >= coverage;
}

SNELL_END
#endif
