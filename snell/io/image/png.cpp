#include "snell/core/error.h"
#include "snell/io/file.h"
#include "snell/io/image/codec.h"
#include "snell/kernel/tone.h"

#include <png.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <csetjmp>
#include <cstdio>
#include <cstring>

namespace fs = std::filesystem;

namespace snell {

namespace {

// libpng leaves by longjmp, which must not jump over a destructor: everything that owns memory lives here, outside the
// functions that call setjmp.
struct PngReader
{
    explicit PngReader(std::string_view all) : left(all) {}
    ~PngReader() { png_destroy_read_struct(&png, &info, nullptr); }
    PngReader(const PngReader&) = delete;
    PngReader& operator=(const PngReader&) = delete;

    png_structp png = nullptr;
    png_infop info = nullptr;
    std::string_view left;
    std::vector<png_bytep> rows;
    char message[128] = "not enough memory";
};

void on_error(png_structp png, png_const_charp message)
{
    auto* reader = static_cast<PngReader*>(png_get_error_ptr(png));
    std::snprintf(reader->message, sizeof(reader->message), "%s", message);
    png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}

void on_read(png_structp png, png_bytep out, std::size_t count)
{
    auto* reader = static_cast<PngReader*>(png_get_io_ptr(png));
    if (count > reader->left.size()) png_error(png, "the file is cut off");
    std::memcpy(out, reader->left.data(), count);
    reader->left.remove_prefix(count);
}

bool read_header(PngReader& reader)
{
    reader.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &reader, on_error, on_warning);
    if (!reader.png) return false;
    if (setjmp(png_jmpbuf(reader.png))) return false;
    reader.info = png_create_info_struct(reader.png);
    if (!reader.info) return false;
    png_set_read_fn(reader.png, &reader, on_read);
    png_set_user_limits(reader.png, max_side, max_side);
    // Comments and profiles are packed, and not needed.
    png_set_chunk_malloc_max(reader.png, std::max<std::size_t>(reader.left.size(), 1 << 20));
    png_read_info(reader.png, reader.info);
    return true;
}

// To RGBA of 8 or 16 bits, whatever the file has.
bool set_transforms(PngReader& reader, bool is_wide)
{
    if (setjmp(png_jmpbuf(reader.png))) return false;
    png_set_expand(reader.png); // palettes, fewer than 8 bits, transparent colours
    png_set_gray_to_rgb(reader.png);
    png_set_add_alpha(reader.png, is_wide ? 0xffff : 0xff, PNG_FILLER_AFTER);
    if (is_wide && std::endian::native == std::endian::little) png_set_swap(reader.png);
    png_set_interlace_handling(reader.png);
    png_read_update_info(reader.png, reader.info);
    return true;
}

bool read_rows(PngReader& reader)
{
    if (setjmp(png_jmpbuf(reader.png))) return false;
    png_read_image(reader.png, reader.rows.data());
    png_read_end(reader.png, nullptr); // a file without its end was cut off
    return true;
}

// Thresholds of an even, blue-noise-like pattern in (0, 1): Roberts's R2 sequence over the pixel grid. Kept away from 0
// and 1 so that rounding errors of the sRGB curve cannot push a representable value to its neighbour.
float dither_threshold(int x, int y)
{
    std::uint32_t bits = static_cast<std::uint32_t>(x) * 3242174889u + static_cast<std::uint32_t>(y) * 2447445414u;
    float u = static_cast<float>(bits >> 8) * 0x1p-24f;
    return 1.0f / 1024.0f + u * (1022.0f / 1024.0f);
}

// Non-finite radiance must not reach the conversion to an integer: NaN is black, infinity very bright.
vec3 displayable(vec3 radiance)
{
    auto fix = [](float v) { return v > 0.0f ? std::min(v, 1e18f) : 0.0f; };
    return vec3(fix(radiance.x), fix(radiance.y), fix(radiance.z));
}

std::uint8_t quantize(float value, float threshold)
{
    float v = value >= 0.0f ? std::min(value, 1.0f) : value < 0.0f ? 0.0f : 1.0f; // NaN: infinity over infinity
    return static_cast<std::uint8_t>(v * 255.0f + threshold);
}

// libpng takes memory for a whole chunk before it has its bytes.
void check_chunks(const fs::path& file, std::string_view bytes)
{
    const auto byte_at = [&](std::size_t at) { return std::size_t(static_cast<std::uint8_t>(bytes[at])); };
    for (std::size_t at = 8; at + 4 <= bytes.size();) {
        const std::size_t length = byte_at(at) << 24 | byte_at(at + 1) << 16 | byte_at(at + 2) << 8 | byte_at(at + 3);
        constexpr std::size_t around = 12; // length, name and check sum
        if (bytes.size() - at < around || length > bytes.size() - at - around)
            throw Error({file.string()}, fmt::format("the PNG file is cut off in the chunk at byte {}", at),
                        "write the file again");
        if (bytes.substr(at + 4, 4) == "IEND") return;
        at += around + length;
    }
}

} // namespace

Raster decode_png(const fs::path& file, std::string_view bytes)
{
    check_chunks(file, bytes);
    PngReader reader(bytes);
    auto fail = [&]() {
        throw Error({file.string()}, fmt::format("not a good PNG file: {}", reader.message), "write the file again");
    };
    if (!read_header(reader)) fail();

    std::uint64_t width = png_get_image_width(reader.png, reader.info);
    std::uint64_t height = png_get_image_height(reader.png, reader.info);
    std::uint64_t bits =
        std::uint64_t(png_get_bit_depth(reader.png, reader.info)) * png_get_channels(reader.png, reader.info);
    // Deflate packs at most 1032 to 1.
    check_size(file, static_cast<std::int64_t>(width), static_cast<std::int64_t>(height),
               height * ((width * bits + 7) / 8) / 1032, bytes.size());

    bool is_wide = png_get_bit_depth(reader.png, reader.info) == 16;
    if (!set_transforms(reader, is_wide)) fail();
    std::size_t row_bytes = static_cast<std::size_t>(width) * 4 * (is_wide ? 2 : 1);
    SNELL_CHECK_EQ(png_get_rowbytes(reader.png, reader.info), row_bytes);

    Raster raster;
    raster.width = static_cast<int>(width);
    raster.height = static_cast<int>(height);
    std::size_t values = static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4;
    png_bytep first;
    if (is_wide) {
        raster.words.resize(values);
        first = reinterpret_cast<png_bytep>(raster.words.data());
    } else {
        raster.bytes.resize(values);
        first = raster.bytes.data();
    }
    reader.rows.resize(static_cast<std::size_t>(height));
    for (std::size_t y = 0; y < reader.rows.size(); ++y) reader.rows[y] = first + y * row_bytes;
    if (!read_rows(reader)) fail();
    return raster;
}

// The signature and the chunk IHDR, which have the same size in every file.
static constexpr std::size_t end_of_header = 8 + 25;

static std::string big_endian(std::uint32_t value)
{
    std::string bytes;
    for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift & 255u);
    return bytes;
}

// What an EXR file has as string attributes, as chunks iTXt (UTF-8, not compressed). Without the numbers: the time a
// picture took is among them, and the same command shall give the same file.
static std::string text_chunks(const Layers& layers)
{
    std::string chunks;
    for (const auto& [name, text] : layers.attributes) {
        constexpr std::size_t longest_keyword = 79;
        const std::string body = "iTXt" + name.substr(0, longest_keyword) + std::string(5, '\0') + text;
        const auto* const bytes = reinterpret_cast<const Bytef*>(body.data());
        chunks += big_endian(static_cast<std::uint32_t>(body.size() - 4)) + body +
                  big_endian(static_cast<std::uint32_t>(crc32(0, bytes, static_cast<uInt>(body.size()))));
    }
    return chunks;
}

void write_png(const fs::path& file, const Picture& picture, const Layers& layers, const DisplayTransform& display)
{
    const bool has_alpha = !layers.alpha.empty();
    if (has_alpha) SNELL_CHECK_EQ(layers.alpha.size(), picture.pixels.size());
    std::vector<std::uint8_t> bytes;
    bytes.reserve(picture.pixels.size() * (has_alpha ? 4 : 3));
    std::size_t pixel = 0;
    for (int y = 0; y < picture.height; ++y) {
        for (int x = 0; x < picture.width; ++x, ++pixel) {
            // PNG's colours are those of what covers the pixel; ours are multiplied with how much of it that is
            float alpha = has_alpha ? std::clamp(layers.alpha[pixel], 0.0f, 1.0f) : 1.0f;
            vec3 covering = alpha > 0.0f ? picture.at(x, y) / alpha : vec3(0.0f);
            vec3 v = display_value(displayable(covering), display.exposure_ev, display.curve);
            // One threshold for all three channels: what is grey stays grey.
            float threshold = dither_threshold(x, y);
            for (float c : {v.x, v.y, v.z}) bytes.push_back(quantize(c, threshold));
            if (has_alpha) bytes.push_back(quantize(alpha, 0.5f));
        }
    }
    png_image image = {};
    image.version = PNG_IMAGE_VERSION;
    image.width = static_cast<png_uint_32>(picture.width);
    image.height = static_cast<png_uint_32>(picture.height);
    image.format = has_alpha ? PNG_FORMAT_RGBA : PNG_FORMAT_RGB;
    std::string encoded(PNG_IMAGE_PNG_SIZE_MAX(image), '\0');
    png_alloc_size_t size = encoded.size();
    if (!png_image_write_to_memory(&image, encoded.data(), &size, 0, bytes.data(), 0, nullptr))
        throw Error({file.string()}, fmt::format("writing the PNG file failed: {}", image.message),
                    "report this: it is an error of ours");
    encoded.resize(size);
    encoded.insert(end_of_header, text_chunks(layers));
    write_atomically(file, encoded);
}

} // namespace snell
