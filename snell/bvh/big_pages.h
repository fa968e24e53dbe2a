// Memory for large arrays that are read in random order.
#pragma once

#include <cstddef>
#include <new>
#include <utility>
#include <vector>

namespace snell {

// Aligned to 256 bytes; blocks of several MiB are aligned to 2 MiB and, on Linux, marked for huge pages: a random read
// then seldom waits for the page table.
void* allocate_big(std::size_t bytes);
void free_big(void* memory);

// Asks for huge pages where memory that nobody has touched yet holds whole ones: one fault instead of 512.
void advise_big(void* memory, std::size_t bytes);

// A vector of so many elements, each with its first value, in huge pages if it is large.
template <class T>
std::vector<T> make_big(std::size_t count)
{
    std::vector<T> elements;
    elements.reserve(count);
    advise_big(elements.data(), count * sizeof(T));
    elements.resize(count);
    return elements;
}

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

// As that, but resize() leaves elements as they are where T has no constructor: the threads that fill it are the first
// to touch it.
template <class T>
struct RawPageAllocator : BigPageAllocator<T>
{
    template <class U>
    struct rebind
    {
        using other = RawPageAllocator<U>;
    };
    RawPageAllocator() = default;
    template <class U>
    RawPageAllocator(const RawPageAllocator<U>&)
    {
    }
    template <class U, class... Args>
    void construct(U* at, Args&&... args)
    {
        if constexpr (sizeof...(Args) == 0)
            ::new (static_cast<void*>(at)) U;
        else
            ::new (static_cast<void*>(at)) U(std::forward<Args>(args)...);
    }
};

template <class T>
using RawVector = std::vector<T, RawPageAllocator<T>>;

} // namespace snell
