// TGA and BMP through stb_image. It takes the bytes that a cut-off file lacks for zeros, so each file is measured
// first, by walking over its structure.
#include "snell/core/error.h"
#include "snell/io/image/codec.h"

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <memory>

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_TGA
#define STBI_ONLY_BMP
#define STBI_NO_STDIO
#define STBI_NO_LINEAR
#define STBI_NO_HDR
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized" // seen by sanitizer builds
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

namespace fs = std::filesystem;

namespace snell {

namespace {

// Little-endian fields; the caller has made sure of the size.
std::uint32_t word_at(std::string_view bytes, std::size_t at)
{
    return byte_at(bytes, at) | byte_at(bytes, at + 1) << 8;
}
std::uint32_t dword_at(std::string_view bytes, std::size_t at)
{
    return word_at(bytes, at) | word_at(bytes, at + 2) << 16;
}

Raster decode(const fs::path& file, std::string_view bytes, const char* kind)
{
    if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
        throw Error({file.string()}, fmt::format("a {} file of more than 2 GiB", kind), "scale the picture down");
    Raster raster;
    int channels = 0;
    std::unique_ptr<stbi_uc, void (*)(void*)> texels(
        stbi_load_from_memory(reinterpret_cast<const stbi_uc*>(bytes.data()), static_cast<int>(bytes.size()),
                              &raster.width, &raster.height, &channels, 4),
        stbi_image_free);
    if (!texels) fail_picture(file, fmt::format("not a good {} file: {}", kind, stbi_failure_reason()));
    std::size_t count = static_cast<std::size_t>(raster.width) * static_cast<std::size_t>(raster.height) * 4;
    raster.bytes.assign(texels.get(), texels.get() + count);
    return raster;
}

// Size in bytes of a TGA's texels from `at` on, run by run.
void check_tga_runs(const fs::path& file, std::string_view bytes, std::size_t at, std::uint64_t texels,
                    std::size_t texel_bytes)
{
    for (std::uint64_t done = 0; done < texels;) {
        if (at >= bytes.size()) fail_picture(file, "the TGA picture is cut off");
        std::uint32_t head = byte_at(bytes, at);
        std::size_t count = (head & 127) + 1;
        at += 1 + (head & 128 ? 1 : count) * texel_bytes;
        if (at > bytes.size()) fail_picture(file, "the TGA picture is cut off");
        done += count;
    }
}

void check_tga(const fs::path& file, std::string_view bytes)
{
    if (bytes.size() < 18) fail_picture(file, "the TGA header is cut off");
    std::uint32_t kind = byte_at(bytes, 2);
    bool is_packed = kind >= 8;
    if ((kind & ~8u) < 1 || (kind & ~8u) > 3) fail_picture(file, "not a TGA file, or of an unknown kind");
    std::int64_t width = word_at(bytes, 12), height = word_at(bytes, 14);
    std::size_t texel_bytes = (byte_at(bytes, 16) + 7) / 8;
    if (texel_bytes < 1 || texel_bytes > 4) fail_picture(file, "a TGA file with an unknown number of bits a pixel");
    std::size_t at = 18 + byte_at(bytes, 0);
    if (byte_at(bytes, 1) != 0) at += std::size_t(word_at(bytes, 5)) * ((byte_at(bytes, 7) + 7) / 8);
    std::uint64_t texels = static_cast<std::uint64_t>(width * height);
    std::uint64_t packed = at + (texels + 127) / 128 * (1 + texel_bytes);
    check_size(file, width, height, is_packed ? packed : at + texels * texel_bytes, bytes.size());
    if (is_packed) check_tga_runs(file, bytes, at, texels, texel_bytes);
}

void check_bmp(const fs::path& file, std::string_view bytes)
{
    if (bytes.size() < 30) fail_picture(file, "the BMP header is cut off");
    bool is_old = dword_at(bytes, 14) == 12; // OS/2: shorter fields
    std::int64_t width = is_old ? std::int64_t(word_at(bytes, 18)) : static_cast<std::int32_t>(dword_at(bytes, 18));
    std::int64_t height = is_old ? std::int64_t(word_at(bytes, 20)) : static_cast<std::int32_t>(dword_at(bytes, 22));
    std::uint64_t bits = word_at(bytes, is_old ? 24 : 28);
    height = std::abs(height); // negative: top row first
    check_size(file, width, height, 0, bytes.size());
    std::uint64_t w = static_cast<std::uint64_t>(width), h = static_cast<std::uint64_t>(height);
    std::uint64_t stride = (w * bits + 31) / 32 * 4;
    // The last row's padding may be missing.
    check_size(file, width, height, dword_at(bytes, 10) + stride * (h - 1) + (w * bits + 7) / 8, bytes.size());
}

} // namespace

Raster decode_tga(const fs::path& file, std::string_view bytes)
{
    check_tga(file, bytes);
    return decode(file, bytes, "TGA");
}

Raster decode_bmp(const fs::path& file, std::string_view bytes)
{
    check_bmp(file, bytes);
    return decode(file, bytes, "BMP");
}

} // namespace snell
