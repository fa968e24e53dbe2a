// Ctrl-C: the first one asks the render to stop, the second one ends the program at once.
#pragma once

#include <atomic>

namespace snell::app {

// Catches SIGINT and SIGTERM while it lives.
class InterruptGuard
{
  public:
    InterruptGuard();
    ~InterruptGuard();
    InterruptGuard(const InterruptGuard&) = delete;
    InterruptGuard& operator=(const InterruptGuard&) = delete;

    // True from the first signal on.
    const std::atomic<bool>& flag() const;
    // What the program should exit with, as shells have it: 128 + signal number; 0 if there was no signal.
    int exit_code() const;
};

} // namespace snell::app
