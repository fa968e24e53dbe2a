// The text format of pbrt-v4, and what is left of v3 in the wild.
#pragma once

#include "snell/io/load.h"

#include <filesystem>

namespace snell {

// Reads a scene in the pbrt-v4 format with our extensions, or in that of v3; docs/pbrt.md says what becomes of each
// directive. Spectra become linear Rec.709. What cannot be had becomes the nearest thing that can, with a note that
// says so, once a kind; unknown directives and parameters are noted and left out, as are missing pictures and meshes.
// Throws Error with file, line and column for what makes no sense, and for a file that would take far more than its own
// size in time or memory.
Scene load_pbrt(const std::filesystem::path& file, const LoadOptions& options = {});

} // namespace snell
