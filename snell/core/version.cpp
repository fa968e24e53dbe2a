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
    std::vector<std::string> names;
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) names.emplace_back(hwy::TargetName(target));
    return names;
}

} // namespace snell
