// What `snell render` was asked for.
#pragma once

#include "camera_choice.h"
#include "commands.h"

#include "snell/io/image/write.h"
#include "snell/render/settings.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace snell::app {

enum class StatsReport
{
    closing, // one line at the end
    text,
    json
};

struct RenderJob
{
    std::string scene;
    std::vector<std::filesystem::path> outputs; // at least one
    RenderSettings settings;
    CameraChoice camera;
    DisplayTransform display;
    StatsReport stats = StatsReport::closing;
    std::string command_line; // for the picture's attributes
};

// Reads the command line into job and checks all that can be checked without the scene. Exit code if there is nothing
// to render (--help). Throws UsageError; Error if an output cannot be written.
std::optional<int> parse_render(const Arguments& arguments, RenderJob& job);

} // namespace snell::app
