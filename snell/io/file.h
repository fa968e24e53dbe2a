// Whole files in and out, with errors that say what to do.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace snell {

// The bytes of a regular file. Throws Error (with the file as place) if it is missing, a folder, a device or a pipe,
// unreadable, or larger than memory.
std::string read_file(const std::filesystem::path& file);

// Replaces `file` with the bytes, or leaves it as it was and throws Error: the bytes go to a temporary name in the same
// folder, reach the disk, and are renamed. A link is followed, the permissions of an existing file are kept. Only an
// existing regular file is ever replaced.
void write_atomically(const std::filesystem::path& file, std::string_view bytes);

// The same for a library that writes files itself: write(temporary) fills the (existing, empty) temporary file. If it
// throws, the temporary file is removed and the exception goes on. `write` must not keep the file open.
void write_atomically(const std::filesystem::path& file,
                      const std::function<void(const std::filesystem::path& temporary)>& write);

// Throws Error unless write_atomically could write there now: the folder exists and can be written to, and what is
// there already, if anything, is a regular file that can be replaced.
void check_can_write(const std::filesystem::path& file);

// The ending of a file name in lower case, with its dot: ".exr"; empty if there is none.
std::string lower_extension(const std::filesystem::path& file);

} // namespace snell
