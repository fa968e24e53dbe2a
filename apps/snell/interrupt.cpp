#include "interrupt.h"

#include <csignal>

#include <unistd.h>

namespace snell::app {

static std::atomic<bool> stop = false;
static std::atomic<int> caught = 0;
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free);

extern "C" {
static void on_signal(int number)
{
    if (stop.exchange(true)) _exit(128 + number);
    caught = number;
}
}

InterruptGuard::InterruptGuard()
{
    stop = false;
    caught = 0;
    std::signal(SIGINT, on_signal);
    std::signal(SIGTERM, on_signal);
}

InterruptGuard::~InterruptGuard()
{
    std::signal(SIGINT, SIG_DFL);
    std::signal(SIGTERM, SIG_DFL);
}

const std::atomic<bool>& InterruptGuard::flag() const
{
    return stop;
}

int InterruptGuard::exit_code() const
{
    return caught ? 128 + caught.load() : 0;
}

} // namespace snell::app
