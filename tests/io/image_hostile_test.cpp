// Broken files: never a crash, a hang or a huge allocation, always either a picture or an Error that names the file.
#include "snell/io/image/read.h"
#include "snell/io/image/write.h"

#include "image_helpers.h"

#include <ImfRgbaFile.h>
#include <ImfTiledRgbaFile.h>

#include <cstdio>
#include <optional>

#include <utility>

namespace snell {

namespace {

std::optional<Picture> read_or_explain(const fs::path& file)
{
    try {
        Picture picture = read_picture(file);
        EXPECT_EQ(picture.pixels.size(),
                  static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height));
        return picture;
    } catch (const Error& e) {
        EXPECT_TRUE(contains(e.what(), file.filename().string())) << e.what();
        EXPECT_EQ(e.place.file, file.string());
        return std::nullopt;
    }
}

struct Victim
{
    std::string name;
    std::string bytes;
};

std::vector<Victim> victims(const TemporaryFolder& folder)
{
    std::vector<Victim> all;
    Picture picture = test_picture(40, 24);
    for (const char* name : {"a.exr", "a.png", "a.hdr", "a.pfm"}) {
        Layers layers;
        layers.attributes["comments"] = "made to be broken";
        write_picture(folder / name, picture, layers);
        all.push_back({name, get(folder / name)});
    }
    {
        std::vector<Imf::Rgba> pixels(40 * 24, Imf::Rgba(1, 2, 3));
        Imf::TiledRgbaOutputFile out((folder / "tiled.exr").c_str(), 40, 24, 16, 16, Imf::ONE_LEVEL, Imf::ROUND_DOWN,
                                     Imf::WRITE_RGBA, 1, {}, 1, Imf::INCREASING_Y, Imf::PIZ_COMPRESSION);
        out.setFrameBuffer(pixels.data(), 1, 40);
        out.writeTiles(0, out.numXTiles() - 1, 0, out.numYTiles() - 1);
    }
    all.push_back({"tiled.exr", get(folder / "tiled.exr")});
    {
        std::vector<Imf::Rgba> pixels(40 * 24, Imf::Rgba(1, 2, 3));
        Imf::RgbaOutputFile out((folder / "chroma.exr").c_str(), 40, 24, Imf::WRITE_YC);
        out.setFrameBuffer(pixels.data(), 1, 40);
        out.writePixels(24);
    }
    all.push_back({"chroma.exr", get(folder / "chroma.exr")});

    std::vector<std::uint8_t> bytes(40 * 24 * 4);
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(i < 2000 ? i * 77 : i / 400);
    all.push_back({"a.jpg", stb_jpeg(40, 24, 4, bytes.data())});
    all.push_back({"a.bmp", stb_bmp(40, 24, 4, bytes.data())});
    all.push_back({"packed.tga", stb_tga(40, 24, 4, bytes.data(), true)});
    all.push_back({"plain.tga", stb_tga(40, 24, 3, bytes.data(), false)});
    return all;
}

} // namespace

TEST(Hostile, files_that_are_cut_off_are_errors)
{
    TemporaryFolder folder;
    for (const Victim& victim : victims(folder)) {
        ASSERT_TRUE(read_or_explain((put(folder / victim.name, victim.bytes), folder / victim.name))) << victim.name;
        std::size_t step = std::max<std::size_t>(1, victim.bytes.size() / 200);
        for (std::size_t size = 0; size < victim.bytes.size(); size += step) {
            put(folder / victim.name, victim.bytes.substr(0, size));
            ASSERT_FALSE(read_or_explain(folder / victim.name)) << victim.name << " cut at " << size;
        }
        put(folder / victim.name, victim.bytes.substr(0, victim.bytes.size() - 1));
        ASSERT_FALSE(read_or_explain(folder / victim.name)) << victim.name << " without its last byte";
    }
}

TEST(Hostile, flipped_bytes_do_no_harm)
{
    TemporaryFolder folder;
    std::uint32_t state = 12345;
    auto next = [&]() {
        state = state * 1664525u + 1013904223u;
        return state >> 8;
    };
    for (const Victim& victim : victims(folder)) {
        int errors = 0;
        for (int i = 0; i < 500; ++i) {
            std::string bytes = victim.bytes;
            // Half of them in the header, where the damage is greatest.
            std::size_t range = i % 2 == 0 ? std::min<std::size_t>(bytes.size(), 400) : bytes.size();
            int flips = 1 + i % 4;
            for (int k = 0; k < flips; ++k) {
                std::size_t at = next() % range;
                static const char nasty[] = {'\x00', '\xff', '\x7f', '\x80', '\x01'};
                bytes[at] = next() % 2 == 0 ? nasty[next() % 5] : static_cast<char>(next());
            }
            put(folder / victim.name, bytes);
            if (!read_or_explain(folder / victim.name)) ++errors;
        }
        EXPECT_GT(errors, 0) << victim.name;
    }
}

TEST(Hostile, absurd_sizes_are_refused_before_memory_is_taken)
{
    TemporaryFolder folder;
    auto error = [&](const std::string& name, const std::string& bytes) {
        put(folder / name, bytes);
        return error_of([&] { read_picture(folder / name); });
    };
    EXPECT_TRUE(contains(error("a.pfm", "PF\n65536 65536\n-1.0\n1234"), "larger than the limit"));
    EXPECT_TRUE(contains(error("a.pfm", "PF\n16384 16384\n-1.0\n1234"), "cannot hold"));
    EXPECT_TRUE(contains(error("a.pfm", "PF\n-1 16384\n-1.0\n1234"), "no pixels"));
    EXPECT_TRUE(contains(error("a.pfm", "PF\n99999999999999999999 1\n-1.0\n1234"), "is not a number"));
    EXPECT_TRUE(contains(error("a.pfm", "PF\n1 1\n0\n123456789012"), "scale"));
    EXPECT_TRUE(contains(error("a.pfm", "PF\n1 1\nnan\n123456789012"), "scale"));
    EXPECT_TRUE(contains(error("a.hdr", "#?RADIANCE\n\n-Y 16384 +X 16384\n1234"), "cannot hold"));
    EXPECT_TRUE(contains(error("a.hdr", "#?RADIANCE\n\n-Y 16384 +Y 16384\n1234"), "bad resolution line"));
    std::string bmp = "BM" + std::string(52, '\0');
    bmp[14] = 40, bmp[21] = 0, bmp[20] = 64, bmp[24] = 64, bmp[26] = 1, bmp[28] = 24; // 2^22 by 2^22
    EXPECT_TRUE(contains(error("a.bmp", bmp), "larger than the limit"));
    std::string tga(18, '\0');
    tga[2] = 2, tga[13] = 32, tga[15] = 32, tga[16] = 24; // 8192 by 8192
    EXPECT_TRUE(contains(error("a.tga", tga), "cannot hold"));
    std::string jpeg("\xff\xd8\xff\xc0\x00\x11\x08\x40\x00\x40\x00\x03\x01\x11\x00\x02\x11\x00\x03\x11\x00\xff\xd9",
                     23);
    EXPECT_TRUE(contains(error("a.jpg", jpeg), "cannot hold"));
}

TEST(Hostile, absurd_exr_headers_are_refused_before_memory_is_taken)
{
    TemporaryFolder folder;
    write_picture(folder / "a.exr", test_picture(4, 4));
    const std::string good = get(folder / "a.exr");
    auto with = [&](const std::string& attribute, std::size_t skip, const std::string& value) {
        std::string bytes = good;
        std::size_t at = bytes.find(attribute + '\0');
        EXPECT_NE(at, std::string::npos);
        bytes.replace(at + skip, value.size(), value);
        put(folder / "a.exr", bytes);
        return error_of([&] { read_picture(folder / "a.exr"); });
    };
    // dataWindow\0box2i\0size, then x0 y0 x1 y1: 2^14 by 2^14, and beyond the limit.
    std::size_t value = 11 + 6 + 4;
    std::string message = with("dataWindow", value + 8, std::string("\xff\x3f\0\0\xff\x3f\0\0", 8));
    EXPECT_TRUE(contains(message, "cannot hold")) << message;
    message = with("dataWindow", value + 8, std::string("\xff\xff\xff\0\xff\x3f\0\0", 8));
    EXPECT_TRUE(contains(message, "larger than the limit")) << message;
    message = with("displayWindow", 14 + 6 + 4 + 8, std::string("\xff\x3f\0\0\xff\x3f\0\0", 8));
    EXPECT_TRUE(contains(message, "cannot hold")) << message;
    message = with("dataWindow", value + 8, std::string("\xff\xff\xff\x7f\xff\x3f\0\0", 8));
    EXPECT_TRUE(contains(message, "out of bounds")) << message;
    message = with("channels", 9 + 7, std::string("\xff\xff\xff\x7f", 4)); // an attribute of 2 GiB
    EXPECT_TRUE(contains(message, "cut off")) << message;
    std::string deep = good;
    deep[5] = static_cast<char>(deep[5] | 8);
    put(folder / "a.exr", deep);
    EXPECT_TRUE(contains(error_of([&] { read_picture(folder / "a.exr"); }), "deep pixels are not supported"));
}

// stb_image writes past its array for such a table.
TEST(Hostile, jpeg_with_an_overfull_huffman_table_is_refused)
{
    TemporaryFolder folder;
    std::vector<std::uint8_t> grey(64, 100);
    std::string bytes = stb_jpeg(8, 8, 1, grey.data());
    std::size_t table = bytes.find("\xff\xc4");
    ASSERT_NE(table, std::string::npos);
    bytes[table + 5 + 9] = '\xff';
    bytes[table + 5 + 10] = '\xff';
    put(folder / "a.jpg", bytes);
    EXPECT_TRUE(contains(error_of([&] { read_picture(folder / "a.jpg"); }), "broken Huffman table"));
}

TEST(Hostile, jpeg_of_endless_scans_is_refused)
{
    TemporaryFolder folder;
    std::vector<std::uint8_t> grey(64, 100);
    std::string bytes = stb_jpeg(8, 8, 1, grey.data());
    std::size_t scan = bytes.find("\xff\xda");
    ASSERT_NE(scan, std::string::npos);
    std::string once = bytes.substr(scan, bytes.size() - 2 - scan);
    for (int i = 0; i < 300; ++i) bytes.insert(scan, once);
    put(folder / "a.jpg", bytes);
    EXPECT_TRUE(contains(error_of([&] { read_picture(folder / "a.jpg"); }), "more than 256 scans"));
}

} // namespace snell
