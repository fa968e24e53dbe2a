#include "seeds.h"

#include <zlib.h>

#include <stdexcept>

namespace snell::hostile {

namespace {

std::string binary_ply(bool is_big)
{
    Bytes out;
    out.is_big = is_big;
    out.add("ply\nformat binary_").add(is_big ? "big" : "little").add("_endian 1.0\ncomment a seed\n");
    out.add("element vertex 4\nproperty float x\nproperty double y\nproperty short z\nproperty uchar red\n"
            "property uchar green\nproperty uchar blue\nproperty float s\nproperty float t\nproperty list uchar int "
            "extra\nelement face 2\nproperty uchar flags\nproperty list uchar uint vertex_indices\nelement other 1\n"
            "property list ushort double ignored\nend_header\n");
    for (int i = 0; i < 4; ++i) {
        out.put(static_cast<float>(i % 2)).put(static_cast<double>(i / 2)).put<std::int16_t>(0);
        out.add("\x10\x80\xff").put(0.5f).put(0.25f);
        out.put<std::uint8_t>(1).put<std::int32_t>(7);
    }
    for (const auto& [a, b, c] : {std::tuple(0u, 1u, 2u), std::tuple(1u, 3u, 2u)})
        out.put<std::uint8_t>(0).put<std::uint8_t>(3).put(a).put(b).put(c);
    out.put<std::uint16_t>(2).put(1.0).put(2.0);
    return out.text;
}

std::string strips_ply()
{
    Bytes out;
    out.add(
        "ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
        "z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n");
    for (int i = 0; i < 4; ++i) out.put(static_cast<float>(i % 2)).put(static_cast<float>(i / 2)).put(1.0f);
    out.put<std::int32_t>(8);
    for (const int i : {0, 1, 2, 3, -1, 3, 1, 0}) out.put<std::int32_t>(i);
    return out.text;
}

std::string binary_stl(std::string_view header)
{
    Bytes out;
    out.add(header).add(std::string(80 - header.size(), ' ')).put<std::uint32_t>(4);
    const float corners[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int skip = 0; skip < 4; ++skip) {
        for (int i = 0; i < 3; ++i) out.put(0.0f);
        for (int corner = 0; corner < 4; ++corner)
            if (corner != skip)
                for (const float x : corners[corner]) out.put(x);
        out.put<std::uint16_t>(0);
    }
    return out.text;
}

std::string gzip(const std::string& plain)
{
    z_stream stream = {};
    constexpr int gzip_format = 31;
    if (::deflateInit2(&stream, 9, Z_DEFLATED, gzip_format, 8, Z_DEFAULT_STRATEGY) != Z_OK)
        throw std::runtime_error("zlib cannot deflate");
    std::string packed(plain.size() + 64, '\0');
    std::string input = plain;
    stream.next_in = reinterpret_cast<Bytef*>(input.data());
    stream.avail_in = static_cast<uInt>(input.size());
    stream.next_out = reinterpret_cast<Bytef*>(packed.data());
    stream.avail_out = static_cast<uInt>(packed.size());
    ::deflate(&stream, Z_FINISH);
    packed.resize(stream.total_out);
    ::deflateEnd(&stream);
    return packed;
}

std::string utf16(std::string_view text, bool is_big)
{
    Bytes out;
    out.is_big = is_big;
    out.put<std::uint16_t>(0xfeff);
    for (const char c : text) out.put(static_cast<std::uint16_t>(c));
    return out.text;
}

} // namespace

std::vector<Seed> made_mesh_seeds(const std::string& format)
{
    const std::string half = binary_ply(false).substr(0, 200), rest = binary_ply(false).substr(200);
    if (format == "ply") return {{"little", binary_ply(false)}, {"big", binary_ply(true)}, {"strips", strips_ply()}};
    if (format == "stl")
        return {{"binary", binary_stl("a seed")}, {"binary_solid", binary_stl("solid, it says, and lies")}};
    if (format == "gz")
        return {{"little", gzip(binary_ply(false))},
                {"two_members", gzip(half) + gzip(rest)},
                {"zeros_behind", gzip(strips_ply()) + std::string(20, '\0')}};
    if (format == "obj")
        return {{"utf16_little", utf16("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", false)},
                {"utf16_big", utf16("v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 2 3\r\n", true)}};
    return {};
}

} // namespace snell::hostile
