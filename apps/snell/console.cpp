#include "console.h"

#include "snell/core/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <map>

#include <unistd.h>

namespace snell::app {

Console& console()
{
    static Console the_console;
    return the_console;
}

Console::~Console()
{
    if (log_) std::fclose(log_);
}

void Console::open_log(const std::filesystem::path& file)
{
    if (log_) std::fclose(log_);
    log_ = std::fopen(file.c_str(), "a");
    if (!log_)
        throw Error({file.string(), 0, 0}, fmt::format("cannot open the log file: {}", std::strerror(errno)),
                    "choose another place with --log-file");
}

void Console::say(std::string_view kind, std::string_view text, bool show)
{
    std::string line = fmt::format("snell: {}{}", kind, text);
    std::replace(line.begin(), line.end(), '\n', ' ');
    line += '\n';
    if (show) std::fwrite(line.data(), 1, line.size(), stderr);
    if (log_) {
        std::fwrite(line.data(), 1, line.size(), log_);
        std::fflush(log_);
    }
}

void Console::error(std::string_view text)
{
    say("error: ", text, true);
}
void Console::warning(std::string_view text)
{
    say("warning: ", text, level != Level::quiet);
}
void Console::info(std::string_view text)
{
    say("", text, level != Level::quiet);
}
void Console::detail(std::string_view text)
{
    say("", text, level == Level::verbose);
}

void Console::notes(const Scene& scene)
{
    constexpr int shown_of_a_kind = 3;
    std::map<std::string, int> seen;
    for (const Note& note : scene.notes) {
        std::string kind = note.text;
        std::erase_if(kind, [](unsigned char c) { return std::isdigit(c) != 0; });
        if (++seen[kind] > shown_of_a_kind && level != Level::verbose) continue;
        if (note.kind == Note::Kind::warning)
            warning(note.text);
        else
            info(note.text);
    }
    if (level == Level::verbose) return;
    for (const auto& [kind, count] : seen)
        if (count > shown_of_a_kind)
            info(fmt::format("and {} more like the last of these:{}{}; -v shows all", count - shown_of_a_kind,
                             kind.starts_with(' ') ? "" : " ", kind));
}

ProgressLine::ProgressLine(uint spp) : spp_(spp), terminal_(isatty(STDERR_FILENO) == 1) {}

ProgressLine::~ProgressLine()
{
    if (terminal_ && shown_) std::fputs("\r\033[K", stderr);
}

static std::string clock_time(double seconds)
{
    const long whole = std::lround(std::clamp(seconds, 0.0, 3.6e6));
    if (whole >= 3600) return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
    return fmt::format("{}:{:02}", whole / 60, whole % 60);
}

void ProgressLine::update(const Progress& progress)
{
    if (console().level == Console::Level::quiet) return;
    const auto now = Clock::now();
    const std::chrono::duration<double> pause =
        terminal_ ? std::chrono::duration<double>(0.1) : std::chrono::duration<double>(3.0);
    if (now - last_ < pause) return;
    last_ = now;

    const double elapsed = std::chrono::duration<double>(now - started_).count();
    const double fraction = std::clamp(progress.fraction, 0.0, 1.0);
    const std::string left = fraction > 0.0 ? clock_time(elapsed * (1.0 - fraction) / fraction) : "-:--";
    const std::string facts =
        fmt::format("{:3.0f}%  {:.0f}/{} spp  {}rays/s  {} elapsed, {} left", std::floor(100.0 * fraction),
                    std::floor(fraction * spp_), spp_,
                    short_count(static_cast<double>(progress.stats.rays()) / elapsed), clock_time(elapsed), left);
    if (terminal_) {
        constexpr int width = 20;
        const auto done = static_cast<std::size_t>(fraction * width);
        const std::string bar = std::string(done, '#') + std::string(width - done, '.');
        std::fputs(fmt::format("\r\033[K[{}] {}", bar, facts).c_str(), stderr);
        std::fflush(stderr);
        shown_ = true;
    } else {
        console().info(facts);
    }
}

std::string short_count(double value)
{
    const char* unit = "";
    for (const char* next : {"k", "M", "G", "T"}) {
        if (std::abs(value) < 1000.0) break;
        value /= 1000.0;
        unit = next;
    }
    return *unit ? fmt::format("{:.3g} {}", value, unit) : fmt::format("{:.0f} ", value);
}

std::string short_bytes(double bytes)
{
    const char* unit = "B";
    for (const char* next : {"KiB", "MiB", "GiB", "TiB"}) {
        if (bytes < 1000.0) break;
        bytes /= 1024.0;
        unit = next;
    }
    return fmt::format("{:.3g} {}", bytes, unit);
}

std::string short_time(double seconds)
{
    if (seconds < 60.0) return fmt::format("{:.{}f} s", seconds, seconds < 10.0 ? 2 : 1);
    return clock_time(seconds) + (seconds < 3600.0 ? " min" : " h");
}

} // namespace snell::app
