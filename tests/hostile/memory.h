// How much memory is in use: everything that any library takes by malloc or new, in any thread.
#pragma once

#include <cstddef>

// GCC and clang say it differently.
#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define SNELL_SANITIZED 1
#endif
#elif defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define SNELL_SANITIZED 1
#endif

namespace snell::hostile {

// Bytes in use now, and the most since the last reset.
std::size_t memory_in_use();
std::size_t memory_peak();
void reset_memory_peak();

} // namespace snell::hostile
