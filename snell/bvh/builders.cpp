#include "snell/bvh/build.h"

#include "snell/core/error.h"
#include "snell/core/text.h"

#include <fmt/ranges.h>

#include <array>

namespace snell {

static constexpr std::array registry = {
    BuilderInfo{"auto", "binned with two rounds of reinsertion, or sbvh where that promises more", build_auto},
    BuilderInfo{"binned", "surface area heuristic over bins (Wald 2007)", build_binned_sah},
    BuilderInfo{"sweep", "surface area heuristic over all splits: the reference (Wald and Havran 2006)",
                build_sweep_sah},
    BuilderInfo{"median", "the middle of the longest side: for teaching", build_median},
    BuilderInfo{"sbvh", "spatial splits beside object splits (Stich et al. 2009)", build_sbvh},
    BuilderInfo{"lbvh", "Morton codes, the fastest to build (Lauterbach et al. 2009, Karras 2012)", build_lbvh},
    BuilderInfo{"ploc", "neighbours on the Morton curve join from the bottom up (Meister and Bittner 2018)",
                build_ploc},
};

std::span<const BuilderInfo> builders()
{
    return registry;
}

const BuilderInfo* find_builder(std::string_view name)
{
    for (const BuilderInfo& info : registry)
        if (info.name == name) return &info;
    return nullptr;
}

BinaryTree build_tree(const PackedScene& scene, std::vector<PrimitiveRef> refs, const BuildOptions& options)
{
    const BuilderInfo* info = options.builder.empty() ? &registry.front() : find_builder(options.builder);
    if (info == nullptr) {
        std::vector<std::string> names;
        for (const BuilderInfo& known : registry) names.emplace_back(known.name);
        const std::string near = nearest(options.builder, names);
        throw Error(fmt::format("there is no builder '{}'", options.builder),
                    near.empty() ? fmt::format("there are {}", fmt::join(names, ", "))
                                 : fmt::format("did you mean '{}'?", near));
    }
    BinaryTree tree = info->build(scene, std::move(refs), options);
    optimise_by_reinsertion(tree, options.reinsertion);
    return tree;
}

} // namespace snell
