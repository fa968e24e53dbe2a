// Writing pictures. Every file is written to a temporary name beside it and renamed: an interrupted write never leaves
// half a picture, and never destroys the previous one.
#pragma once

#include "snell/io/image/image.h"
#include "snell/kernel/tone.h"

namespace snell {

// How a picture becomes display values in 8-bit files; float files (.exr .hdr .pfm) are written scene-linear.
struct DisplayTransform
{
    float exposure_ev = 0.0f;
    uint curve = tone_none; // tone_*
};

// By ending: .exr (float32, with layers), .png (8 bit, sRGB curve, dithered; with Layers::alpha, not multiplied into
// the colours; Layers::attributes are chunks iTXt), .hdr, .pfm. Throws Error.
void write_picture(const std::filesystem::path& file, const Picture& picture, const Layers& layers = {},
                   const DisplayTransform& display = {});

// Throws Error unless the ending is one that write_picture knows and the folder exists and can be written to: ask
// before rendering for an hour.
void check_writable(const std::filesystem::path& file);

} // namespace snell
