// Surfaces with holes: rays that meet a surface that is not there go on as if they had met nothing.
#ifndef SNELL_KERNEL_COVERAGE_H
#define SNELL_KERNEL_COVERAGE_H
#include "snell/kernel/random.h"
#include "snell/kernel/surface.h"
SNELL_BEGIN

SNELL_FN uint material_of(SNELL_IN(SceneView) scene, uint primitive)
{
    uint kind = primitive_kind(primitive);
    uint index = primitive_index(primitive);
    if (kind == kind_triangle) return scene.surfaces.at[scene.triangles.at[index].surface].material;
    if (kind == kind_sphere) return scene.spheres.at[index].material;
    return scene.planes.at[index].material;
}

// False if no ray passes through the primitive, wherever it meets it.
SNELL_FN bool may_have_hole(SNELL_IN(SceneView) scene, uint primitive, bool from_camera)
{
    Material material = scene.materials.at[material_of(scene, primitive)];
    return material.coverage != coverage_opaque || (from_camera && (material.flags & material_single_sided) != 0u);
}

// True if the ray passes through what it has hit. Camera rays pass through the back of single-sided surfaces, as in the
// rasterisers that those were made for; to all other rays they are as solid as anything, or light would leak. A
// half-transparent surface lets rays through by chance: by a number that is a function of the seed, the primitive and
// about the distance (a ray may leave a sphere that it has entered), so that every order of asking gets the same
// answer. Not of the distance's last bits: then a device that rounds otherwise would see other holes.
SNELL_FN_COLD bool passes_through(SNELL_IN(SceneView) scene, SNELL_IN(Ray) ray, SNELL_IN(Hit) hit, uint seed,
                                  bool from_camera)
{
    Material material = scene.materials.at[material_of(scene, hit.primitive)];
    bool is_single_sided = from_camera && (material.flags & material_single_sided) != 0u;
    if (material.coverage == coverage_opaque && !is_single_sided) return false;
    SurfacePoint surface = surface_point(scene, ray, hit);
    if (is_single_sided && dot(surface.geometric_normal, ray.direction) > 0.0f) return true;
    float coverage = surface_coverage(scene, material, surface);
    uvec3 r = pcg3d(uvec3(seed ^ hash_uint(floatBitsToUint(hit.t) >> 12), hit.primitive, hit.instance));
    return unit_float(r.x) >= coverage;
}

SNELL_END
#endif
