#include "snell/io/text_encoding.h"

#include <algorithm>

namespace snell {
namespace {

bool is_text(unsigned char c)
{
    return (c >= ' ' && c < 0x7f) || c == '\t' || c == '\r' || c == '\n';
}

void append_utf8(unsigned c, std::string& to)
{
    const auto put = [&to](unsigned byte) { to += static_cast<char>(static_cast<unsigned char>(byte)); };
    if (c < 0x80) {
        put(c);
    } else if (c < 0x800) {
        put(0xc0 | c >> 6), put(0x80 | (c & 0x3f));
    } else if (c < 0x10000) {
        put(0xe0 | c >> 12), put(0x80 | (c >> 6 & 0x3f)), put(0x80 | (c & 0x3f));
    } else {
        put(0xf0 | c >> 18), put(0x80 | (c >> 12 & 0x3f)), put(0x80 | (c >> 6 & 0x3f)), put(0x80 | (c & 0x3f));
    }
}

constexpr unsigned replacement = 0xfffd;

} // namespace

Encoding detect_encoding(std::string_view start, std::size_t& mark)
{
    mark = 0;
    if (start.starts_with("\xEF\xBB\xBF")) {
        mark = 3;
        return Encoding::bytes;
    }
    if (start.size() < 4) return Encoding::bytes;
    const auto at = [&start](std::size_t i) { return static_cast<unsigned char>(start[i]); };
    for (const bool is_big : {false, true}) {
        const std::size_t low = is_big ? 1 : 0, high = 1 - low;
        const bool has_mark = at(low) == 0xff && at(high) == 0xfe;
        const bool is_ascii = is_text(at(low)) && at(high) == 0;
        if (!(has_mark || is_ascii) || !is_text(at(2 + low)) || at(2 + high) != 0) continue;
        mark = has_mark ? 2 : 0;
        return is_big ? Encoding::utf16_big : Encoding::utf16_little;
    }
    return Encoding::bytes;
}

void Utf16Decoder::add(unsigned unit, std::string& to)
{
    const bool is_high = unit >= 0xd800 && unit < 0xdc00, is_low = unit >= 0xdc00 && unit < 0xe000;
    if (high_ != 0 && is_low) {
        append_utf8(0x10000 + ((high_ - 0xd800) << 10) + (unit - 0xdc00), to);
        high_ = 0;
        return;
    }
    if (high_ != 0) append_utf8(replacement, to);
    high_ = is_high ? unit : 0;
    if (!is_high) append_utf8(is_low ? replacement : unit, to);
}

void Utf16Decoder::decode(std::string_view bytes, std::string& to)
{
    for (const char c : bytes) {
        const int byte = static_cast<unsigned char>(c);
        if (odd_ < 0) {
            odd_ = byte;
            continue;
        }
        add(static_cast<unsigned>(is_big_ ? odd_ << 8 | byte : byte << 8 | odd_), to);
        odd_ = -1;
    }
}

void Utf16Decoder::finish(std::string& to)
{
    if (odd_ >= 0 || high_ != 0) append_utf8(replacement, to);
    odd_ = -1, high_ = 0;
}

std::string to_utf8(std::string bytes)
{
    std::size_t mark = 0;
    const Encoding encoding = detect_encoding(std::string_view(bytes).substr(0, 4), mark);
    if (encoding == Encoding::bytes) return mark == 0 ? std::move(bytes) : bytes.substr(mark);
    std::string text;
    Utf16Decoder decoder(encoding == Encoding::utf16_big);
    decoder.decode(std::string_view(bytes).substr(mark), text);
    decoder.finish(text);
    return text;
}

} // namespace snell
