// Work that takes longer than a frame may, beside the user interface.
#pragma once

#include <chrono>
#include <functional>
#include <future>
#include <optional>

namespace snell::view {

// One calculation at a time, on a thread of its own. It may throw: take() then does. The destructor waits for it.
template <class Result>
class Background
{
  public:
    bool is_busy() const { return future_.valid(); }

    // Must not be busy.
    void start(std::function<Result()> work) { future_ = std::async(std::launch::async, std::move(work)); }

    // The result, once; nothing while it is not there.
    std::optional<Result> take()
    {
        if (!future_.valid() || future_.wait_for(std::chrono::seconds(0)) != std::future_status::ready)
            return std::nullopt;
        return future_.get();
    }

  private:
    std::future<Result> future_;
};

} // namespace snell::view
