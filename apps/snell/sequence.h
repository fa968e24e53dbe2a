// Sequences of pictures: which frames, when they are, and what their files are called.
#pragma once

#include "snell/core/vec.h"

#include <filesystem>
#include <string>

namespace snell::app {

struct FrameRange
{
    uint first = 0, end = 1; // frames [first, end)
    double fps = 24.0;

    uint count() const { return end - first; }
    double seconds(uint frame) const { return frame / fps; }
};

// How the pictures of a sequence are called: one %d or %04d stands for the number, %% for a percent sign. An output
// without number gets ".%04d" before its ending; that is how it is asked for: changed says so.
struct FramePattern
{
    std::string before, after;
    int digits = 0; // at least so many, with zeros in front
    bool changed = false;

    std::filesystem::path file(uint frame) const;
};

// Throws UsageError if there are two numbers, or a % that is neither a number nor doubled.
FramePattern parse_frame_pattern(const std::string& output);

} // namespace snell::app
