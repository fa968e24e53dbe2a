// A flight along a camera path, as numbered pictures.
#pragma once

#include "snell/scene/scene.h"

#include <filesystem>
#include <string>
#include <vector>

namespace snell::view {

class App;

// "walk.%04d.png" and 7: walk.0007.png. Throws Error unless there is exactly one %d or %0Nd in the pattern.
std::filesystem::path numbered_file(const std::string& pattern, uint number);

class Recorder
{
  public:
    // Along a spline through the views, at least one. Throws Error as numbered_file() does, and if such a file cannot
    // be written.
    Recorder(std::string pattern, std::vector<CameraDesc> views, uint frames);

    // Between two frames of the window: writes a picture when it has the samples that were asked for, and moves on.
    // Returns whether that was the last one.
    bool step(App& app);

  private:
    void move(App& app) const;

    std::string pattern_;
    std::vector<CameraDesc> views_;
    uint frames_ = 0, next_ = 0;
    bool is_on_its_way_ = false;
};

} // namespace snell::view
