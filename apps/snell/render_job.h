// What `snell render` was asked for.
#pragma once

#include "camera_choice.h"
#include "commands.h"
#include "scene_choice.h"
#include "sequence.h"

#include "snell/io/image/write.h"
#include "snell/render/settings.h"

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace snell::app {

enum class StatsReport
{
    closing, // one line at the end
    text,
    json
};

// What the command line says itself of matters that a scene may have wishes for.
struct Asked
{
    std::optional<int> width, height;
    std::optional<uint> spp, seed;
    std::optional<std::pair<uint, uint>> samples_range;
    std::optional<std::string> integrator, sampler;
    std::string crop_window, pixel_bounds, pixel;
    std::optional<bool> layers;
    std::vector<std::string> outputs;
};

struct RenderJob
{
    SceneChoice scene;
    CameraChoice camera;
    Asked asked;
    std::optional<FrameRange> frames; // of a sequence
    DisplayTransform display;
    StatsReport stats = StatsReport::closing;
    bool is_stereo = false;   // a picture for each eye
    std::string command_line; // for the pictures' attributes
    RenderSettings settings;  // those that nobody but the command line has a say in; settle_render() adds the rest

    // What settle_render() finds.
    std::vector<std::filesystem::path> outputs; // at least one, of a still
    std::vector<FramePattern> patterns;         // at least one, of a sequence

    // Of one picture of a sequence: its number.
    std::optional<uint> frame;
};

// Reads the command line into job and checks all that can be checked without the scene. Exit code if there is nothing
// to render (--help). Throws UsageError; Error if an output cannot be written.
std::optional<int> parse_render(const Arguments& arguments, RenderJob& job);

// Completes settings and outputs: the command line goes first, then the scene's hints, then the defaults. Which hints
// were taken is said if the console is verbose. Throws UsageError; Error if an output cannot be written.
void settle_render(RenderJob& job, const RenderHints& hints);

// The part of settle_render() that writes no files: settings alone. For commands that make no picture.
void settle_settings(RenderJob& job, const RenderHints& hints);

// --integrator, -D, --sampler, --seed, --samples-range, --accel, --accel-cache and --triangle-test.
void add_technique_options(Options& options, RenderJob& job);

} // namespace snell::app
