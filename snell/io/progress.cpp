#include "snell/io/progress.h"

#include <algorithm>
#include <chrono>

namespace snell {

std::function<void(double)> reading_progress(const LoadOptions& options, const std::filesystem::path& file)
{
    using Clock = std::chrono::steady_clock;
    if (!options.progress) return [](double) {};
    const std::string what = "reading " + file.filename().string();
    const auto tell = [what, callback = options.progress](double part) {
        constexpr double share_of_reading = 0.9;
        callback({what, share_of_reading * part});
    };
    tell(0.0);
    return [tell, told = 0.0, time = Clock::now()](double part) mutable {
        part = std::clamp(part, told, 1.0);
        const bool is_mark = (told < 0.5 && part >= 0.5) || (told < 1.0 && part == 1.0);
        const Clock::time_point now = Clock::now();
        if (!is_mark && now - time < std::chrono::milliseconds(250)) return;
        told = part;
        time = now;
        tell(part);
    };
}

} // namespace snell
