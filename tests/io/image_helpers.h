// For the tests of pictures: a folder that goes away, bytes in and out, and other people's encoders.
#pragma once

#include "snell/core/error.h"
#include "snell/io/image/image.h"

#include <gtest/gtest.h>

#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized" // seen by sanitizer builds
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

#include <cstdlib>
#include <fstream>
#include <sstream>

namespace snell {

namespace fs = std::filesystem;

class TemporaryFolder
{
  public:
    TemporaryFolder()
    {
        std::string pattern = (fs::temp_directory_path() / "snell-test-XXXXXX").string();
        path_ = mkdtemp(pattern.data());
    }
    ~TemporaryFolder()
    {
        std::error_code ignored;
        fs::remove_all(path_, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    fs::path operator/(const std::string& name) const { return path_ / name; }
    const fs::path& path() const { return path_; }
    std::size_t entries() const
    {
        return static_cast<std::size_t>(std::distance(fs::directory_iterator(path_), fs::directory_iterator()));
    }

  private:
    fs::path path_;
};

inline void put(const fs::path& file, const std::string& bytes)
{
    fs::remove(file); // some file systems make overwriting wait for the disk
    std::ofstream out(file, std::ios::binary);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    ASSERT_TRUE(out.good());
}

inline std::string get(const fs::path& file)
{
    std::ifstream in(file, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

// What an Error says, or "no error".
template <class F>
std::string error_of(F&& f)
{
    try {
        f();
    } catch (const Error& e) {
        return e.what();
    }
    return "no error";
}

inline bool contains(const std::string& text, const std::string& part)
{
    return text.find(part) != std::string::npos;
}

// Smooth in some places, noisy in others, over a wide range; the same each time.
inline Picture test_picture(int width, int height)
{
    Picture picture{width, height, {}};
    std::uint32_t state = 1;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            state = state * 1664525u + 1013904223u;
            float noise = static_cast<float>(state >> 8) * 0x1p-24f;
            float fx = static_cast<float>(x), fy = static_cast<float>(y);
            if (x > width / 2)
                picture.pixels.push_back(vec3(0.25f, 0.5f, 4.0f));
            else
                picture.pixels.push_back(vec3(0.01f * fx, noise * std::exp2(fy - 8.0f), 3.0f * noise));
        }
    }
    return picture;
}

// Encoded by stb_image_write from RGBA or RGB bytes.
inline void append_to_string(void* context, void* data, int size)
{
    static_cast<std::string*>(context)->append(static_cast<const char*>(data), static_cast<std::size_t>(size));
}

inline std::string stb_tga(int width, int height, int channels, const void* data, bool runs)
{
    std::string bytes;
    stbi_write_tga_with_rle = runs ? 1 : 0;
    stbi_write_tga_to_func(append_to_string, &bytes, width, height, channels, data);
    return bytes;
}
inline std::string stb_bmp(int width, int height, int channels, const void* data)
{
    std::string bytes;
    stbi_write_bmp_to_func(append_to_string, &bytes, width, height, channels, data);
    return bytes;
}
inline std::string stb_jpeg(int width, int height, int channels, const void* data)
{
    std::string bytes;
    stbi_write_jpg_to_func(append_to_string, &bytes, width, height, channels, data, 95);
    return bytes;
}
inline std::string stb_hdr(int width, int height, const float* data)
{
    std::string bytes;
    stbi_write_hdr_to_func(append_to_string, &bytes, width, height, 3, data);
    return bytes;
}

} // namespace snell
