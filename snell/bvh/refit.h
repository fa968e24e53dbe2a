// Refitting: a tree follows primitives that have moved, and keeps who lies beside whom.
#pragma once

#include "snell/bvh/wide.h"

#include <span>

namespace snell {

// The arrays of one tree. Children come after their parents; nearly all of them soon after.
struct RefitArrays
{
    std::span<WideNode> nodes;
    std::span<TriangleBlock> triangles;
    std::span<const SphereBlock> spheres;
    WideRoot* root;
};

struct Refitted
{
    Box box;         // of the root; empty: nothing is left to hit
    double cost = 0; // as WideBvh::sah_cost, of a ray that enters the root's box
};

// Copies the corners of the triangles anew, and makes all boxes and orders what they are for these. Triangles with a
// corner that is NaN or infinite are not hit, as long as that is so. In parallel, in time proportional to the arrays;
// the result does not depend on the number of threads. Trees with instances: an Error (they are built anew).
Refitted refit(const PackedScene& scene, const RefitArrays& tree);

} // namespace snell
