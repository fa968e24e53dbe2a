#include "snell/io/gzip.h"

#include "snell/io/byte_window.h"
#include "tests/io/mesh_files.h"

#include <zlib.h>

#include <algorithm>
#include <cstring>

namespace snell {
namespace {

using namespace test;

// As `gzip` packs it.
std::string packed(std::string_view bytes, int level = 9)
{
    z_stream stream = {};
    EXPECT_EQ(deflateInit2(&stream, level, Z_DEFLATED, 15 + 16, 9, Z_DEFAULT_STRATEGY), Z_OK);
    std::string out(deflateBound(&stream, bytes.size()) + 64, '\0');
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream.avail_in = static_cast<uInt>(bytes.size());
    stream.next_out = reinterpret_cast<Bytef*>(out.data());
    stream.avail_out = static_cast<uInt>(out.size());
    EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
    out.resize(stream.total_out);
    deflateEnd(&stream);
    return out;
}

std::string error_of(const std::string& bytes)
{
    try {
        gunzip("a.gz", bytes);
    } catch (const Error& error) {
        return error.what();
    }
    return {};
}

std::string noise(std::size_t size)
{
    std::string bytes(size, '\0');
    std::uint32_t state = 7;
    for (char& c : bytes) c = static_cast<char>((state = state * 1664525u + 1013904223u) >> 24);
    return bytes;
}

TEST(Gzip, WhatWasPackedComesBack)
{
    EXPECT_TRUE(is_gzip(packed("x")));
    EXPECT_FALSE(is_gzip("ply\n"));
    for (const std::string& bytes : {std::string(), std::string("x"), noise(300000), std::string(2000000, 'v')})
        EXPECT_TRUE(gunzip("a.gz", packed(bytes)) == bytes) << bytes.size();
    // Several members, and what tapes leave behind them.
    EXPECT_EQ(gunzip("a.gz", packed("one ") + packed("") + packed("two") + std::string(1000, '\0')), "one two");
}

TEST(Gzip, DamageIsAnError)
{
    const std::string good = packed(noise(5000));
    for (std::size_t size = 0; size < good.size(); size += 97) EXPECT_NE(error_of(good.substr(0, size)), "") << size;
    for (std::size_t at = 0; at < good.size(); at += 53) {
        std::string bad = good;
        bad[at] = static_cast<char>(bad[at] ^ 0x10);
        const bool is_unchecked = at >= 4 && at < 10; // time, hints, system
        EXPECT_EQ(error_of(bad).empty(), is_unchecked) << at;
    }
    EXPECT_NE(error_of(good.substr(0, 100)).find("a.gz: the gzip data ends early"), std::string::npos);
    EXPECT_NE(error_of(good + "more").find("damaged"), std::string::npos);
}

TEST(Gzip, BombsStopAtTheLimit)
{
    EXPECT_EQ(gzip_limit(1000), 64u << 20);
    EXPECT_EQ(gzip_limit(1u << 30), 200ull << 30);
    const std::string bomb = packed(std::string(std::size_t{66} << 20, ' '), 1); // 360 kB
    EXPECT_NE(error_of(bomb).find("inflates to more than "), std::string::npos);
    // One that a reader meets.
    const Folder folder;
    std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    const std::string blank = std::string(std::size_t{1} << 20, ' ') + '\n';
    while (text.size() < std::size_t{66} << 20) text += blank;
    EXPECT_NE(load_error(folder.write("bomb.obj.gz", packed(text, 1))).find("inflates to more than"),
              std::string::npos);
}

TEST(Gzip, MeshesOfAllFormatsOpenPacked)
{
    const Folder folder;
    const std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    const Scene scene = load_scene(folder.write("my mesh.OBJ.GZ", packed(obj)));
    EXPECT_EQ(triangle_count(scene), 1u);
    EXPECT_EQ(scene.name, "my mesh");

    const std::string header = "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\n"
                               "property float y\nproperty float z\nelement face 2000\n"
                               "property list uchar uchar vertex_indices\nend_header\n";
    const float corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    std::string ply = header + std::string(reinterpret_cast<const char*>(corners), sizeof corners);
    for (int i = 0; i < 2000; ++i) ply += std::string("\3\0\1\2", 4);
    EXPECT_EQ(triangle_count(load_scene(folder.write("a.ply.gz", packed(ply)))), 2000u);
    EXPECT_EQ(triangle_count(load_scene(folder.write("named_otherwise.ply", packed(ply)))), 2000u);
    EXPECT_NE(load_error(folder.write("a.ply.gz", packed(ply.substr(0, ply.size() - 2)))), "");
    // A packed file may announce more than one could allocate.
    std::string greedy = ply;
    greedy.replace(greedy.find("vertex 3"), 8, "vertex 4000000000");
    EXPECT_NE(load_error(folder.write("a.ply.gz", packed(greedy))).find("announces 4000000000 rows"),
              std::string::npos);

    std::string stl(84, '\0');
    stl[80] = 3;
    for (int i = 0; i < 3; ++i) {
        const float facet[12] = {0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, float(i)};
        stl.append(reinterpret_cast<const char*>(facet), sizeof facet).append(2, '\0');
    }
    EXPECT_EQ(triangle_count(load_scene(folder.write("a.stl.gz", packed(stl)))), 3u);
    EXPECT_NE(load_error(folder.write("a.stl.gz", packed(stl.substr(0, 200)))).find("3 facets"), std::string::npos);
}

// Whatever the size of the window, the same bytes come through it.
TEST(ByteWindow, AllSizesShowTheSame)
{
    const Folder folder;
    const std::string plain = noise(5000);
    std::string wide = "\xff\xfe", narrow;
    for (int i = 0; i < 3000; ++i) {
        const char c = static_cast<char>('a' + i % 26);
        wide += c, wide += '\0';
        narrow += c;
    }
    const auto expect = [&](const std::string& name, const std::string& bytes, const std::string& content) {
        const auto file = folder.write(name, bytes);
        for (const std::size_t size : {16, 17, 100, 1 << 16}) {
            ByteWindow window(file, size);
            std::string seen;
            for (std::size_t step = 1;; step = step % 37 + 1) {
                EXPECT_GE(window.most_left(), window.view().size());
                EXPECT_GE(window.most_left() + seen.size(), content.size());
                const std::size_t n = std::min(step, window.view().size());
                seen += window.view().substr(0, n);
                window.take(n);
                if (n < step && !window.more() && window.view().empty()) break;
            }
            EXPECT_TRUE(seen == content) << name << " " << size;
            EXPECT_TRUE(window.at_end());
            EXPECT_EQ(window.disk_done(), bytes.size());
        }
    };
    expect("plain", plain, plain);
    expect("packed", packed(plain), plain);
    expect("marked", "\xEF\xBB\xBFtext", "text");
    expect("wide", wide, narrow);
    expect("packed wide", packed(wide), narrow);
    expect("empty", "", "");
    expect("short", "ab", "ab");
}

} // namespace
} // namespace snell
