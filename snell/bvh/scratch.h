// Memory for passes that write every element before they read it.
#pragma once

#include "snell/bvh/big_pages.h"

#include <span>
#include <type_traits>
#include <utility>

namespace snell {

// An array whose elements begin with no value, so that the threads which fill it are the first to touch it. std::vector
// would write it once more, and on one thread.
template <class T>
class Scratch
{
    static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

  public:
    Scratch() = default;
    explicit Scratch(std::size_t count) : data_(BigPageAllocator<T>().allocate(count)), size_(count) {}
    Scratch(Scratch&& other) noexcept { swap(other); }
    Scratch& operator=(Scratch&& other) noexcept
    {
        swap(other);
        return *this;
    }
    ~Scratch() { free_big(data_); }

    void swap(Scratch& other) noexcept
    {
        std::swap(data_, other.data_);
        std::swap(size_, other.size_);
    }
    std::size_t size() const { return size_; }
    T* data() { return data_; }
    const T* data() const { return data_; }
    T& operator[](std::size_t i) { return data_[i]; }
    const T& operator[](std::size_t i) const { return data_[i]; }
    operator std::span<T>() { return {data_, size_}; }
    operator std::span<const T>() const { return {data_, size_}; }

  private:
    T* data_ = nullptr;
    std::size_t size_ = 0;
};

} // namespace snell
