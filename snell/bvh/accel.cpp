#include "snell/bvh/accel.h"
#include "snell/core/error.h"

#include "snell/bvh/brute.h"
#include "snell/bvh/embree.h"
#include "snell/bvh/node.h"
#include "snell/bvh/wide_accel.h"

#include <array>

namespace snell {

#ifdef SNELL_HAS_EMBREE
static constexpr std::string_view embree_summary = "Intel's Embree 3, for comparison";
#else
static constexpr std::string_view embree_summary = "Intel's Embree 3: not in this build, which needs libembree-dev";
#endif

static constexpr std::array registry = {
    AccelInfo{"bvh8", "tree of nodes with 8 children", make_wide_accel<Node8>},
    AccelInfo{"bvh8q", "the same with boxes of 8 bits a plane: nodes half as large", make_wide_accel<QuantisedNode>},
    AccelInfo{"bvh4", "tree of nodes with 4 children", make_wide_accel<Node4>},
    AccelInfo{"bvh2", "binary tree", make_wide_accel<Node2>},
    AccelInfo{"brute", "every ray against every primitive; the reference", make_brute},
    AccelInfo{"embree", embree_summary, make_embree, false},
};

std::span<const AccelInfo> accels()
{
    return registry;
}

const AccelInfo* find_accel(std::string_view name)
{
    for (const AccelInfo& info : registry)
        if (info.name == name) return &info;
    return nullptr;
}

void Accel::find_blockers(std::span<const Ray> rays, std::span<uint> primitives) const
{
    SNELL_CHECK_EQ(rays.size(), primitives.size());
    std::vector<Hit> hits(rays.size());
    intersect(rays, hits);
    for (std::size_t i = 0; i < hits.size(); ++i) primitives[i] = hits[i].primitive;
}

} // namespace snell
