// How much memory is in use: everything that any library takes by malloc or new, in any thread.
#pragma once

#include <cstddef>

namespace snell::hostile {

// Bytes in use now, and the most since the last reset.
std::size_t memory_in_use();
std::size_t memory_peak();
void reset_memory_peak();

} // namespace snell::hostile
