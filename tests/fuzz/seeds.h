// Small good files to begin from: those in corpus/, and those that are easier made than kept.
#pragma once

#include "formats.h"

#include <cstdint>
#include <string>
#include <vector>

namespace snell::hostile {

struct Seed
{
    std::string name;
    std::string bytes;
    bool is_good = true; // it can be opened; else it is in the corpus because it once did harm
};

// The files of corpus/<format> (those that are named broken_* are not good) and made_seeds(format), in a fixed order.
std::vector<Seed> seeds(const Format& format);

// 2 x 2 texels, RGBA.
std::string small_png();

// Made by code; empty for the other formats.
std::vector<Seed> made_image_seeds(const std::string& format);
std::vector<Seed> made_exr_seeds();
std::vector<Seed> made_mesh_seeds(const std::string& format);
std::vector<Seed> made_gltf_seeds(const std::string& format);

// A file in memory, number by number.
struct Bytes
{
    std::string text;
    bool is_big = false; // byte order

    template <class T>
    Bytes& put(T value)
    {
        const char* const p = reinterpret_cast<const char*>(&value);
        for (std::size_t i = 0; i < sizeof(T); ++i) text += p[is_big ? sizeof(T) - 1 - i : i];
        return *this;
    }
    Bytes& add(std::string_view more)
    {
        text += more;
        return *this;
    }
};

} // namespace snell::hostile
