#include "snell/core/parallel.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_invoke.h>
#include <oneapi/tbb/task_group.h>

#include <memory>
#include <mutex>

#ifdef __SANITIZE_THREAD__
#include <algorithm>
#include <exception>
#include <thread>
#include <vector>
#endif

namespace snell {

static std::mutex limit_mutex;
static std::unique_ptr<tbb::global_control> limit;
static std::atomic<int> limit_threads = 0;

void set_thread_count(int threads)
{
    const std::lock_guard lock(limit_mutex);
    if (threads == limit_threads) return;
    limit.reset();
    limit_threads = threads;
    if (threads > 0)
        limit = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                      static_cast<std::size_t>(threads));
}

int thread_count()
{
    const int threads = limit_threads;
    return threads > 0 ? threads : tbb::info::default_concurrency();
}

// Of the work that this thread does at present; null: it cannot be cancelled. Goes with the work to other threads.
static thread_local const std::atomic<bool>* cancel_flag = nullptr;

CancelScope::CancelScope(const std::atomic<bool>& cancel) : outer_(cancel_flag)
{
    cancel_flag = &cancel;
}

CancelScope::~CancelScope()
{
    cancel_flag = outer_;
}

namespace {
// A worker that takes over work of another thread, for as long.
class Takeover
{
  public:
    explicit Takeover(const std::atomic<bool>* flag) : own_(cancel_flag) { cancel_flag = flag; }
    ~Takeover() { cancel_flag = own_; }
    Takeover(const Takeover&) = delete;
    Takeover& operator=(const Takeover&) = delete;

  private:
    const std::atomic<bool>* own_;
};
} // namespace

static void stop_if_cancelled()
{
    if (cancel_flag != nullptr && *cancel_flag) throw Cancelled();
}

#ifdef __SANITIZE_THREAD__

// The packaged oneTBB is not instrumented, so the thread sanitizer cannot see that it hands work over properly and
// would take every use of it for a race. Under it, the same contract is kept by plain threads.
static thread_local bool inside = false; // a worker: what it calls runs on the spot

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body)
{
    const std::size_t threads = std::min<std::size_t>(count, static_cast<std::size_t>(std::max(thread_count(), 4)));
    if (inside || threads < 2 || limit_threads == 1) {
        for (std::size_t i = 0; i < count; ++i) {
            stop_if_cancelled();
            body(i);
        }
        return;
    }
    const std::atomic<bool>* const flag = cancel_flag;
    std::atomic<std::size_t> next = 0;
    std::exception_ptr thrown;
    std::mutex mutex;
    std::vector<std::thread> workers;
    for (std::size_t t = 0; t < threads; ++t)
        workers.emplace_back([&] {
            inside = true;
            const Takeover takeover(flag);
            try {
                for (std::size_t i; (i = next++) < count;) {
                    stop_if_cancelled();
                    body(i);
                }
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

// When work elsewhere in a nest of calls has thrown, oneTBB leaves out what is still to be done in all of it, and inner
// calls return as if it had been: whoever called them must not go on with half of it.
static void check_complete(tbb::task_group_context& context)
{
    if (context.is_group_execution_cancelled()) throw Cancelled();
}

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body)
{
    const std::atomic<bool>* const flag = cancel_flag;
    tbb::task_group_context context;
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, count, 1),
        [&](const tbb::blocked_range<std::size_t>& range) {
            const Takeover takeover(flag);
            for (std::size_t i = range.begin(); i != range.end(); ++i) {
                stop_if_cancelled();
                body(i);
            }
        },
        tbb::simple_partitioner(), context);
    check_complete(context);
}

void parallel_ranges(std::size_t count, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body)
{
    const std::atomic<bool>* const flag = cancel_flag;
    tbb::task_group_context context;
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, count, grain),
        [&](const tbb::blocked_range<std::size_t>& range) {
            const Takeover takeover(flag);
            stop_if_cancelled();
            body(range.begin(), range.end());
        },
        context);
    check_complete(context);
}

void parallel_both(const std::function<void()>& first, const std::function<void()>& second)
{
    const std::atomic<bool>* const flag = cancel_flag;
    const auto run = [flag](const std::function<void()>& part) {
        const Takeover takeover(flag);
        stop_if_cancelled();
        part();
    };
    tbb::task_group_context context;
    tbb::parallel_invoke([&] { run(first); }, [&] { run(second); }, context);
    check_complete(context);
}

#endif

} // namespace snell
