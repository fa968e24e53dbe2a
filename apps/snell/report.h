// What a render has to say about itself at the end.
#pragma once

#include "render_job.h"

#include "snell/render/render.h"

#include <cstddef>
#include <string>

namespace snell::app {

struct RenderReport
{
    const RenderJob& job;
    const RenderResult& result;
    std::size_t triangles = 0;
    double spp_done = 0; // mean over the pixels asked for
};

std::size_t peak_memory_bytes(); // of this process

// What following the scene into another pose took.
std::string update_line(const RenderStats& stats);

// The line that closes every render.
std::string closing_line(const RenderReport& report);

// The lines that --stats adds.
std::vector<std::string> stats_lines(const RenderReport& report);

// One line of JSON for programs; all times in seconds. Its keys are promised in the README.
std::string stats_json(const RenderReport& report);

} // namespace snell::app
