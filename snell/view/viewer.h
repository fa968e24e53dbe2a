// The viewer: a window that shows a scene, and lets one walk through it, change it and look inside.
#pragma once

#include "snell/io/load.h"
#include "snell/render/settings.h"

#include <filesystem>
#include <functional>
#include <string>

namespace snell::view {

struct ViewOptions
{
    std::string scene; // a built-in scene or a file; empty: none yet
    // Opens a scene by that name; may throw. Called on another thread.
    std::function<Scene(const std::string& name, const LoadProgressCallback& progress)> load;
    RenderSettings settings; // of the first pane; width and height are the window's
    float exposure_ev = 0.0f;
    uint curve = 0; // tone_*
    int width = 1280, height = 720;
    float ui_scale = 0.0f; // 0: by the display
    bool is_light = false;
    double target_ms = 16.0;      // of the governor
    std::filesystem::path script; // empty: none
    std::string record;           // pattern of the pictures along the camera path: then the viewer ends by itself
    std::filesystem::path path;   // file of views for the path; empty: those that were stored
    uint record_frames = 0;
    bool keeps_recent = true;      // reads and writes the list of recent files
    std::filesystem::path timings; // JSON of latencies and frame times, written when the window closes; empty: none
};

// Throws Error, with file and line, if the script cannot be read or makes no sense.
void check_script(const std::filesystem::path& file);

// Returns the program's exit code when the window is closed. Throws Error if no window can be opened.
int run_viewer(const ViewOptions& options);

} // namespace snell::view
