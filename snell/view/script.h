// A text file that drives the viewer: for tests, demonstrations and bug reports. docs/viewer.md lists the commands.
#pragma once

#include "snell/core/vec.h"
#include "snell/view/keys.h"

#include <deque>
#include <filesystem>
#include <functional>
#include <random>
#include <string>
#include <vector>

namespace snell::view {

class App;

struct ScriptLine
{
    int number = 0;
    std::vector<std::string> words; // the command and its arguments; what is in quotes is one
};

// Splits a script into its lines and checks them. Throws Error, with file and line: a quote without end, no such
// command, too few or too many arguments, a number that is none.
std::vector<ScriptLine> parse_script(const std::string& text, const std::string& file);

class Script
{
  public:
    // Throws Error if the file cannot be read, or as parse_script() does.
    explicit Script(std::filesystem::path file);

    // Does what can be done before the next frame. An assertion that fails, or a wait that takes more than a minute,
    // ends the viewer with code 1; a command that cannot be carried out with code 2. Input goes through SDL's queue.
    void step(App& app);
    // A frame has to be drawn for it to go on.
    bool wants_frame() const { return wants_frame_; }

  private:
    using Step = std::function<bool(App&)>; // true: done

    void run(App& app, const ScriptLine& line);
    void then(Step step) { steps_.push_back(std::move(step)); }
    void then_frames(int count);
    void then_wait(const std::string& what, std::function<bool(App&)> is_so);
    void then_key(const KeyName& key);
    void then_press(const std::string& label, const std::string& how);
    void then_click(float x, float y, const std::string& how);
    void then_drag(float x0, float y0, float x1, float y1, const std::string& how);
    void then_random(double seconds, uint seed);
    void check(App& app, const ScriptLine& line);

    std::filesystem::path file_;
    std::vector<ScriptLine> lines_;
    std::size_t next_ = 0;
    std::deque<Step> steps_; // of the line under way
    bool wants_frame_ = false;
    std::mt19937 random_;
};

} // namespace snell::view
