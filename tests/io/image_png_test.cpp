#include "snell/io/image/read.h"
#include "snell/io/image/write.h"
#include "snell/kernel/tone.h"

#include "image_helpers.h"

#include <png.h>

#include <cmath>
#include <cstdio>
#include <map>

namespace snell {

namespace {

// libpng's own simplified decoder; writes RGB bytes.
std::vector<std::uint8_t> decode(const fs::path& file)
{
    png_image image = {};
    image.version = PNG_IMAGE_VERSION;
    EXPECT_TRUE(png_image_begin_read_from_file(&image, file.c_str())) << image.message;
    image.format = PNG_FORMAT_RGB;
    std::vector<std::uint8_t> bytes(PNG_IMAGE_SIZE(image));
    EXPECT_TRUE(png_image_finish_read(&image, nullptr, bytes.data(), 0, nullptr)) << image.message;
    return bytes;
}

struct PngSpec
{
    int width, height, bits, color_type;
    std::vector<std::vector<std::uint8_t>> rows; // as they are packed in the file
    std::vector<png_color> palette;
    std::vector<std::uint8_t> palette_alpha;
    bool has_key = false;
    png_color_16 key = {};
    bool interlaced = false;
};

void write_spec(const fs::path& file, PngSpec spec)
{
    std::FILE* out = std::fopen(file.c_str(), "wb");
    ASSERT_TRUE(out);
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, out);
    png_set_IHDR(png, info, static_cast<png_uint_32>(spec.width), static_cast<png_uint_32>(spec.height), spec.bits,
                 spec.color_type, spec.interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, 0, 0);
    if (!spec.palette.empty()) png_set_PLTE(png, info, spec.palette.data(), static_cast<int>(spec.palette.size()));
    if (!spec.palette_alpha.empty())
        png_set_tRNS(png, info, spec.palette_alpha.data(), static_cast<int>(spec.palette_alpha.size()), nullptr);
    if (spec.has_key) png_set_tRNS(png, info, nullptr, 0, &spec.key);
    std::vector<png_bytep> rows;
    for (auto& row : spec.rows) rows.push_back(row.data());
    png_set_rows(png, info, rows.data());
    png_write_png(png, info, PNG_TRANSFORM_IDENTITY, nullptr);
    png_destroy_write_struct(&png, &info);
    std::fclose(out);
}

using Bytes = std::vector<std::uint8_t>;

} // namespace

TEST(Png, representable_values_are_exact)
{
    TemporaryFolder folder;
    // Each of the 256 values, at many positions of the dither pattern.
    Picture picture{256, 64, {}};
    for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 256; ++x) picture.pixels.push_back(vec3(srgb_decode(static_cast<float>(x) / 255.0f)));
    }
    write_picture(folder / "a.png", picture);
    std::vector<std::uint8_t> bytes = decode(folder / "a.png");
    ASSERT_EQ(bytes.size(), 256u * 64u * 3u);
    for (std::size_t i = 0; i < bytes.size(); ++i) ASSERT_EQ(bytes[i], i / 3 % 256) << i;
    // And our own reader inverts it.
    Picture back = read_picture(folder / "a.png");
    for (std::size_t i = 0; i < back.pixels.size(); ++i) ASSERT_EQ(back.pixels[i], picture.pixels[i]);
}

TEST(Png, dither_keeps_the_mean)
{
    TemporaryFolder folder;
    for (float value : {100.25f, 7.5f, 200.9f, 0.1f, 254.6f}) {
        Picture picture{64, 64, std::vector<vec3>(64 * 64, vec3(srgb_decode(value / 255.0f)))};
        write_picture(folder / "a.png", picture);
        std::vector<std::uint8_t> bytes = decode(folder / "a.png");
        double sum = 0.0;
        for (std::size_t i = 0; i < bytes.size(); i += 3) {
            ASSERT_LE(std::abs(static_cast<float>(bytes[i]) - value), 1.0f);
            ASSERT_EQ(bytes[i], bytes[i + 1]); // grey stays grey
            ASSERT_EQ(bytes[i], bytes[i + 2]);
            sum += bytes[i];
        }
        EXPECT_NEAR(sum / (64 * 64), static_cast<double>(value), 0.01);
        // Small blocks too: the pattern is even, not white noise (whose error here would be 0.12 to 0.06).
        for (std::size_t block = 0; block < 64; ++block) {
            double block_sum = 0.0;
            for (std::size_t k = 0; k < 64; ++k)
                block_sum += bytes[3 * ((block / 8 * 8 + k / 8) * 64 + block % 8 * 8 + k % 8)];
            ASSERT_NEAR(block_sum / 64.0, static_cast<double>(value), 0.08);
        }
    }
}

TEST(Png, exposure_and_curve_are_applied)
{
    TemporaryFolder folder;
    Picture picture{1, 1, {vec3(0.25f)}};
    write_picture(folder / "a.png", picture, {}, {2.0f, tone_none});
    EXPECT_EQ(decode(folder / "a.png"), (Bytes{255, 255, 255}));
    write_picture(folder / "b.png", picture, {}, {2.0f, tone_reinhard}); // 1 -> 1/2 -> 187.5
    EXPECT_NEAR(decode(folder / "b.png")[0], 188, 1);
}

TEST(Png, non_finite_and_out_of_range_values_do_no_harm)
{
    TemporaryFolder folder;
    float inf = infinity();
    Picture picture{3, 2, {vec3(NAN), vec3(inf), vec3(-inf), vec3(1e38f), vec3(-1.0f), vec3(NAN, 1.0f, 0.0f)}};
    for (uint curve : {tone_none, tone_reinhard, tone_aces}) {
        for (float ev : {0.0f, 100.0f}) {
            write_picture(folder / "a.png", picture, {}, {ev, curve});
            Bytes bytes = decode(folder / "a.png");
            Bytes expected = {0, 0, 0, 255, 255, 255, 0, 0, 0, 255, 255, 255, 0, 0, 0};
            EXPECT_EQ(Bytes(bytes.begin(), bytes.begin() + 15), expected) << curve << ' ' << ev;
            EXPECT_EQ(bytes[15], 0);
        }
    }
}

// What a picture says of how it was made; other readers find it, and the pixels are as without it.
TEST(Png, texts_say_how_it_was_made)
{
    TemporaryFolder folder;
    Picture picture;
    picture.width = 3;
    picture.height = 2;
    picture.pixels.assign(6, vec3(0.25f, 0.5f, 1.0f));
    Layers layers;
    layers.attributes = {{"commandLine", "render cornell --spp 4"}, {"title", "gr\u00fcn"}};
    layers.numbers = {{"spp", 4}};
    write_picture(folder / "plain.png", picture);
    write_picture(folder / "said.png", picture, layers);
    EXPECT_EQ(decode(folder / "plain.png"), decode(folder / "said.png"));

    std::FILE* in = std::fopen((folder / "said.png").c_str(), "rb");
    ASSERT_TRUE(in);
    png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, in);
    png_read_png(png, info, PNG_TRANSFORM_IDENTITY, nullptr); // checks the sums
    png_textp texts = nullptr;
    int count = 0;
    png_get_text(png, info, &texts, &count);
    std::map<std::string, std::string> found;
    for (int i = 0; i < count; ++i) found[texts[i].key] = texts[i].text;
    png_destroy_read_struct(&png, &info, nullptr);
    std::fclose(in);
    EXPECT_EQ(found.size(), 2u);
    EXPECT_EQ(found["commandLine"], "render cornell --spp 4");
    EXPECT_EQ(found["title"], "gr\u00fcn");
}

TEST(Png, grey_of_few_bits)
{
    TemporaryFolder folder;
    write_spec(folder / "1.png", {8, 1, 1, PNG_COLOR_TYPE_GRAY, {{0b10110000}}, {}, {}});
    EXPECT_EQ(read_texture(folder / "1.png", true).bytes,
              (Bytes{255, 255, 255, 255, 0, 0, 0, 255, 255, 255, 255, 255, 255, 255, 255, 255,
                     0,   0,   0,   255, 0, 0, 0, 255, 0,   0,   0,   255, 0,   0,   0,   255}));
    write_spec(folder / "2.png", {4, 1, 2, PNG_COLOR_TYPE_GRAY, {{0b00011011}}, {}, {}});
    EXPECT_EQ(read_texture(folder / "2.png", true).bytes,
              (Bytes{0, 0, 0, 255, 85, 85, 85, 255, 170, 170, 170, 255, 255, 255, 255, 255}));
    write_spec(folder / "4.png", {2, 1, 4, PNG_COLOR_TYPE_GRAY, {{0x3f}}, {}, {}});
    EXPECT_EQ(read_texture(folder / "4.png", false).bytes, (Bytes{51, 51, 51, 255, 255, 255, 255, 255}));
}

TEST(Png, palette_with_transparency)
{
    TemporaryFolder folder;
    PngSpec spec = {4, 1, 2, PNG_COLOR_TYPE_PALETTE, {{0b00011000}}, {{1, 2, 3}, {40, 50, 60}, {7, 8, 9}}, {255, 128}};
    write_spec(folder / "a.png", spec);
    Image image = read_texture(folder / "a.png", true);
    EXPECT_EQ(image.format, texels_rgba8_srgb);
    EXPECT_EQ(image.bytes, (Bytes{1, 2, 3, 255, 40, 50, 60, 128, 7, 8, 9, 255, 1, 2, 3, 255}));
}

TEST(Png, transparent_colour)
{
    TemporaryFolder folder;
    PngSpec spec = {2, 1, 8, PNG_COLOR_TYPE_RGB, {{10, 20, 30, 10, 20, 31}}, {}, {}};
    spec.has_key = true;
    spec.key.red = 10, spec.key.green = 20, spec.key.blue = 30;
    write_spec(folder / "a.png", spec);
    EXPECT_EQ(read_texture(folder / "a.png", true).bytes, (Bytes{10, 20, 30, 0, 10, 20, 31, 255}));
}

TEST(Png, sixteen_bits_keep_their_precision)
{
    TemporaryFolder folder;
    write_spec(folder / "a.png",
               {2, 1, 16, PNG_COLOR_TYPE_GRAY_ALPHA, {{0x12, 0x34, 0x80, 0x00, 0xff, 0xff, 0, 1}}, {}, {}});
    Image data = read_texture(folder / "a.png", false);
    EXPECT_EQ(data.format, texels_rgba32f);
    float grey = 0x1234 / 65535.0f, alpha = 0x8000 / 65535.0f;
    EXPECT_EQ(data.floats, (std::vector<float>{grey, grey, grey, alpha, 1, 1, 1, 1 / 65535.0f}));
    Image color = read_texture(folder / "a.png", true); // decoded, but for alpha
    EXPECT_EQ(color.floats[0], srgb_decode(grey));
    EXPECT_EQ(color.floats[3], alpha);
    EXPECT_EQ(read_picture(folder / "a.png").at(0, 0), vec3(srgb_decode(grey)));
}

TEST(Png, interlaced_is_the_same)
{
    TemporaryFolder folder;
    PngSpec spec = {19, 13, 8, PNG_COLOR_TYPE_RGB_ALPHA, {}, {}, {}};
    for (std::size_t y = 0; y < 13; ++y) {
        spec.rows.emplace_back();
        for (std::size_t i = 0; i < 19 * 4; ++i) spec.rows.back().push_back(static_cast<std::uint8_t>(y * 31 + i * 3));
    }
    write_spec(folder / "a.png", spec);
    spec.interlaced = true;
    write_spec(folder / "b.png", spec);
    Image plain = read_texture(folder / "a.png", true);
    ASSERT_EQ(plain.bytes.size(), 19u * 13u * 4u);
    EXPECT_EQ(plain.bytes[4 * 19 + 5], 46);
    EXPECT_EQ(plain.bytes, read_texture(folder / "b.png", true).bytes);
}

} // namespace snell
