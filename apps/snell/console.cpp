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

// Names from files must not move the cursor.
static std::string printable(std::string_view text)
{
    std::string line(text);
    const auto is_control = [](char c) { return (c >= 0 && c < ' ') || c == '\x7f'; };
    std::replace_if(line.begin(), line.end(), is_control, ' ');
    return line;
}

void Console::say(std::string_view kind, std::string_view text, bool show)
{
    const std::string line = fmt::format("snell: {}{}\n", kind, printable(text));
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

ProgressLine::ProgressLine(uint spp, std::string label)
    : spp_(spp), label_(std::move(label)), terminal_(isatty(STDERR_FILENO) == 1)
{
}

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

// Whether it is time for another line.
static bool is_due(bool terminal, std::chrono::steady_clock::time_point& last)
{
    if (console().level == Console::Level::quiet) return false;
    const auto now = std::chrono::steady_clock::now();
    if (now - last < std::chrono::duration<double>(terminal ? 0.1 : 3.0)) return false;
    last = now;
    return true;
}

static void show_bar(double fraction, const std::string& label, const std::string& facts)
{
    constexpr int width = 20;
    const auto done = static_cast<std::size_t>(fraction * width);
    const std::string bar = std::string(done, '#') + std::string(width - done, '.');
    std::fputs(fmt::format("\r\033[K{}[{}] {}", label, bar, facts).c_str(), stderr);
    std::fflush(stderr);
}

void ProgressLine::update(const Progress& progress)
{
    if (!is_due(terminal_, last_)) return;

    const double elapsed = std::chrono::duration<double>(last_ - started_).count();
    const double fraction = std::clamp(progress.fraction, 0.0, 1.0);
    const std::string left = fraction > 0.0 ? clock_time(elapsed * (1.0 - fraction) / fraction) : "-:--";
    const std::string facts =
        fmt::format("{:3.0f}%  {:.0f}/{} spp  {}rays/s  {} elapsed, {} left", std::floor(100.0 * fraction),
                    std::floor(fraction * spp_), spp_,
                    short_count(static_cast<double>(progress.stats.rays()) / elapsed), clock_time(elapsed), left);
    if (terminal_) {
        show_bar(fraction, label_, facts);
        shown_ = true;
    } else {
        console().info(label_ + facts);
    }
}

LoadLine::LoadLine() : terminal_(isatty(STDERR_FILENO) == 1) {}

LoadLine::~LoadLine()
{
    if (terminal_ && shown_) std::fputs("\r\033[K", stderr);
}

void LoadLine::update(const LoadProgress& progress)
{
    if (!is_due(terminal_, last_)) return;
    const double fraction = std::clamp(progress.fraction, 0.0, 1.0);
    std::string what = printable(progress.what);
    constexpr std::size_t room = 50; // of a terminal's line
    if (what.size() > room) what = what.substr(0, room - 3) + "...";
    if (terminal_) {
        show_bar(fraction, "", fmt::format("{:3.0f}%  {}", std::floor(100.0 * fraction), what));
        shown_ = true;
    } else {
        console().info(fmt::format("{:3.0f}%  {}", std::floor(100.0 * fraction), what));
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
