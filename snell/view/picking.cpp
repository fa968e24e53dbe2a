#include "snell/view/picking.h"

#include "snell/kernel/camera.h"
#include "snell/kernel/intersect.h"
#include "snell/render/params.h"
#include "snell/render/visibility.h"

#include <algorithm>

namespace snell::view {

// In world space nothing says which instance put it there; the plan does.
static uint instance_of(const Prepared& prepared, const Hit& hit)
{
    const PackedScene& packed = prepared.packed;
    if (hit.instance != none) return packed.instances[hit.instance].object;
    if (!prepared.motion) return none;
    const PackPlan& plan = prepared.motion->plan;
    const uint index = primitive_index(hit.primitive);
    if (primitive_kind(hit.primitive) == kind_sphere) return plan.sphere_placements[index].baked;
    if (primitive_kind(hit.primitive) != kind_triangle) return none;
    // Placements lie in the order of their triangles.
    const auto after = std::upper_bound(plan.mesh_placements.begin(), plan.mesh_placements.end(), index,
                                        [](uint i, const MeshPlacement& p) { return i < p.first_triangle; });
    return after == plan.mesh_placements.begin() ? none : (after - 1)->baked;
}

std::optional<PickedSurface> pick_surface(const Prepared& prepared, const CameraDesc& desc,
                                          const RenderSettings& settings, int x, int y)
{
    const ReadyCamera camera = make_camera(desc, settings.width, settings.height);
    const Ray ray = camera_ray(camera, vec2(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f));
    Hit hit;
    intersect_covered(prepared.packed.view(), *prepared.accel, {&ray, 1}, {&hit, 1}, true, [](uint) { return 0u; });
    if (!is_hit(hit)) return {};
    const PackedScene& packed = prepared.packed;
    const uint index = primitive_index(hit.primitive);
    PickedSurface picked;
    picked.distance = hit.t;
    picked.instance = instance_of(prepared, hit);
    switch (primitive_kind(hit.primitive)) {
    case kind_triangle: {
        const Surface& surface = packed.surfaces[packed.triangles[index].surface];
        picked.material = surface.material;
        picked.object = surface.object;
        break;
    }
    case kind_sphere:
        picked.material = packed.spheres[index].material;
        picked.object = packed.spheres[index].object;
        break;
    default:
        picked.material = packed.planes[index].material;
        picked.object = packed.planes[index].object;
    }
    return picked;
}

} // namespace snell::view
