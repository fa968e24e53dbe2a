// Pictures in memory and on disk.
#pragma once

#include "snell/core/vec.h"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace snell {

// A float picture, linear Rec.709, three channels, row 0 at the top.
struct Picture
{
    int width = 0, height = 0;
    std::vector<vec3> pixels;

    vec3& at(int x, int y)
    {
        return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
    }
    const vec3& at(int x, int y) const { return const_cast<Picture*>(this)->at(x, y); }
};

// One named channel of a picture with layers, such as "Albedo.R"; either floats or unsigned integers (ids).
struct Channel
{
    std::string name;
    std::vector<float> floats;
    std::vector<std::uint32_t> ids; // written as UINT; used if floats is empty
};

// What goes into an EXR beside R, G, B.
struct Layers
{
    std::vector<Channel> channels;
    std::map<std::string, std::string> attributes; // string attributes: version, command line, seed, ...
    std::map<std::string, double> numbers;         // float attributes: spp, seconds
    // 16 values each, row by row, or empty. OpenEXR multiplies row vectors from the left: a translation is in the last
    // row.
    std::vector<float> world_to_camera, world_to_ndc;
    // Names of the views of a stereo picture, as OpenEXR's attribute multiView has them: the root channels are those of
    // the first one; the others' are among `channels`, named "right.R" or "Albedo.right.R". Empty: one view.
    std::vector<std::string> views;
    std::vector<float> alpha; // root channel A, multiplied into the picture; empty: 1 everywhere
};

} // namespace snell
