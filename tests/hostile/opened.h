// Opens a broken file under bounds of time and memory.
#pragma once

#include "formats.h"

#include <optional>
#include <string>
#include <string_view>

namespace snell::hostile {

struct Opened
{
    std::optional<Error> error;
    double seconds = 0;         // of all processors
    std::size_t peak_bytes = 0; // more than before
};

// Puts the bytes into the nest and opens them. What must hold of every file, however broken, is expected here: an Error
// names a file of the nest, and the bounds below hold. An exception of another kind, or more than a minute, fails too.
// about: what was done to the file; a file that fails is kept under that name in the folder for temporary files.
Opened open_checked(const Format& format, const Nest& nest, std::string_view bytes, const std::string& about);

// The most memory that opening a file of this size may take.
std::size_t memory_bound(const Format& format, std::size_t file_size);

// The most time, in seconds of all processors.
double time_bound(std::size_t file_size);

} // namespace snell::hostile
