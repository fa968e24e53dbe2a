#include "snell/bvh/accel.h"

#include "snell/bvh/brute.h"
#include "snell/bvh/bvh8.h"

#include <array>

namespace snell {

static constexpr std::array registry = {
    AccelInfo{"bvh8", "8-wide tree by binned SAH, many rays in flight", make_bvh8},
    AccelInfo{"bvh8-single", "the same tree, one ray at a time", make_bvh8_single},
    AccelInfo{"brute", "every ray against every primitive; the reference", make_brute},
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
