// Builders: from primitive references to the binary tree, swappable by name.
#pragma once

#include "snell/bvh/tree.h"
#include "snell/scene/packed.h"

#include <span>
#include <string>
#include <string_view>

namespace snell {

struct BuildOptions
{
    std::string builder;        // one of builders(); empty: the default
    double split_budget = 0.25; // sbvh: references beyond the primitives' number, as a part of it, at most
    uint reinsertion = 0;       // rounds of optimise_by_reinsertion() after any builder; 0: none

    bool operator==(const BuildOptions&) const = default;
};

// What all builders keep to:
//  - leaves hold 1 to max_leaf_size references, all of one kind; an instance has a leaf of its own;
//  - the depth is at most max_tree_depth, whatever the input; fewer than 2^30 references, all with finite bounds;
//  - the tree is the same, bit for bit, for any number of threads;
//  - each reference is in one leaf (sbvh: in one or more), and boxes enclose what lies below (sbvh: the part of it that
//    lies in the node's region, the union of the regions being everything).
// The cost that the builders lower is that of the surface area heuristic with cost_of_node and cost_of_block.
struct BuilderInfo
{
    std::string_view name;
    std::string_view summary; // with the paper
    BinaryTree (*build)(const PackedScene& scene, std::vector<PrimitiveRef> refs, const BuildOptions& options);
};

std::span<const BuilderInfo> builders(); // the first one is the default
const BuilderInfo* find_builder(std::string_view name);

inline constexpr int max_tree_depth = 96;

// Expected costs of a visit, in units of time: a leaf costs one block, however full.
inline constexpr float cost_of_node = 1.0f;
inline constexpr float cost_of_block = 1.0f;

// Runs the builder and the passes that the options name. Throws Error for an unknown builder.
BinaryTree build_tree(const PackedScene& scene, std::vector<PrimitiveRef> refs, const BuildOptions& options);

// ---- the builders; scene is what the references refer to ----

// The default: binned with two rounds of reinsertion, unless options.reinsertion asks for others; for small scenes also
// sbvh, and the one that promises to be faster to trace.
BinaryTree build_auto(const PackedScene& scene, std::vector<PrimitiveRef> refs, const BuildOptions& options);

// Binned surface area heuristic (Wald 2007, On fast Construction of SAH-based Bounding Volume Hierarchies), in
// parallel.
BinaryTree build_binned_sah(const PackedScene& scene, std::vector<PrimitiveRef> refs, const BuildOptions& options);

// Every split that sorting along an axis allows (Wald and Havran 2006): the reference for quality without duplicates.
BinaryTree build_sweep_sah(const PackedScene& scene, std::vector<PrimitiveRef> refs, const BuildOptions& options);

// Halves the centres' box in the middle of its longest side: for teaching, and as the worst that is still a tree.
BinaryTree build_median(const PackedScene& scene, std::vector<PrimitiveRef> refs, const BuildOptions& options);

// Spatial splits beside object splits (Stich, Friedrich, Dietrich 2009), within options.split_budget.
BinaryTree build_sbvh(const PackedScene& scene, std::vector<PrimitiveRef> refs, const BuildOptions& options);

// Sorted along a Morton curve and split where the highest differing bit changes (Lauterbach et al. 2009; Karras 2012).
BinaryTree build_lbvh(const PackedScene& scene, std::vector<PrimitiveRef> refs, const BuildOptions& options);

// Parallel locally-ordered clustering of neighbours on the Morton curve (Meister and Bittner 2018).
BinaryTree build_ploc(const PackedScene& scene, std::vector<PrimitiveRef> refs, const BuildOptions& options);

// ---- a pass over any tree ----

// Takes subtrees out and puts them where they add the least surface (Meister and Bittner 2018, Parallel Reinsertion for
// Bounding Volume Hierarchy Optimization). The same tree for any number of threads; never one of a higher cost.
void optimise_by_reinsertion(BinaryTree& tree, uint rounds);

} // namespace snell
