#include "snell/io/image/read.h"

#include "snell/core/error.h"
#include "snell/io/file.h"
#include "snell/io/image/codec.h"
#include "snell/kernel/tone.h"

#include <array>
#include <new>

namespace fs = std::filesystem;

namespace snell {

void fail_picture(const fs::path& file, const std::string& message)
{
    throw Error({file.string()}, message, "write the file again");
}

void check_size(const fs::path& file, std::int64_t width, std::int64_t height, std::uint64_t least_bytes,
                std::uint64_t file_bytes)
{
    if (width <= 0 || height <= 0)
        throw Error({file.string()}, fmt::format("a picture of {} x {} has no pixels", width, height),
                    "the file is broken, write it again");
    if (width > max_side || height > max_side || width * height > max_texels)
        throw Error({file.string()},
                    fmt::format("a picture of {} x {} is larger than the limit of {} a side and {} pixels", width,
                                height, max_side, max_texels),
                    "scale it down");
    if (file_bytes < least_bytes)
        throw Error({file.string()},
                    fmt::format("{} bytes cannot hold a picture of {} x {}", file_bytes, width, height),
                    "the file is cut off or broken, write it again");
}

namespace {

bool begins_with(std::string_view bytes, std::string_view magic)
{
    return bytes.substr(0, magic.size()) == magic;
}

// By content, because endings in the wild are often wrong; TGA has no mark of its own, so there the ending decides.
Raster decode(const fs::path& file, std::string_view bytes, bool is_color)
{
    if (bytes.empty()) throw Error({file.string()}, "the file is empty", "write it again");
    try {
        if (begins_with(bytes, "\x76\x2f\x31\x01")) return decode_exr(file, bytes, is_color);
        if (begins_with(bytes, "\x89PNG")) return decode_png(file, bytes);
        if (begins_with(bytes, "\xff\xd8")) return decode_jpeg(file, bytes);
        if (begins_with(bytes, "#?")) return decode_hdr(file, bytes);
        if (begins_with(bytes, "PF") || begins_with(bytes, "Pf")) return decode_pfm(file, bytes);
        if (begins_with(bytes, "RIFF") && bytes.size() > 12 && bytes.substr(8, 4) == "WEBP")
            return decode_webp(file, bytes);
        if (lower_extension(file) == ".tga") return decode_tga(file, bytes);
        if (begins_with(bytes, "BM")) return decode_bmp(file, bytes);
    } catch (const std::bad_alloc&) {
        throw Error({file.string()}, "the picture does not fit into memory", "scale it down");
    }
    throw Error({file.string()}, "is not a picture of a known kind",
                "use .exr, .hdr, .pfm, .png, .jpg, .webp, .tga or .bmp");
}

// Linear value of each encoded one.
template <std::size_t N>
const std::array<float, N>& srgb_table()
{
    static const std::array<float, N> table = [] {
        std::array<float, N> t = {};
        for (std::size_t i = 0; i < N; ++i) t[i] = srgb_decode(static_cast<float>(i) / static_cast<float>(N - 1));
        return t;
    }();
    return table;
}

} // namespace

Picture read_picture(const fs::path& file)
{
    Raster raster = decode(file, read_file(file), true);
    Picture picture;
    picture.width = raster.width;
    picture.height = raster.height;
    std::size_t count = static_cast<std::size_t>(raster.width) * static_cast<std::size_t>(raster.height);
    picture.pixels.resize(count);
    const auto& of_byte = srgb_table<256>();
    const auto& of_word = srgb_table<65536>();
    for (std::size_t i = 0; i < count; ++i) {
        vec3& p = picture.pixels[i];
        if (!raster.bytes.empty()) {
            const std::uint8_t* b = &raster.bytes[4 * i];
            p = vec3(of_byte[b[0]], of_byte[b[1]], of_byte[b[2]]);
        } else if (!raster.words.empty()) {
            const std::uint16_t* w = &raster.words[4 * i];
            p = vec3(of_word[w[0]], of_word[w[1]], of_word[w[2]]);
        } else {
            const float* f = &raster.floats[4 * i];
            p = vec3(f[0], f[1], f[2]);
        }
    }
    return picture;
}

Image read_texture(const fs::path& file, bool is_color)
{
    return read_texture(read_file(file), file, is_color);
}

Image read_texture(std::string_view bytes, const fs::path& file, bool is_color)
{
    Raster raster = decode(file, bytes, is_color);
    Image image;
    image.name = file.filename().string();
    image.width = static_cast<uint>(raster.width);
    image.height = static_cast<uint>(raster.height);
    if (!raster.bytes.empty()) {
        image.format = is_color ? texels_rgba8_srgb : texels_rgba8_linear;
        image.bytes = std::move(raster.bytes);
        return image;
    }
    image.format = texels_rgba32f;
    if (!raster.words.empty()) {
        const auto& linear = srgb_table<65536>();
        image.floats.resize(raster.words.size());
        for (std::size_t i = 0; i < raster.words.size(); ++i) {
            bool is_alpha = i % 4 == 3; // never encoded
            image.floats[i] =
                is_color && !is_alpha ? linear[raster.words[i]] : static_cast<float>(raster.words[i]) / 65535.0f;
        }
        return image;
    }
    image.floats = std::move(raster.floats);
    for (float& f : image.floats) {
        if (!is_finite(f)) f = 0.0f;
    }
    return image;
}

} // namespace snell
