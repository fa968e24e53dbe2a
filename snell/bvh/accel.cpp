#include "snell/bvh/accel.h"

#include "snell/bvh/brute.h"
#include "snell/bvh/bvh8.h"
#include "snell/bvh/embree.h"

#include <array>

namespace snell {

#ifdef SNELL_HAS_EMBREE
static constexpr std::string_view embree_summary = "Intel's Embree 3, for comparison";
#else
static constexpr std::string_view embree_summary = "Intel's Embree 3: not in this build, which needs libembree-dev";
#endif

static constexpr std::array registry = {
    AccelInfo{"bvh8", "8-wide tree by binned SAH, many rays in flight", make_bvh8},
    AccelInfo{"bvh8-single", "the same tree, one ray at a time", make_bvh8_single},
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

} // namespace snell
