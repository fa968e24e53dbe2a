#include "snell/bvh/build.h"

#include "snell/core/parallel.h"

namespace snell {

// Sets up to here are built with spatial splits as well, in about three times the time.
static constexpr std::size_t most_for_two = std::size_t{1} << 17;
// Splits must promise that much: in leaves they cost more than the estimate says, for duplicates make them emptier.
static constexpr double worthwhile = 0.85;
static constexpr uint rounds = 2;

// Expected cost of a ray, where each primitive counts: of two trees over the same primitives, the one with less
// overlap.
static double estimate(const BinaryTree& tree)
{
    double cost = 0;
    for (const BinaryNode& node : tree.nodes)
        cost += node.box.half_area() * (node.count > 0 ? cost_of_block * static_cast<float>(node.count) : cost_of_node);
    return cost;
}

BinaryTree build_auto(const PackedScene& scene, std::vector<PrimitiveRef> refs, const BuildOptions& options)
{
    const auto build = [&](auto builder, std::vector<PrimitiveRef> some) {
        BinaryTree tree = builder(scene, std::move(some), options);
        if (options.reinsertion == 0) optimise_by_reinsertion(tree, rounds);
        return tree;
    };
    if (refs.size() > most_for_two) return build(build_binned_sah, std::move(refs));
    BinaryTree plain, split;
    parallel_both([&] { plain = build(build_binned_sah, refs); }, [&] { split = build(build_sbvh, refs); });
    return estimate(split) < worthwhile * estimate(plain) ? std::move(split) : std::move(plain);
}

} // namespace snell
