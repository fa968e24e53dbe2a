// The scenes that another renderer has made converged pictures of.
#pragma once

#include <filesystem>
#include <string>

namespace snell::test {

struct ReferenceFiles
{
    std::filesystem::path scene, picture;
};

// NAME.pbrt and NAME.exr: beside this file, or, for the bunny's, which may not be copied, in ../shared/reference. Both
// are empty where they are not there.
inline ReferenceFiles find_reference(const std::string& name)
{
    const std::filesystem::path ours = SNELL_SOURCE_DIR "/tests/image/reference";
    const std::filesystem::path others = SNELL_SOURCE_DIR "/../shared/reference";
    if (exists(ours / (name + ".pbrt"))) return {ours / (name + ".pbrt"), ours / (name + ".exr")};
    if (exists(others / "scenes" / (name + ".pbrt")))
        return {others / "scenes" / (name + ".pbrt"), others / (name + ".exr")};
    return {};
}

} // namespace snell::test
