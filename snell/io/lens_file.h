// Lens prescriptions as text.
#pragma once

#include "snell/scene/lens.h"

#include <filesystem>

namespace snell {

// A surface a line, from the scene to the film, as pbrt's lens files have them: radius, thickness, index of refraction
// behind it (0 stands for air), diameter; in millimetres. Behind # comes a comment. Throws Error (file, line, what to
// do) for anything else, and for lenses that light cannot pass.
LensPrescription load_lens(const std::filesystem::path& file);

// The inverse: the same numbers come back. Throws Error if the file cannot be written.
void write_lens(const LensPrescription& lens, const std::filesystem::path& file);

} // namespace snell
