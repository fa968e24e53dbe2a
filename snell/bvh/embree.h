// Embree as an accelerator: the yardstick, and an escape hatch.
#pragma once

#include "snell/bvh/accel.h"

namespace snell {

// Embree's tree (Wald et al. 2014, Embree: A Kernel Framework for Efficient CPU Ray Tracing) finds what a ray may meet;
// t, u, v, the interval and ties are then settled by the kernels that all structures use. So its hits are those of
// brute force, bit for bit, but for
//  - rays that graze an edge, where one of both tests says no: its watertight mode (TriangleTest::watertight) may find
//    the neighbour, or a surface behind by a unit in the last place; without it such a ray may slip through;
//  - vertices beyond 1.8e18, which Embree leaves out, and rays from so far away;
//  - occluded(), for what lies within some units in the last place of t_min or t_max.
//
// Of the options, build.builder chooses a builder of Embree's: lbvh its Morton codes, sbvh its spatial splits, any
// other its binned SAH. Traversal::automatic is single, packets have 16, 8 or 4 rays, whichever the processor is made
// for. It does not tell what its trees cost, so UpdatePolicy::automatic rebuilds what has changed; refit begins with
// the second update, for only a tree that was made for it can be. stats: nodes, leaves and cost are unknown, 0; bytes
// count the tree and a copy of the vertices. The steps of intersect_counted() are unknown, 0.
//
// Throws Error where snell was built without Embree.
std::unique_ptr<Accel> make_embree(const PackedScene& scene, const AccelOptions& options);

} // namespace snell
