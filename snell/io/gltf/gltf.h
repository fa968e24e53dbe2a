// glTF 2.0, as text and as GLB.
#pragma once

#include "snell/io/load.h"
#include "snell/scene/scene.h"

#include <filesystem>

namespace snell {

// The default scene of the file in its rest pose, with everything that its nodes need to be posed otherwise. What is
// read, what it becomes and what is simplified: docs/gltf.md. Throws Error (with the part of the file that is to blame)
// if the file is cut off, refers to what is not there, or needs an extension that is not known.
Scene load_gltf(const std::filesystem::path& file, const LoadOptions& options);

} // namespace snell
