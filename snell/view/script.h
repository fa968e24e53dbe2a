// A text file that drives the viewer: for tests, demonstrations and bug reports. docs/viewer.md lists the commands.
#pragma once

#include "snell/core/vec.h"

#include <deque>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace snell::view {

class App;

struct ScriptLine
{
    int number = 0;
    std::vector<std::string> words; // the command and its arguments; what is in quotes is one
};

// Splits a script into its lines. Throws Error, with file and line, for a quote without end.
std::vector<ScriptLine> parse_script(const std::string& text, const std::string& file);

class Script
{
  public:
    // Reads and checks it. Throws Error with file:line: there is no such command, an argument is missing or none.
    explicit Script(std::filesystem::path file);

    // What can be done before the next frame. An assertion that fails ends the viewer with code 1, a command that
    // cannot be carried out with code 2.
    void step(App& app);
    // A frame has to be drawn for it to go on.
    bool wants_frame() const { return wants_frame_; }

  private:
    bool run(App& app, const ScriptLine& line);
    bool wants_frame_ = false;
    std::filesystem::path file_;
    std::vector<ScriptLine> lines_;
    std::size_t next_ = 0;
};

} // namespace snell::view
