#include "snell/core/parallel.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_invoke.h>

#include <memory>

#ifdef __SANITIZE_THREAD__
#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>
#endif

namespace snell {

static std::unique_ptr<tbb::global_control> limit;
static int limit_threads = 0;

void set_thread_count(int threads)
{
    limit.reset();
    limit_threads = threads;
    if (threads > 0)
        limit = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                      static_cast<std::size_t>(threads));
}

int thread_count()
{
    return limit_threads > 0 ? limit_threads : tbb::info::default_concurrency();
}

#ifdef __SANITIZE_THREAD__

// The packaged oneTBB is not instrumented, so the thread sanitizer cannot see that it hands work over properly and
// would take every use of it for a race. Under it, the same contract is kept by plain threads.
static thread_local bool inside = false; // a worker: what it calls runs on the spot

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body)
{
    const std::size_t threads = std::min<std::size_t>(count, static_cast<std::size_t>(std::max(thread_count(), 4)));
    if (inside || threads < 2 || limit_threads == 1) {
        for (std::size_t i = 0; i < count; ++i) body(i);
        return;
    }
    std::atomic<std::size_t> next = 0;
    std::exception_ptr thrown;
    std::mutex mutex;
    std::vector<std::thread> workers;
    for (std::size_t t = 0; t < threads; ++t)
        workers.emplace_back([&] {
            inside = true;
            try {
                for (std::size_t i; (i = next++) < count;) body(i);
            } catch (...) {
                const std::lock_guard lock(mutex);
                if (!thrown) thrown = std::current_exception();
                next = count;
            }
        });
    for (std::thread& worker : workers) worker.join();
    if (thrown) std::rethrow_exception(thrown);
}

void parallel_ranges(std::size_t count, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body)
{
    grain = std::max<std::size_t>(grain, 1);
    parallel_for((count + grain - 1) / grain,
                 [&](std::size_t i) { body(i * grain, std::min(count, (i + 1) * grain)); });
}

void parallel_both(const std::function<void()>& first, const std::function<void()>& second)
{
    parallel_for(2, [&](std::size_t i) { i == 0 ? first() : second(); });
}

#else

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body)
{
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, count, 1),
        [&](const tbb::blocked_range<std::size_t>& range) {
            for (std::size_t i = range.begin(); i != range.end(); ++i) body(i);
        },
        tbb::simple_partitioner());
}

void parallel_ranges(std::size_t count, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body)
{
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain),
                      [&](const tbb::blocked_range<std::size_t>& range) { body(range.begin(), range.end()); });
}

void parallel_both(const std::function<void()>& first, const std::function<void()>& second)
{
    tbb::parallel_invoke(first, second);
}

#endif

} // namespace snell
