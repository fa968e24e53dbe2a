#include "seeds.h"

#include <png.h>
#include <webp/encode.h>

#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wsign-conversion"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

#include <stdexcept>

namespace snell::hostile {

namespace {

// Width x height texels of so many bytes: a gradient with something in it.
std::vector<std::uint8_t> texels(int width, int height, int bytes)
{
    std::vector<std::uint8_t> all;
    for (int i = 0; i < width * height * bytes; ++i)
        all.push_back(static_cast<std::uint8_t>(i < width * bytes ? 40 : i * 37 / bytes + i % bytes * 90));
    return all;
}

void append(void* context, void* data, int size)
{
    static_cast<std::string*>(context)->append(static_cast<const char*>(data), static_cast<std::size_t>(size));
}

void append_png(png_structp png, png_bytep data, std::size_t size)
{
    append(png_get_io_ptr(png), data, static_cast<int>(size));
}

std::string png(int kind, int depth, bool is_interlaced, bool has_transparency = false)
{
    constexpr int width = 9, height = 6;
    std::string bytes;
    png_structp out = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(out);
    if (setjmp(png_jmpbuf(out))) throw std::runtime_error("libpng cannot write");
    png_set_write_fn(out, &bytes, append_png, nullptr);
    png_set_IHDR(out, info, width, height, depth, kind, is_interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    const png_color palette[4] = {{1, 2, 3}, {255, 0, 0}, {0, 255, 0}, {9, 9, 255}};
    if (kind == PNG_COLOR_TYPE_PALETTE) png_set_PLTE(out, info, palette, 4);
    const png_byte alpha[2] = {0, 128};
    png_color_16 clear = {};
    if (has_transparency) png_set_tRNS(out, info, alpha, kind == PNG_COLOR_TYPE_PALETTE ? 2 : 0, &clear);
    png_text comment = {};
    char key[] = "Comment", text[] = "a seed";
    comment.compression = PNG_TEXT_COMPRESSION_NONE, comment.key = key, comment.text = text, comment.text_length = 6;
    png_set_text(out, info, &comment, 1);
    png_set_gAMA(out, info, 0.45455);
    png_write_info(out, info);
    std::vector<std::uint8_t> data = texels(width, height, 8);
    if (kind == PNG_COLOR_TYPE_PALETTE)
        for (std::uint8_t& b : data) b = depth == 8 ? b & 3 : b & 0x1b;
    std::vector<png_bytep> rows;
    for (int y = 0; y < height; ++y) rows.push_back(&data[static_cast<std::size_t>(y) * width * 8]);
    png_write_image(out, rows.data());
    png_write_end(out, info);
    png_destroy_write_struct(&out, &info);
    return bytes;
}

std::vector<Seed> pngs()
{
    return {{"rgba8", png(PNG_COLOR_TYPE_RGB_ALPHA, 8, false)},
            {"rgb8_interlaced", png(PNG_COLOR_TYPE_RGB, 8, true)},
            {"rgb16", png(PNG_COLOR_TYPE_RGB, 16, false)},
            {"rgba16_interlaced", png(PNG_COLOR_TYPE_RGB_ALPHA, 16, true)},
            {"grey1", png(PNG_COLOR_TYPE_GRAY, 1, false)},
            {"grey4_interlaced", png(PNG_COLOR_TYPE_GRAY, 4, true)},
            {"grey16_clear", png(PNG_COLOR_TYPE_GRAY, 16, false, true)},
            {"grey_alpha", png(PNG_COLOR_TYPE_GRAY_ALPHA, 8, false)},
            {"palette8", png(PNG_COLOR_TYPE_PALETTE, 8, false, true)},
            {"palette2_interlaced", png(PNG_COLOR_TYPE_PALETTE, 2, true)}};
}

std::string hdr_header(const char* resolution)
{
    return std::string("#?RADIANCE\n# a seed\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=1.5\n\n") + resolution + "\n";
}

std::vector<Seed> hdrs()
{
    Bytes old_runs, plain, new_runs;
    old_runs.add(hdr_header("-Y 3 +X 6"));
    for (int y = 0; y < 3; ++y) old_runs.add({"\x80\x40\x20\x81\x01\x01\x01\x02\x10\x20\x30\x80\x01\x01\x01\x02", 16});
    plain.add(hdr_header("+X 3 -Y 4"));
    for (const std::uint8_t b : texels(3, 4, 4)) plain.put<std::uint8_t>(b | 2);
    new_runs.add(hdr_header("-Y 4 +X 12"));
    for (int y = 0; y < 4; ++y) {
        new_runs.add({"\x02\x02\x00\x0c", 4});
        for (int c = 0; c < 4; ++c) new_runs.add({"\x88\x41\x04\x01\x02\x03\x80", 7});
    }
    return {{"old_runs", old_runs.text}, {"plain_by_columns", plain.text}, {"new_runs", new_runs.text}};
}

std::vector<Seed> pfms()
{
    Bytes color, grey;
    color.add("PF\n3 2\n-1.0\n");
    for (int i = 0; i < 18; ++i) color.put(0.25f * static_cast<float>(i));
    grey.is_big = true;
    grey.add("Pf\n4 3\n2.5\n");
    for (int i = 0; i < 12; ++i) grey.put(0.5f * static_cast<float>(i));
    return {{"color", color.text}, {"grey_big_endian", grey.text}};
}

std::vector<Seed> jpgs()
{
    std::vector<Seed> all;
    for (const auto& [name, channels, quality] :
         {std::tuple("grey", 1, 40), std::tuple("color_halved", 3, 60), std::tuple("color", 3, 95)}) {
        std::string bytes;
        stbi_write_jpg_to_func(append, &bytes, 19, 10, channels, texels(19, 10, channels).data(), quality);
        all.push_back({name, bytes});
    }
    return all;
}

std::vector<Seed> tgas()
{
    std::vector<Seed> all;
    for (const int channels : {1, 3, 4}) {
        for (const bool runs : {false, true}) {
            std::string bytes;
            stbi_write_tga_with_rle = runs;
            stbi_write_tga_to_func(append, &bytes, 9, 5, channels, texels(9, 5, channels).data());
            all.push_back({std::to_string(channels) + (runs ? "_runs" : "_plain"), bytes});
        }
    }
    Bytes palette, wide;
    palette.add({"\0\x01\x01\0\0\x04\0\x18\0\0\0\0\x04\0\x03\0\x08\0", 18});
    for (int i = 0; i < 12; ++i) palette.put<std::uint8_t>(static_cast<std::uint8_t>(20 * i));
    for (int i = 0; i < 12; ++i) palette.put<std::uint8_t>(static_cast<std::uint8_t>(i & 3));
    all.push_back({"palette", palette.text});
    wide.add({"\0\0\x02\0\0\0\0\0\0\0\0\0\x04\0\x03\0\x10\x20", 18}); // 16 bits, top row first
    for (int i = 0; i < 24; ++i) wide.put<std::uint8_t>(static_cast<std::uint8_t>(11 * i));
    all.push_back({"16_bits", wide.text});
    return all;
}

// With a header of 40 bytes.
std::string bmp(int bits, int compression, int height, std::string_view palette, std::string_view masks,
                std::size_t data_bytes)
{
    Bytes out;
    const auto offset = static_cast<std::uint32_t>(54 + palette.size() + masks.size());
    out.add("BM").put(static_cast<std::uint32_t>(offset + data_bytes)).put<std::uint32_t>(0).put(offset);
    out.put<std::uint32_t>(40).put<std::int32_t>(5).put<std::int32_t>(height).put<std::uint16_t>(1);
    out.put(static_cast<std::uint16_t>(bits)).put<std::uint32_t>(static_cast<std::uint32_t>(compression));
    out.put<std::uint32_t>(0).put<std::uint32_t>(2835).put<std::uint32_t>(2835);
    out.put(static_cast<std::uint32_t>(palette.size() / 4)).put<std::uint32_t>(0);
    out.add(masks).add(palette);
    for (std::size_t i = 0; i < data_bytes; ++i)
        out.put(static_cast<std::uint8_t>(palette.empty() ? i * 29 : i * 29 & 1));
    return out.text;
}

std::vector<Seed> bmps()
{
    const std::string_view palette("\x10\x20\x30\0\xf0\xe0\xd0\0", 8);
    const std::string_view masks("\0\xf8\0\0\xe0\x07\0\0\x1f\0\0\0", 12);
    return {{"24_bits", bmp(24, 0, 3, {}, {}, 48)},    {"24_bits_down", bmp(24, 0, -3, {}, {}, 48)},
            {"32_bits", bmp(32, 0, 3, {}, {}, 60)},    {"16_bits_masks", bmp(16, 3, 3, {}, masks, 36)},
            {"8_bits", bmp(8, 0, 3, palette, {}, 24)}, {"4_bits", bmp(4, 0, 3, palette, {}, 12)},
            {"1_bit", bmp(1, 0, 3, palette, {}, 12)}};
}

std::vector<Seed> webps()
{
    std::vector<Seed> all;
    const std::vector<std::uint8_t> data = texels(20, 17, 4);
    for (const bool is_lossless : {false, true}) {
        std::uint8_t* out = nullptr;
        const std::size_t size = is_lossless ? WebPEncodeLosslessRGBA(data.data(), 20, 17, 80, &out)
                                             : WebPEncodeRGBA(data.data(), 20, 17, 80, 30.0f, &out);
        all.push_back({is_lossless ? "lossless" : "lossy", {reinterpret_cast<const char*>(out), size}});
        WebPFree(out);
    }
    return all;
}

} // namespace

std::string small_png()
{
    std::string bytes;
    const std::uint8_t data[16] = {255, 0, 0, 255, 0, 255, 0, 128, 0, 0, 255, 0, 255, 255, 255, 255};
    stbi_write_png_to_func(append, &bytes, 2, 2, 4, data, 8);
    return bytes;
}

std::vector<Seed> made_image_seeds(const std::string& format)
{
    if (format == "png") return pngs();
    if (format == "hdr") return hdrs();
    if (format == "pfm") return pfms();
    if (format == "jpg") return jpgs();
    if (format == "tga") return tgas();
    if (format == "bmp") return bmps();
    if (format == "webp") return webps();
    return {};
}

} // namespace snell::hostile
