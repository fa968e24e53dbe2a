// Rays for measuring and comparing acceleration structures: those that a path tracer would ask for in a scene.
#pragma once

#include "snell/bvh/accel.h"
#include "snell/kernel/camera.h"
#include "snell/scene/packed.h"

#include <string>
#include <vector>

namespace snell {

struct RaySet
{
    std::string name;      // "camera", "shadow", "ao", "bounce1", "bounce2" or "bounce3"
    bool any_hit = false;  // asks whether anything is hit, not what
    bool coherent = false; // neighbours point nearly the same way
    std::vector<Ray> rays;
};

struct RaySetOptions
{
    std::size_t rays = std::size_t{1} << 20; // of each set, about
    uint seed = 1;
    float occlusion_distance = 0.0f; // of ambient occlusion; 0: a quarter of the scene's radius, as the renderer's
};

// Six sets, the same ones for the same scene, camera and options, whatever `accel` is and however many threads there
// are:
//  - camera: a square picture in tiles of 8x8 pixels, one ray somewhere in each pixel;
//  - shadow: from what these hit to points on the scene's lights, chosen as the renderer does; in a scene without
//    lights, to a square as wide as a fifth of the scene below its top;
//  - ao: from the same points, directions drawn by the cosine, of limited length;
//  - bounce1, 2, 3: directions drawn by the cosine from what the set before has hit, camera rays at first; shuffled
//    within tiles of 1,024 rays.
// Every surface counts as diffuse. The origins are moved off the surface as the renderer's are. Where many rays leave
// the scene the others have several successors, so that the sets are equally large; a set that has nothing to start
// from is empty.
std::vector<RaySet> make_ray_sets(const PackedScene& scene, const Camera& camera, const Accel& accel,
                                  const RaySetOptions& options = {});

// The side of the picture that make_ray_sets() looks through: the camera must be made for a square of that many pixels.
int ray_set_side(std::size_t rays);

} // namespace snell
