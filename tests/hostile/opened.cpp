#include "opened.h"

#include "memory.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <csignal>
#include <cstring>
#include <ctime>
#include <fstream>
#include <map>

namespace fs = std::filesystem;

namespace snell::hostile {

namespace {

// Says which file hangs, and ends the program.
char in_hand[256] = "nothing";
void stop(int)
{
    constexpr char text[] = "a file takes more than a minute: ";
    [[maybe_unused]] ssize_t ignored = ::write(2, text, sizeof text - 1);
    ignored = ::write(2, in_hand, std::strlen(in_hand));
    ::_exit(1);
}

std::string keep(const Format& format, std::string_view bytes, const std::string& about)
{
    std::string name = format.name + "-" + about + "-" + format.file;
    for (char& c : name)
        if (c == '/' || c == ' ') c = '_';
    const fs::path file = fs::temp_directory_path() / name;
    std::ofstream(file, std::ios::binary) << bytes;
    return file.string();
}

} // namespace

std::size_t memory_bound(const Format& format, std::size_t file_size)
{
    constexpr std::size_t mib = 1 << 20;
    // For any file of the kind, and for each of its bytes.
    struct Bound
    {
        std::size_t base, factor;
    };
    static const std::map<std::string, Bound> bounds = {
        // Windows over the file. A line such as "f 1 2 3" becomes indices in several forms.
        {"obj", {10 * mib, 200}},
        {"mtl", {10 * mib, 200}},
        {"ply", {6 * mib, 200}},
        {"stl", {6 * mib, 200}},
        {"gz", {70 * mib, 200 * 20}}, // what it inflates to, up to 64 MiB or 200 times its size, in windows
        {"spd", {2 * mib, 200}},
        // Accessors of zeros, and loop subdivision: geometry that takes few bytes in the file, up to a limit.
        {"gltf", {320 * mib, 600}},
        {"glb", {320 * mib, 600}},
        {"pbrt", {256 * mib, 600}},
        // Texels for a byte, times what one takes as RGBA (or four floats) and as three floats in the end.
        {"png", {6 * mib, 1032 * 8 * (4 + 12)}}, // Deflate packs at most 1032 to 1; one bit a texel
        {"jpg", {2 * mib, 1024 * (16 + 12)}},    // a bit for each block of 64, in planes at first
        {"hdr", {2 * mib, 1024 * (16 + 12)}},    // runs
        {"tga", {2 * mib, 64 * (4 + 4 + 12)}},   // runs of 128 texels in two bytes
        {"bmp", {2 * mib, 8 * (4 + 4 + 12)}},
        {"pfm", {2 * mib, 16 + 12}},
        // Flat pictures of usual sizes (2^24 texels) are good files of a few dozen bytes.
        {"webp", {24 * 16 * mib, 4096 * (4 + 4 + 12)}},
        {"lens", {2 * mib, 200}}, // pupils, threads
        {"calibration", {2 * mib, 200}},
        {"exr", {64 * mib + 28 * 16 * mib, 4096 * (16 + 16 + 12)}},
    };
    const Bound& bound = bounds.at(format.name);
    return bound.base + bound.factor * file_size;
}

double time_bound(std::size_t file_size)
{
#if defined(SNELL_SANITIZED)
    constexpr double factor = 10;
#else
    constexpr double factor = 1;
#endif
    return factor * (2.0 + 1e-5 * static_cast<double>(file_size));
}

Opened open_checked(const Format& format, const Nest& nest, std::string_view bytes, const std::string& about)
{
    nest.put(bytes);
    const std::string label = format.name + ", " + about;
    label.copy(in_hand, sizeof in_hand - 1);
    in_hand[std::min(label.size(), sizeof in_hand - 1)] = '\0';
    std::signal(SIGALRM, stop);
    ::alarm(60);

    Opened opened;
    reset_memory_peak();
    const std::size_t before = memory_in_use();
    const std::clock_t start = std::clock();
    bool is_good = true;
    try {
        if (const std::optional<Error> error = nest.open()) opened.error.emplace(*error);
    } catch (const std::exception& other) {
        ADD_FAILURE() << label << ": no Error, but " << other.what();
        is_good = false;
    }
    opened.seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    opened.peak_bytes = memory_peak() - before;
    ::alarm(0);

    EXPECT_LE(opened.seconds, time_bound(bytes.size())) << label;
    EXPECT_LE(opened.peak_bytes, memory_bound(format, bytes.size())) << label << ", " << bytes.size() << " bytes";
    is_good = is_good && opened.seconds <= time_bound(bytes.size()) &&
              opened.peak_bytes <= memory_bound(format, bytes.size());
    if (opened.error) {
        const Error& error = *opened.error;
        const std::string text = error.what();
        bool names_file = text.starts_with(nest.folder().string());
        for (const char* const outside : {"/dev/", "/proc/", "/etc/"}) names_file |= text.starts_with(outside);
        EXPECT_TRUE(names_file) << label << ": the message does not begin with the file's name: " << error.what();
        is_good = is_good && names_file;
    }
    if (!is_good) std::cout << "kept as " << keep(format, bytes, about) << "\n";
    return opened;
}

} // namespace snell::hostile
