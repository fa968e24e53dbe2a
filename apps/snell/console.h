// What the program says while it works. Everything goes to stderr; stdout is for results.
#pragma once

#include "snell/io/load.h"
#include "snell/render/render.h"
#include "snell/scene/scene.h"

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>

namespace snell::app {

class Console
{
  public:
    enum class Level
    {
        quiet, // errors only
        normal,
        verbose
    };
    Level level = Level::normal;

    ~Console();

    // From now on every message is appended to that file as well. Throws Error.
    void open_log(const std::filesystem::path& file);

    // One line each; line breaks and other control characters in the text become spaces.
    void error(std::string_view text);
    void warning(std::string_view text);
    void info(std::string_view text);
    void detail(std::string_view text); // only if verbose

    // The scene's notes. Of those that differ in numbers only, the first few are shown and the others counted.
    void notes(const Scene& scene);

  private:
    void say(std::string_view kind, std::string_view text, bool show);
    std::FILE* log_ = nullptr;
};

// The one that main and all subcommands share.
Console& console();

// Progress of a render: a bar on a terminal, else a line every few seconds; nothing if the console is quiet.
class ProgressLine
{
  public:
    // label: begins the line, such as "frame 3/24  ".
    explicit ProgressLine(uint spp, std::string label = {});
    ~ProgressLine(); // leaves a clean line behind

    void update(const Progress& progress);

  private:
    using Clock = std::chrono::steady_clock;
    uint spp_;
    std::string label_;
    bool terminal_, shown_ = false;
    Clock::time_point started_ = Clock::now(), last_ = started_;
};

// Progress of loading a scene, in the same way.
class LoadLine
{
  public:
    LoadLine();
    ~LoadLine(); // leaves a clean line behind

    void update(const LoadProgress& progress);

  private:
    using Clock = std::chrono::steady_clock;
    bool terminal_, shown_ = false;
    Clock::time_point last_ = Clock::now();
};

// "950 ", "12.3 k", "4.56 M", "1.2 G": a unit goes right behind it.
std::string short_count(double value);
// "640 B", "12.3 KiB", "4.56 MiB".
std::string short_bytes(double bytes);
// "0.42 s", "12.3 s", "2:05 min", "3:02:05 h".
std::string short_time(double seconds);

} // namespace snell::app
