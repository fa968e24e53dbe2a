// How far reading a file has come, for LoadOptions::progress.
#pragma once

#include "snell/io/load.h"

#include <functional>

namespace snell {

// A function to call often with the part of the file that has been read, in [0, 1]. It tells options.progress of the
// beginning, the middle and the end, and a few times a second between them: "reading NAME", with fractions up to 0.9,
// for what is read has still to be checked.
std::function<void(double)> reading_progress(const LoadOptions& options, const std::filesystem::path& file);

} // namespace snell
