// Memory for large arrays that are read in random order.
#pragma once

#include <cstddef>
#include <new>
#include <vector>

namespace snell {

// Aligned to 64 bytes; blocks of several MiB are aligned to 2 MiB and, on Linux, marked for huge pages: a random read
// then seldom waits for the page table.
void* allocate_big(std::size_t bytes);
void free_big(void* memory);

template <class T>
struct BigPageAllocator
{
    using value_type = T;

    BigPageAllocator() = default;
    template <class U>
    BigPageAllocator(const BigPageAllocator<U>&)
    {
    }
    T* allocate(std::size_t count)
    {
        if (count > static_cast<std::size_t>(-1) / 2 / sizeof(T)) throw std::bad_alloc();
        return static_cast<T*>(allocate_big(count * sizeof(T)));
    }
    void deallocate(T* memory, std::size_t) { free_big(memory); }
    bool operator==(const BigPageAllocator&) const { return true; }
};

template <class T>
using BigVector = std::vector<T, BigPageAllocator<T>>;

} // namespace snell
