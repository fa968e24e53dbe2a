#include "snell/io/gltf/uri.h"

#include "snell/core/error.h"

#include <array>
#include <cstdint>

namespace snell::gltf {
namespace {

int hex_digit(char c)
{
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

constexpr std::uint8_t no_digit = 64;

// Both alphabets of RFC 4648.
constexpr std::array<std::uint8_t, 256> digits = [] {
    std::array<std::uint8_t, 256> table = {};
    for (auto& entry : table) entry = no_digit;
    for (std::uint8_t i = 0; i < 26; ++i) {
        table[static_cast<std::size_t>('A' + i)] = i;
        table[static_cast<std::size_t>('a' + i)] = static_cast<std::uint8_t>(26 + i);
    }
    for (std::uint8_t i = 0; i < 10; ++i) table[static_cast<std::size_t>('0' + i)] = static_cast<std::uint8_t>(52 + i);
    table['+'] = table['-'] = 62;
    table['/'] = table['_'] = 63;
    return table;
}();

std::string decode_base64(std::string_view text, const std::string& place)
{
    std::string out;
    out.reserve(text.size() / 4 * 3 + 3);
    std::uint32_t bits = 0;
    int count = 0;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (c == '=') break;
        if (c == '\n' || c == '\r' || c == ' ' || c == '\t') continue;
        const std::uint8_t digit = digits[static_cast<std::uint8_t>(c)];
        if (digit == no_digit)
            throw Error(fmt::format("{}the data URI has a character at {} that is no base64", place, i),
                        "write the file again");
        bits = bits << 6 | digit;
        if (++count % 4 != 0) continue;
        out += static_cast<char>(bits >> 16 & 255);
        out += static_cast<char>(bits >> 8 & 255);
        out += static_cast<char>(bits & 255);
    }
    if (count % 4 == 1) throw Error(fmt::format("{}the data URI is cut off", place), "write the file again");
    if (count % 4 == 2) out += static_cast<char>(bits >> 4 & 255);
    if (count % 4 == 3) {
        out += static_cast<char>(bits >> 10 & 255);
        out += static_cast<char>(bits >> 2 & 255);
    }
    return out;
}

} // namespace

bool is_data_uri(std::string_view uri)
{
    return uri.starts_with("data:");
}

bool has_scheme(std::string_view uri)
{
    const std::size_t colon = uri.find(':');
    if (colon == std::string_view::npos || colon < 2) return false;
    for (const char c : uri.substr(0, colon)) {
        const bool is_letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
        if (!is_letter && !(c >= '0' && c <= '9') && c != '+' && c != '-' && c != '.') return false;
    }
    return uri.substr(colon).starts_with("://");
}

std::string decode_data_uri(std::string_view uri, const std::string& place)
{
    const std::size_t comma = uri.find(',');
    if (comma == std::string_view::npos)
        throw Error(fmt::format("{}the data URI has no data", place), "write the file again");
    const std::string_view head = uri.substr(0, comma), body = uri.substr(comma + 1);
    return head.ends_with(";base64") ? decode_base64(body, place) : decode_percent(body);
}

std::string decode_percent(std::string_view text)
{
    std::string out;
    out.reserve(text.size());
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] == '%' && i + 2 < text.size() && hex_digit(text[i + 1]) >= 0 && hex_digit(text[i + 2]) >= 0) {
            out += static_cast<char>(hex_digit(text[i + 1]) * 16 + hex_digit(text[i + 2]));
            i += 2;
        } else {
            out += text[i];
        }
    }
    return out;
}

} // namespace snell::gltf
