// Stereolithography files: triangles without anything else.
#pragma once

#include "snell/io/load.h"

#include <filesystem>

namespace snell {

// Binary or ASCII, also packed with gzip; told apart by what the file's size says, not by the word "solid" (binary
// files begin with it, too). One mesh; equal vertices are shared, so that a closed surface is closed. The facets'
// normals are not used: the winding decides, and a note says if they disagree. Throws Error with a line (ASCII) or a
// byte count (binary).
Scene load_stl(const std::filesystem::path& file, const LoadOptions& options = {});

} // namespace snell
