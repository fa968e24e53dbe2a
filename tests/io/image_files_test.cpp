// Other people's files, where they are at hand.
#include "snell/io/image/read.h"

#include "image_helpers.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace snell {

namespace {

// The folder of test pictures, or empty after saying what is left out.
fs::path images(const char* what)
{
    fs::path folder = fs::path(SNELL_SOURCE_DIR) / "../shared/scenes/images";
    if (fs::is_directory(folder)) return folder;
    std::printf("left out, because %s does not exist: %s\n", folder.c_str(), what);
    return {};
}

struct KnownTexel
{
    int x, y;
    int rgba[4];
};

struct KnownFile
{
    const char* name;
    uint width, height;
    KnownTexel texels[4];
};

} // namespace

TEST(Files, all_pictures_load)
{
    fs::path folder = images("loading every picture");
    if (folder.empty()) return;
    int count = 0;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
        if (!entry.is_regular_file() || entry.path().extension() == "" || entry.path().extension() == ".md") continue;
        SCOPED_TRACE(entry.path().string());
        Picture picture = read_picture(entry.path());
        EXPECT_GT(picture.width, 0);
        EXPECT_GT(picture.height, 0);
        Image image = read_texture(entry.path(), true);
        EXPECT_EQ(image.width, static_cast<uint>(picture.width));
        EXPECT_EQ(image.height, static_cast<uint>(picture.height));
        EXPECT_TRUE(std::all_of(image.floats.begin(), image.floats.end(), [](float f) { return is_finite(f); }));
        ++count;
    }
    EXPECT_GT(count, 50);
}

// Values by an independent decoder, written for this from the PNG specification.
TEST(Files, png_suite_has_the_values_of_another_decoder)
{
    fs::path folder = images("known values of the PNG suite");
    if (folder.empty()) return;
    static const KnownFile files[] = {
        {"16bit/basn0g16",
         32,
         32,
         {{0, 0, {0, 0, 0, 65535}},
          {31, 0, {47871, 47871, 47871, 65535}},
          {15, 10, {39680, 39680, 39680, 65535}},
          {30, 31, {7167, 7167, 7167, 65535}}}},
        {"16bit/basn2c16",
         32,
         32,
         {{0, 0, {65535, 65535, 0, 65535}},
          {31, 0, {0, 65535, 0, 65535}},
          {15, 10, {33825, 44395, 0, 65535}},
          {30, 31, {2114, 0, 63421, 65535}}}},
        {"16bit/basn4a16",
         32,
         32,
         {{0, 0, {0, 0, 0, 0}},
          {31, 0, {0, 0, 0, 0}},
          {15, 10, {59577, 59577, 59577, 42281}},
          {30, 31, {4228, 4228, 4228, 0}}}},
        {"16bit/basn6a16",
         32,
         32,
         {{0, 0, {65535, 65535, 0, 0}},
          {31, 0, {0, 65535, 0, 0}},
          {15, 10, {35746, 65535, 0, 42281}},
          {30, 31, {2114, 0, 63420, 0}}}},
        {"16bit/tbbn2c16",
         32,
         32,
         {{0, 0, {65535, 65535, 65535, 0}},
          {31, 0, {65535, 65535, 65535, 0}},
          {15, 10, {31611, 31611, 31611, 65535}},
          {30, 31, {65535, 65535, 65535, 0}}}},
        {"16bit/tbwn0g16",
         32,
         32,
         {{0, 0, {65535, 65535, 65535, 0}},
          {31, 0, {65535, 65535, 65535, 0}},
          {15, 10, {31611, 31611, 31611, 65535}},
          {30, 31, {65535, 65535, 65535, 0}}}},
        {"primary/basn3p02",
         32,
         32,
         {{0, 0, {0, 0, 255, 255}}, {31, 0, {0, 255, 0, 255}}, {15, 10, {255, 0, 0, 255}}, {30, 31, {0, 0, 255, 255}}}},
        {"primary/basn3p08",
         32,
         32,
         {{0, 0, {1, 0, 0, 255}},
          {31, 0, {1, 0, 1, 255}},
          {15, 10, {83, 170, 0, 255}},
          {30, 31, {255, 254, 255, 255}}}},
        {"primary/basn0g04",
         32,
         32,
         {{0, 0, {0, 0, 0, 255}},
          {31, 0, {119, 119, 119, 255}},
          {15, 10, {85, 85, 85, 255}},
          {30, 31, {238, 238, 238, 255}}}},
        {"primary/basn4a08",
         32,
         32,
         {{0, 0, {255, 255, 255, 0}},
          {31, 0, {255, 255, 255, 255}},
          {15, 10, {172, 172, 172, 123}},
          {30, 31, {0, 0, 0, 246}}}},
        {"primary/tbbn0g04",
         32,
         32,
         {{0, 0, {255, 255, 255, 0}},
          {31, 0, {255, 255, 255, 0}},
          {15, 10, {119, 119, 119, 255}},
          {30, 31, {255, 255, 255, 0}}}},
        {"primary/tbwn3p08",
         32,
         32,
         {{0, 0, {255, 255, 255, 0}},
          {31, 0, {255, 255, 255, 0}},
          {15, 10, {123, 123, 123, 255}},
          {30, 31, {255, 255, 255, 0}}}},
        {"primary/tp0n0g08",
         32,
         32,
         {{0, 0, {127, 127, 127, 255}},
          {31, 0, {127, 127, 127, 255}},
          {15, 10, {123, 123, 123, 255}},
          {30, 31, {127, 127, 127, 255}}}},
        {"primary/tm3n3p02",
         32,
         32,
         {{0, 0, {0, 0, 255, 0}}, {31, 0, {0, 0, 255, 85}}, {15, 10, {0, 0, 255, 0}}, {30, 31, {0, 0, 255, 255}}}},
        {"primary/s05n3p02",
         5,
         5,
         {{0, 0, {255, 0, 0, 255}}, {4, 0, {255, 0, 0, 255}}, {1, 1, {119, 0, 255, 255}}, {3, 4, {255, 0, 0, 255}}}},

    };
    for (const KnownFile& file : files) {
        SCOPED_TRACE(file.name);
        Image image = read_texture(folder / "png" / (std::string(file.name) + ".png"), false);
        ASSERT_EQ(image.width, file.width);
        ASSERT_EQ(image.height, file.height);
        bool is_wide = image.format == texels_rgba32f;
        EXPECT_EQ(is_wide, std::string(file.name).starts_with("16bit"));
        for (const KnownTexel& texel : file.texels) {
            std::size_t at = 4 * (static_cast<std::size_t>(texel.y) * image.width + static_cast<std::size_t>(texel.x));
            for (std::size_t c = 0; c < 4; ++c) {
                if (is_wide)
                    EXPECT_EQ(image.floats[at + c], static_cast<float>(texel.rgba[c]) / 65535.0f);
                else
                    EXPECT_EQ(image.bytes[at + c], texel.rgba[c]);
            }
        }
    }
}

TEST(Files, interlaced_png_equals_its_plain_twin)
{
    fs::path folder = images("interlaced twins of the PNG suite");
    if (folder.empty()) return;
    for (const char* name : {"16bit/basX0g16", "16bit/basX2c16", "16bit/basX4a16", "16bit/basX6a16", "primary/basX0g01",
                             "primary/basX3p04", "primary/basX6a08", "primary/s37X3p04"}) {
        std::string plain = name, interlaced = name;
        plain.replace(plain.find('X'), 1, "n");
        interlaced.replace(interlaced.find('X'), 1, "i");
        Image a = read_texture(folder / "png" / (plain + ".png"), true);
        Image b = read_texture(folder / "png" / (interlaced + ".png"), true);
        EXPECT_FALSE(a.bytes.empty() && a.floats.empty());
        EXPECT_EQ(a.bytes, b.bytes) << name;
        EXPECT_EQ(a.floats, b.floats) << name;
    }
}

TEST(Files, exr_test_images_have_their_documented_content)
{
    fs::path folder = images("content of the OpenEXR test images");
    if (folder.empty()) return;
    // All 65536 half values, NaN and infinity included, survive in a picture and not in a texture.
    Picture halves = read_picture(folder / "exr/TestImages/AllHalfValues.exr");
    ASSERT_EQ(halves.pixels.size(), 65536u);
    auto is_bad = [](vec3 p) { return !is_finite(p.x); };
    EXPECT_EQ(std::count_if(halves.pixels.begin(), halves.pixels.end(), is_bad), 2 * 1024); // exponent all ones
    // Luminance alone is grey; with chroma, colour comes back.
    auto chroma = [&](const char* name) {
        double difference = 0.0, sum = 0.0;
        for (vec3 p : read_picture(folder / name).pixels) {
            difference += static_cast<double>(std::abs(p.x - p.z));
            sum += static_cast<double>(p.x + p.y + p.z);
        }
        EXPECT_GT(sum, 0.0);
        return difference / sum;
    };
    EXPECT_EQ(chroma("exr/LuminanceChroma/Garden.exr"), 0.0);
    EXPECT_GT(chroma("exr/Chromaticities/Rec709_YC.exr"), 0.05);
}

} // namespace snell
