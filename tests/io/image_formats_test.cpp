// Pictures come back as they were written: HDR, PFM, and the 8-bit kinds that others write.
#include "snell/io/image/read.h"
#include "snell/io/image/write.h"
#include "snell/kernel/tone.h"

#include "image_helpers.h"

#include <cmath>
#include <cstring>
#include <limits>

namespace snell {

namespace {

std::string big_endian(float v)
{
    std::uint32_t bits = floatBitsToUint(v);
    return {static_cast<char>(bits >> 24), static_cast<char>(bits >> 16), static_cast<char>(bits >> 8),
            static_cast<char>(bits)};
}

// Within what 8 bits of mantissa shared by three channels can hold.
void expect_close_in_rgbe(const Picture& a, const Picture& b)
{
    ASSERT_EQ(a.width, b.width);
    ASSERT_EQ(a.height, b.height);
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        float tolerance = max3(a.pixels[i]) / 256.0f;
        for (int c = 0; c < 3; ++c) ASSERT_NEAR(a.pixels[i][c], b.pixels[i][c], tolerance) << "pixel " << i;
    }
}

std::vector<std::uint8_t> some_bytes(int width, int height, int channels)
{
    std::vector<std::uint8_t> bytes;
    for (int i = 0; i < width * height * channels; ++i) bytes.push_back(static_cast<std::uint8_t>(i * 7 / 5 + i / 40));
    return bytes;
}

} // namespace

TEST(Pfm, round_trip_is_exact)
{
    TemporaryFolder folder;
    Picture picture = test_picture(13, 7);
    picture.at(2, 3) = vec3(-0.0f, infinity(), -1e-42f);
    picture.at(3, 3).x = uintBitsToFloat(0x7fc12345u); // NaN with a payload
    write_picture(folder / "a.pfm", picture);
    Picture back = read_picture(folder / "a.pfm");
    ASSERT_EQ(back.width, 13);
    ASSERT_EQ(back.height, 7);
    EXPECT_EQ(std::memcmp(back.pixels.data(), picture.pixels.data(), picture.pixels.size() * sizeof(vec3)), 0);
}

TEST(Pfm, both_byte_orders_grey_and_scale)
{
    TemporaryFolder folder;
    put(folder / "a.pfm", "Pf\n2 2\n1.0\n" + big_endian(1) + big_endian(2) + big_endian(3) + big_endian(-4));
    Picture grey = read_picture(folder / "a.pfm");
    EXPECT_EQ(grey.at(0, 1), vec3(1.0f)); // the file begins at the bottom
    EXPECT_EQ(grey.at(1, 1), vec3(2.0f));
    EXPECT_EQ(grey.at(0, 0), vec3(3.0f));
    EXPECT_EQ(grey.at(1, 0), vec3(-4.0f));
    put(folder / "b.pfm", "PF\n1 1\n2.5\n" + big_endian(1) + big_endian(2) + big_endian(4));
    EXPECT_EQ(read_picture(folder / "b.pfm").at(0, 0), vec3(2.5f, 5.0f, 10.0f));
}

TEST(Texture, non_finite_texels_become_black)
{
    TemporaryFolder folder;
    Picture picture{2, 1, {vec3(NAN, 2.0f, infinity()), vec3(-infinity(), 0.5f, 3.0f)}};
    write_picture(folder / "a.pfm", picture);
    Image image = read_texture(folder / "a.pfm", true);
    EXPECT_EQ(image.name, "a.pfm");
    EXPECT_EQ(image.format, texels_rgba32f);
    EXPECT_EQ(image.floats, (std::vector<float>{0, 2, 0, 1, 0, 0.5f, 3, 1}));
    EXPECT_TRUE(std::isnan(read_picture(folder / "a.pfm").at(0, 0).x));
}

TEST(Hdr, round_trip_is_within_the_precision_of_the_format)
{
    TemporaryFolder folder;
    // With and without run lengths.
    for (auto [width, height] : {std::pair(300, 20), std::pair(5, 3), std::pair(1, 1), std::pair(8, 1)}) {
        Picture picture = test_picture(width, height);
        write_picture(folder / "a.hdr", picture);
        expect_close_in_rgbe(picture, read_picture(folder / "a.hdr"));
    }
}

TEST(Hdr, representable_values_are_exact)
{
    TemporaryFolder folder;
    Picture picture{4, 1, {vec3(0.0f), vec3(1.0f), vec3(255.0f, 17.0f, 128.0f), vec3(0x1p-100f)}};
    write_picture(folder / "a.hdr", picture);
    EXPECT_EQ(read_picture(folder / "a.hdr").pixels, picture.pixels);
}

TEST(Hdr, rounds_without_bias)
{
    TemporaryFolder folder;
    Picture picture{4096, 1, {}};
    double sum = 0.0, back_sum = 0.0;
    for (int i = 0; i < 4096; ++i) {
        picture.pixels.push_back(vec3(128.0f + static_cast<float>(i) / 64.0f, 0.0f, 0.0f));
        sum += static_cast<double>(picture.pixels.back().x);
    }
    write_picture(folder / "a.hdr", picture);
    for (vec3 p : read_picture(folder / "a.hdr").pixels) back_sum += static_cast<double>(p.x);
    EXPECT_NEAR(back_sum / sum, 1.0, 1e-4);
}

TEST(Hdr, what_it_cannot_hold_is_clamped)
{
    TemporaryFolder folder;
    write_picture(folder / "a.hdr", Picture{3, 1, {vec3(infinity(), 0, 0), vec3(NAN, -5, 1), vec3(3e38f, 1, 0)}});
    Picture back = read_picture(folder / "a.hdr");
    EXPECT_GT(back.at(0, 0).x, 1.6e38f);
    EXPECT_TRUE(is_finite(back.at(0, 0).x));
    EXPECT_EQ(back.at(1, 0), vec3(0, 0, 1));
    EXPECT_GT(back.at(2, 0).x, 1.6e38f);
}

TEST(Hdr, reads_what_another_program_writes)
{
    TemporaryFolder folder;
    Picture picture = test_picture(100, 10);
    put(folder / "a.hdr", stb_hdr(100, 10, &picture.pixels[0].x));
    Picture back = read_picture(folder / "a.hdr");
    for (std::size_t i = 0; i < picture.pixels.size(); ++i) { // that one truncates
        for (int c = 0; c < 3; ++c)
            ASSERT_NEAR(picture.pixels[i][c], back.pixels[i][c], max3(picture.pixels[i]) / 127.0f);
    }
}

TEST(Hdr, old_run_lengths_orientation_and_exposure)
{
    TemporaryFolder folder;
    // One column of 3 + 256 + 1 pixels, from the bottom up: a pixel, 2 + 256 repetitions, another pixel.
    std::string header = "#?RADIANCE\n# a comment\nEXPOSURE=2\nEXPOSURE= 2.0\nFORMAT=32-bit_rle_rgbe\n\n";
    std::string pixels("\x80\x40\x20\x83\x01\x01\x01\x02\x01\x01\x01\x01\x80\x80\x80\x81", 16);
    put(folder / "a.hdr", header + "+X 1 +Y 260\n" + pixels);
    Picture picture = read_picture(folder / "a.hdr");
    ASSERT_EQ(picture.width, 1);
    ASSERT_EQ(picture.height, 260);
    EXPECT_EQ(picture.at(0, 259), vec3(1.0f, 0.5f, 0.25f));
    EXPECT_EQ(picture.at(0, 1), vec3(1.0f, 0.5f, 0.25f));
    EXPECT_EQ(picture.at(0, 0), vec3(0.25f));
    // Rows from the right.
    put(folder / "b.hdr", "#?RGBE\n\n-Y 1 -X 2\n" + pixels.substr(0, 4) + pixels.substr(12, 4));
    picture = read_picture(folder / "b.hdr");
    EXPECT_EQ(picture.at(0, 0), vec3(1.0f));
    EXPECT_EQ(picture.at(1, 0), vec3(4.0f, 2.0f, 1.0f));
}

TEST(Hdr, other_pixel_formats_are_refused_by_name)
{
    TemporaryFolder folder;
    put(folder / "a.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n1234");
    EXPECT_TRUE(contains(error_of([&] { read_picture(folder / "a.hdr"); }), "32-bit_rle_xyze are not supported"));
}

TEST(EightBit, tga_and_bmp_are_exact)
{
    TemporaryFolder folder;
    int width = 37, height = 11;
    for (int channels : {1, 3, 4}) {
        std::vector<std::uint8_t> bytes = some_bytes(width, height, channels);
        std::vector<std::uint8_t> expected;
        for (int i = 0; i < width * height; ++i) {
            const std::uint8_t* p = &bytes[static_cast<std::size_t>(i * channels)];
            for (int c = 0; c < 3; ++c) expected.push_back(channels == 1 ? p[0] : p[c]);
            expected.push_back(channels == 4 ? p[3] : 255);
        }
        put(folder / "packed.tga", stb_tga(width, height, channels, bytes.data(), true));
        put(folder / "plain.TGA", stb_tga(width, height, channels, bytes.data(), false));
        put(folder / "a.bmp", stb_bmp(width, height, channels, bytes.data()));
        for (const char* name : {"packed.tga", "plain.TGA", "a.bmp"}) {
            Image image = read_texture(folder / name, true);
            EXPECT_EQ(image.width, 37u);
            EXPECT_EQ(image.height, 11u);
            EXPECT_EQ(image.format, texels_rgba8_srgb);
            EXPECT_EQ(image.bytes, expected) << name << ' ' << channels;
        }
    }
}

TEST(EightBit, jpeg_is_close)
{
    TemporaryFolder folder;
    std::vector<std::uint8_t> bytes;
    for (int y = 0; y < 40; ++y) {
        for (int x = 0; x < 50; ++x) {
            bytes.insert(bytes.end(), {static_cast<std::uint8_t>(x * 5), static_cast<std::uint8_t>(y * 6), 100});
        }
    }
    // A wrong ending does no harm.
    put(folder / "a.png", stb_jpeg(50, 40, 3, bytes.data()));
    Image image = read_texture(folder / "a.png", false);
    ASSERT_EQ(image.width, 50u);
    ASSERT_EQ(image.height, 40u);
    EXPECT_EQ(image.format, texels_rgba8_linear);
    for (std::size_t i = 0; i < 2000; ++i) {
        for (std::size_t c = 0; c < 3; ++c) ASSERT_NEAR(image.bytes[4 * i + c], bytes[3 * i + c], 6);
        ASSERT_EQ(image.bytes[4 * i + 3], 255);
    }
    // And read_picture decodes the sRGB curve.
    EXPECT_NEAR(read_picture(folder / "a.png").at(25, 20).x, srgb_decode(125.0f / 255.0f), 0.03f);
}

TEST(Write, unknown_endings_are_refused_naming_the_known)
{
    TemporaryFolder folder;
    for (const char* name : {"a.jpg", "a", "a.exr.tmp", ".png"}) {
        EXPECT_TRUE(contains(error_of([&] { write_picture(folder / name, test_picture(2, 2)); }),
                             "use .exr, .png, .hdr or .pfm"));
        EXPECT_TRUE(contains(error_of([&] { check_writable(folder / name); }), "use .exr, .png, .hdr or .pfm"));
    }
    EXPECT_EQ(folder.entries(), 0u);
}

TEST(Write, failure_leaves_the_old_file_and_nothing_else)
{
    TemporaryFolder folder;
    for (const char* ending : {".exr", ".png", ".hdr", ".pfm"}) {
        std::string name = std::string("a") + ending;
        fs::create_directory(folder / name);
        EXPECT_TRUE(contains(error_of([&] { check_writable(folder / name); }), "is a folder"));
        EXPECT_TRUE(contains(error_of([&] { write_picture(folder / name, test_picture(2, 2)); }), "is a folder"));
        fs::remove(folder / name);
        EXPECT_TRUE(contains(error_of([&] { write_picture(folder / "no" / name, test_picture(2, 2)); }),
                             "does not exist; create it"));
        EXPECT_EQ(folder.entries(), 0u);
        check_writable(folder / name);
        EXPECT_EQ(folder.entries(), 0u);
    }
}

TEST(Read, what_is_no_picture_is_refused)
{
    TemporaryFolder folder;
    put(folder / "a.png", "hello");
    EXPECT_TRUE(contains(error_of([&] { read_picture(folder / "a.png"); }), "is not a picture of a known kind; use"));
    put(folder / "empty.exr", "");
    EXPECT_TRUE(contains(error_of([&] { read_texture(folder / "empty.exr", true); }), "the file is empty"));
    EXPECT_TRUE(contains(error_of([&] { read_picture(folder / "missing.hdr"); }), "no such file"));
}

} // namespace snell
