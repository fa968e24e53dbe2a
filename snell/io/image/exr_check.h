// Private to snell/io/image: looks over an EXR file's headers before OpenEXR does.
#pragma once

#include <filesystem>
#include <string_view>

namespace snell {

// Throws Error if the headers are cut off, or claim sizes (of windows, tiles, chunk tables, attributes) that a file of
// this length cannot hold, or the file has deep pixels. OpenEXR allocates on the strength of these claims.
void check_exr_headers(const std::filesystem::path& file, std::string_view bytes);

} // namespace snell
