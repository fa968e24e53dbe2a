#include "snell/render/visibility.h"

#include "snell/kernel/coverage.h"

namespace snell {

void pass_holes(const SceneView& scene, const Accel& accel, std::span<const Ray> rays, std::span<Hit> hits,
                bool from_camera, std::vector<uint> which, std::vector<uint> seeds)
{
    std::vector<Ray> onward;
    std::vector<Hit> passed, found;
    for (;;) {
        std::size_t kept = 0;
        onward.clear();
        passed.clear();
        for (std::size_t k = 0; k < which.size(); ++k) {
            const uint i = which[k];
            if (!is_hit(hits[i]) || !passes_through(scene, rays[i], hits[i], seeds[k], from_camera)) continue;
            onward.push_back(rays[i]);
            passed.push_back(hits[i]);
            which[kept] = i;
            seeds[kept] = seeds[k];
            ++kept;
        }
        if (kept == 0) return;
        which.resize(kept);
        seeds.resize(kept);
        found.resize(kept);
        accel.intersect_next(onward, passed, found);
        for (std::size_t k = 0; k < kept; ++k) hits[which[k]] = found[k];
    }
}

} // namespace snell
