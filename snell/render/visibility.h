// What rays meet, with holes in surfaces taken into account (see kernel/coverage.h).
#pragma once

#include "snell/bvh/accel.h"
#include "snell/kernel/coverage.h"

namespace snell {

// As Accel::intersect, but rays pass through surfaces that are not there. seed(i): of ray i, for passes_through.
template <class Seed>
void intersect_covered(const SceneView& scene, const Accel& accel, std::span<const Ray> rays, std::span<Hit> hits,
                       bool from_camera, const Seed& seed);

// As Accel::occluded, likewise.
template <class Seed>
void occluded_covered(const SceneView& scene, const Accel& accel, std::span<const Ray> rays,
                      std::span<std::uint8_t> blocked, const Seed& seed);

// Sends rays[which[k]] on that have met a surface which may have a hole, until each has met something that is there, or
// nothing. seeds: one for each of `which`.
void pass_holes(const SceneView& scene, const Accel& accel, std::span<const Ray> rays, std::span<Hit> hits,
                bool from_camera, std::vector<uint> which, std::vector<uint> seeds);

template <class Seed>
void intersect_covered(const SceneView& scene, const Accel& accel, std::span<const Ray> rays, std::span<Hit> hits,
                       bool from_camera, const Seed& seed)
{
    accel.intersect(rays, hits);
    if ((scene.coverage & (from_camera ? scene_has_holes | scene_has_single_sided : scene_has_holes)) == 0u) return;
    std::vector<uint> which, seeds;
    for (uint i = 0; i < rays.size(); ++i)
        if (is_hit(hits[i]) && may_have_hole(scene, hits[i].primitive, from_camera))
            which.push_back(i), seeds.push_back(seed(i));
    pass_holes(scene, accel, rays, hits, from_camera, std::move(which), std::move(seeds));
}

template <class Seed>
void occluded_covered(const SceneView& scene, const Accel& accel, std::span<const Ray> rays,
                      std::span<std::uint8_t> blocked, const Seed& seed)
{
    if ((scene.coverage & scene_has_holes) == 0u) return accel.occluded(rays, blocked);
    std::vector<uint> blockers(rays.size());
    accel.find_blockers(rays, blockers);
    // Of the rays that are blocked by something which may have a hole, the nearest hits, and then those behind.
    std::vector<Ray> candidates;
    std::vector<uint> which, seeds, origin;
    for (uint i = 0; i < rays.size(); ++i) {
        blocked[i] = blockers[i] != none;
        if (blockers[i] == none || !may_have_hole(scene, blockers[i], false)) continue;
        which.push_back(static_cast<uint>(candidates.size()));
        candidates.push_back(rays[i]);
        seeds.push_back(seed(i));
        origin.push_back(i);
    }
    std::vector<Hit> hits(candidates.size());
    accel.intersect(candidates, hits);
    pass_holes(scene, accel, candidates, hits, false, std::move(which), std::move(seeds));
    for (std::size_t k = 0; k < origin.size(); ++k) blocked[origin[k]] = is_hit(hits[k]) ? 1 : 0;
}

} // namespace snell
