#include "snell/bvh/big_pages.h"

#include <cstdint>
#include <cstdlib>
#include <new>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace snell {

void* allocate_big(std::size_t bytes)
{
    constexpr std::size_t huge = std::size_t{2} << 20;
    const std::size_t alignment = bytes >= 2 * huge ? huge : 256; // the largest that a node wants
    const std::size_t rounded = (bytes + alignment - 1) / alignment * alignment;
    void* memory = std::aligned_alloc(alignment, rounded);
    if (!memory) throw std::bad_alloc();
#ifdef __linux__
    if (alignment == huge) madvise(memory, rounded, MADV_HUGEPAGE); // a hint: failing costs nothing
#endif
    return memory;
}

void free_big(void* memory)
{
    std::free(memory);
}

void advise_big([[maybe_unused]] void* memory, [[maybe_unused]] std::size_t bytes)
{
#ifdef __linux__
    constexpr std::size_t huge = std::size_t{2} << 20;
    const auto address = reinterpret_cast<std::uintptr_t>(memory);
    const std::uintptr_t begin = (address + huge - 1) / huge * huge, end = (address + bytes) / huge * huge;
    if (begin < end) madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE); // a hint, too
#endif
}

} // namespace snell
