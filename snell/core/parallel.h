// Threads, thin over oneTBB.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>

namespace snell {

// Limits all later parallel work to that many threads (0: as many as the machine has), until changed again.
void set_thread_count(int threads);
int thread_count();

// While one lives, what its thread does through the functions below, and what that does in turn, can be stopped: soon
// after `cancel` has become true they throw Cancelled. What the calls were to fill is then of no use.
class CancelScope
{
  public:
    explicit CancelScope(const std::atomic<bool>& cancel);
    ~CancelScope();
    CancelScope(const CancelScope&) = delete;
    CancelScope& operator=(const CancelScope&) = delete;

  private:
    const std::atomic<bool>* outer_;
};

// No std::exception: nothing went wrong, and nobody on the way is to take it for a failure that it can mend.
struct Cancelled
{
};

// Calls body(i) for each i in [0, count), in any order, from several threads. An exception from a body stops the rest
// and is thrown here.
void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body);

// Calls body(begin, end) on ranges that cover [0, count), each at least `grain` long where possible.
void parallel_ranges(std::size_t count, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body);

// Calls both, perhaps at the same time, and returns when both are done. For recursion: calls may nest. If both throw,
// one of the exceptions is thrown here.
void parallel_both(const std::function<void()>& first, const std::function<void()>& second);

} // namespace snell
