// Sanitizers have their own malloc, and tell of each call; without them this file is malloc, over glibc's.
#include "memory.h"

#include <malloc.h>

#include <atomic>
#include <cerrno>
#include <cstdint>

namespace snell::hostile {

namespace {

std::atomic<std::size_t> in_use{0}, peak{0};

void add(std::size_t bytes)
{
    const std::size_t now = in_use.fetch_add(bytes, std::memory_order_relaxed) + bytes;
    std::size_t most = peak.load(std::memory_order_relaxed);
    while (now > most && !peak.compare_exchange_weak(most, now, std::memory_order_relaxed)) {
    }
}

void remove(std::size_t bytes)
{
    // What was taken before the counting began is given back, too.
    std::size_t now = in_use.load(std::memory_order_relaxed);
    while (!in_use.compare_exchange_weak(now, now - (bytes < now ? bytes : now), std::memory_order_relaxed)) {
    }
}

} // namespace

std::size_t memory_in_use()
{
    return in_use.load();
}
std::size_t memory_peak()
{
    return peak.load();
}
void reset_memory_peak()
{
    peak.store(in_use.load());
}

} // namespace snell::hostile

#if defined(SNELL_SANITIZED)

// As <sanitizer/allocator_interface.h>, which g++ 12 comes without, has them.
extern "C" {
int __sanitizer_install_malloc_and_free_hooks(void (*on_malloc)(const volatile void*, std::size_t),
                                              void (*on_free)(const volatile void*));
std::size_t __sanitizer_get_allocated_size(const volatile void* p);
}

namespace {

void on_malloc(const volatile void*, std::size_t size)
{
    snell::hostile::add(size);
}
void on_free(const volatile void* p)
{
    if (p != nullptr) snell::hostile::remove(__sanitizer_get_allocated_size(p));
}

[[maybe_unused]] const int hooks = __sanitizer_install_malloc_and_free_hooks(on_malloc, on_free);

} // namespace

#else

// glibc lets a program replace these as a set, and keeps its own under other names.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* p, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void __libc_free(void* p);

static void* counted(void* p)
{
    if (p != nullptr) snell::hostile::add(::malloc_usable_size(p));
    return p;
}

void* malloc(std::size_t size)
{
    return counted(__libc_malloc(size));
}
void* calloc(std::size_t count, std::size_t size)
{
    return counted(__libc_calloc(count, size));
}
void* realloc(void* p, std::size_t size)
{
    const std::size_t before = p == nullptr ? 0 : ::malloc_usable_size(p);
    void* const result = __libc_realloc(p, size);
    if (result != nullptr || size == 0) snell::hostile::remove(before);
    return counted(result);
}
void* memalign(std::size_t alignment, std::size_t size)
{
    return counted(__libc_memalign(alignment, size));
}
void* aligned_alloc(std::size_t alignment, std::size_t size)
{
    return counted(__libc_memalign(alignment, size));
}
int posix_memalign(void** result, std::size_t alignment, std::size_t size)
{
    void* const p = counted(__libc_memalign(alignment, size));
    if (p == nullptr) return ENOMEM;
    *result = p;
    return 0;
}
void free(void* p)
{
    if (p != nullptr) snell::hostile::remove(::malloc_usable_size(p));
    __libc_free(p);
}
}

#endif
