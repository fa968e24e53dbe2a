// JPEG through libjpeg-turbo. It takes what a cut-off file lacks for grey, so each file is measured first, by walking
// over its structure.
#include "snell/core/error.h"
#include "snell/io/image/codec.h"

#include <csetjmp>
#include <cstdint>
#include <cstdio>

#include <jpeglib.h>

namespace fs = std::filesystem;

namespace snell {

namespace {

// Of a segment of Huffman tables.
void check_huffman_tables(const fs::path& file, std::string_view tables)
{
    while (!tables.empty()) {
        std::size_t codes = 0;
        for (std::size_t i = 1; i < 17 && i < tables.size(); ++i) codes += byte_at(tables, i);
        if (codes > 256 || tables.size() < 17 + codes) fail_picture(file, "the JPEG file has a broken Huffman table");
        tables.remove_prefix(17 + codes);
    }
}

// Walks the segments of a JPEG up to the mark of its end, and checks its size on the way.
void check_jpeg(const fs::path& file, std::string_view bytes)
{
    constexpr int most_scans = 256; // a progressive file has about ten; each takes time in proportion to the picture
    int scans = 0;
    bool has_size = false;
    std::size_t at = 2;
    auto cut_off = [&]() { fail_picture(file, "the JPEG picture is cut off"); };
    for (;;) {
        // The next mark: FF and neither a stuffed 0, nor a restart, nor another FF. Whatever stands between
        // segments is passed over too, as decoders do.
        while (at + 1 < bytes.size()) {
            std::uint32_t mark = byte_at(bytes, at + 1);
            if (byte_at(bytes, at) == 0xff && mark != 0x00 && mark != 0xff && (mark < 0xd0 || mark > 0xd7)) break;
            ++at;
        }
        if (at + 1 >= bytes.size()) cut_off();
        std::uint32_t mark = byte_at(bytes, at + 1);
        at += 2;
        if (mark == 0xd9) break;                    // the end
        if (mark == 0x01 || mark == 0xd8) continue; // marks without a segment
        if (at + 2 > bytes.size()) cut_off();
        std::size_t length = byte_at(bytes, at) << 8 | byte_at(bytes, at + 1);
        if (length < 2) fail_picture(file, "the JPEG file has a broken segment");
        if (length > bytes.size() - at) cut_off();
        if (mark == 0xc4) check_huffman_tables(file, bytes.substr(at + 2, length - 2));
        bool is_frame = mark >= 0xc0 && mark <= 0xcf && mark != 0xc4 && mark != 0xc8 && mark != 0xcc;
        if (is_frame && length >= 8) {
            std::int64_t height = byte_at(bytes, at + 3) << 8 | byte_at(bytes, at + 4);
            std::int64_t width = byte_at(bytes, at + 5) << 8 | byte_at(bytes, at + 6);
            // At the very least a bit for each block of 64, in one component.
            check_size(file, width, height, static_cast<std::uint64_t>(width * height) / 1024, bytes.size());
            has_size = true;
        }
        if (mark == 0xda && ++scans > most_scans)
            throw Error({file.string()}, fmt::format("a JPEG picture of more than {} scans", most_scans),
                        "save it with fewer");
        at += length;
    }
    if (!has_size || scans == 0) fail_picture(file, "the JPEG file has no picture");
}

struct JpegReader
{
    JpegReader() = default;
    ~JpegReader() { jpeg_destroy_decompress(&info); }
    JpegReader(const JpegReader&) = delete;
    JpegReader& operator=(const JpegReader&) = delete;

    jpeg_decompress_struct info = {};
    jpeg_error_mgr errors = {};
    std::jmp_buf on_error = {};
    char message[JMSG_LENGTH_MAX] = "not enough memory";
};

void stop(j_common_ptr info)
{
    auto* const reader = static_cast<JpegReader*>(info->client_data);
    info->err->format_message(info, reader->message);
    std::longjmp(reader->on_error, 1);
}

void ignore_message(j_common_ptr) {}
void ignore_level(j_common_ptr, int) {}

// No object with a destructor may live in a function that is jumped out of.
bool read_header(JpegReader& reader, std::string_view bytes)
{
    reader.info.err = jpeg_std_error(&reader.errors);
    reader.errors.error_exit = stop;
    reader.errors.output_message = ignore_message;
    reader.errors.emit_message = ignore_level;
    reader.info.client_data = &reader;
    if (setjmp(reader.on_error)) return false;
    jpeg_create_decompress(&reader.info);
    reader.info.client_data = &reader;
    jpeg_mem_src(&reader.info, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
    jpeg_read_header(&reader.info, TRUE);
    // The library converts to CMYK and to RGB, but not from one to the other.
    const bool has_black = reader.info.jpeg_color_space == JCS_CMYK || reader.info.jpeg_color_space == JCS_YCCK;
    reader.info.out_color_space = has_black ? JCS_CMYK : JCS_EXT_RGBA;
    jpeg_calc_output_dimensions(&reader.info);
    return true;
}

bool read_rows(JpegReader& reader, std::uint8_t* out)
{
    if (setjmp(reader.on_error)) return false;
    jpeg_start_decompress(&reader.info);
    while (reader.info.output_scanline < reader.info.output_height) {
        JSAMPROW row = out + std::size_t(reader.info.output_scanline) * reader.info.output_width * 4;
        jpeg_read_scanlines(&reader.info, &row, 1);
    }
    jpeg_finish_decompress(&reader.info);
    return true;
}

} // namespace

Raster decode_jpeg(const fs::path& file, std::string_view bytes)
{
    check_jpeg(file, bytes);
    JpegReader reader;
    const auto fail_reading = [&] { fail_picture(file, fmt::format("not a good JPEG file: {}", reader.message)); };
    if (!read_header(reader, bytes)) fail_reading();
    const std::int64_t width = reader.info.output_width, height = reader.info.output_height;
    check_size(file, width, height, static_cast<std::uint64_t>(width * height) / 1024, bytes.size());

    Raster raster;
    raster.width = static_cast<int>(width);
    raster.height = static_cast<int>(height);
    raster.bytes.resize(static_cast<std::size_t>(width * height) * 4);
    if (!read_rows(reader, raster.bytes.data())) fail_reading();
    if (reader.info.out_color_space == JCS_CMYK) {
        // Adobe's programs store ink upside down, and nearly all such files are theirs.
        for (std::size_t i = 0; i < raster.bytes.size(); i += 4) {
            std::uint8_t* const p = &raster.bytes[i];
            for (int c = 0; c < 3; ++c) {
                const unsigned ink = reader.info.saw_Adobe_marker ? p[c] : 255u - p[c];
                const unsigned black = reader.info.saw_Adobe_marker ? p[3] : 255u - p[3];
                p[c] = static_cast<std::uint8_t>((ink * black + 127) / 255);
            }
            p[3] = 255;
        }
    }
    return raster;
}

} // namespace snell
