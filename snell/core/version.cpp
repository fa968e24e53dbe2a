#include "snell/core/version.h"

#include <hwy/targets.h>

#include <cstdint>

#ifndef SNELL_VERSION
#define SNELL_VERSION "unversioned" // built without CMake
#endif

namespace snell {

extern const char* const built_commit; // in the build folder, see cmake/version.cmake

std::string_view version()
{
    return SNELL_VERSION;
}

std::string_view commit()
{
    return built_commit;
}

std::string compiler()
{
#if defined(__clang__)
    return std::string("Clang ") + __clang_version__;
#elif defined(__GNUC__)
    return std::string("GCC ") + __VERSION__;
#else
    return "an unknown compiler";
#endif
}

std::vector<std::string> instruction_sets()
{
    // Highway gives the better set the lower bit.
    std::vector<std::string> names;
    for (std::int64_t left = hwy::SupportedAndGeneratedTargets(); left != 0; left &= left - 1) {
        const std::int64_t target = left & -left;
        names.emplace_back(hwy::TargetName(target));
    }
    return names;
}

} // namespace snell
