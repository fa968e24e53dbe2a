// Private to snell/io/image: one decoder and one encoder a format, and the limits they share.
#pragma once

#include "snell/io/image/image.h"
#include "snell/io/image/write.h"

#include <cstdint>
#include <string>
#include <string_view>

namespace snell {

// What a decoder found, as the file has it: RGBA, row 0 at the top, exactly one of the three arrays filled.
struct Raster
{
    int width = 0, height = 0;
    std::vector<std::uint8_t> bytes;  // as stored, not decoded from sRGB
    std::vector<std::uint16_t> words; // the same, 16 bits
    std::vector<float> floats;        // scene-linear Rec.709
};

// No picture has a longer side or more texels than this; a file that claims so is taken for broken or hostile.
inline constexpr std::int64_t max_side = 1 << 16;
inline constexpr std::int64_t max_texels = std::int64_t(1) << 28;

// Throws Error unless the size is possible at all, and `file_bytes` are at least the `least_bytes` that the format
// needs for it. Decoders call this before they allocate, so that memory stays in proportion to the file.
void check_size(const std::filesystem::path& file, std::int64_t width, std::int64_t height, std::uint64_t least_bytes,
                std::uint64_t file_bytes);

// Throws the Error of a file that is broken.
[[noreturn]] void fail_picture(const std::filesystem::path& file, const std::string& message);

inline std::uint32_t byte_at(std::string_view bytes, std::size_t at)
{
    return static_cast<std::uint8_t>(bytes[at]);
}

// Decoders. `file` is for messages only. All throw Error on bytes that are not of the format, are cut off, or use what
// is not supported. In data (not colour) an EXR's primaries are not converted.
Raster decode_exr(const std::filesystem::path& file, std::string_view bytes, bool is_color);
Raster decode_png(const std::filesystem::path& file, std::string_view bytes);
Raster decode_hdr(const std::filesystem::path& file, std::string_view bytes);
Raster decode_pfm(const std::filesystem::path& file, std::string_view bytes);
Raster decode_jpeg(const std::filesystem::path& file, std::string_view bytes);
Raster decode_tga(const std::filesystem::path& file, std::string_view bytes);
Raster decode_webp(const std::filesystem::path& file, std::string_view bytes);
Raster decode_bmp(const std::filesystem::path& file, std::string_view bytes);

// Encoders, each replacing `file` atomically.
void write_exr(const std::filesystem::path& file, const Picture& picture, const Layers& layers);
void write_png(const std::filesystem::path& file, const Picture& picture, const Layers& layers,
               const DisplayTransform& display);
void write_hdr(const std::filesystem::path& file, const Picture& picture);
void write_pfm(const std::filesystem::path& file, const Picture& picture);

} // namespace snell
