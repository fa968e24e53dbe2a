#include "mutate.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstring>

namespace snell::hostile {

std::uint32_t Random::next()
{
    const std::uint64_t old = state_;
    state_ = old * 6364136223846793005u + 1442695040888963407u;
    const auto mixed = static_cast<std::uint32_t>(((old >> 18) ^ old) >> 27);
    const auto turn = static_cast<std::uint32_t>(old >> 59);
    return mixed >> turn | mixed << ((32 - turn) & 31);
}

namespace {

// What readers are most likely to get wrong.
constexpr std::array numbers = {"0",
                                "-1",
                                "1",
                                "2",
                                "3",
                                "255",
                                "256",
                                "65535",
                                "65536",
                                "1000000",
                                "2147483647",
                                "-2147483648",
                                "2147483648",
                                "4294967295",
                                "4294967296",
                                "99999999999",
                                "9223372036854775807",
                                "18446744073709551615",
                                "1e999",
                                "-1e999",
                                "1e-999",
                                "nan",
                                "inf",
                                "-inf",
                                "1e38",
                                "3.5e38",
                                "1e20",
                                "0.5",
                                "-0.0",
                                "1e",
                                "--1",
                                "0x10",
                                "1.5.5",
                                ""};
constexpr std::array<std::uint64_t, 14> words = {0,
                                                 1,
                                                 0x7f,
                                                 0x80,
                                                 0xff,
                                                 0x7fff,
                                                 0x8000,
                                                 0xffff,
                                                 0x10000,
                                                 0x7fffffff,
                                                 0x80000000,
                                                 0xffffffff,
                                                 0x7fffffffffffffff,
                                                 0xffffffffffffffff};

bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}
bool is_word(char c)
{
    return is_digit(c) || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || c == '.' || c == '-';
}

struct Range
{
    std::size_t begin = 0, end = 0;
};

// A run of characters that satisfy `is`, at or behind a random place.
template <class F>
Range find_run(const std::string& bytes, Random& random, F is)
{
    std::size_t begin = random.below(bytes.size());
    while (begin > 0 && is(bytes[begin - 1])) --begin;
    while (begin < bytes.size() && !is(bytes[begin])) ++begin;
    std::size_t end = begin;
    while (end < bytes.size() && is(bytes[end])) ++end;
    return {begin, end};
}

Range find_block(const std::string& bytes, Random& random)
{
    const std::size_t begin = random.below(bytes.size());
    const std::size_t longest = random.one_in(4) ? bytes.size() : std::min<std::size_t>(64, bytes.size());
    return {begin, std::min(bytes.size(), begin + 1 + random.below(longest))};
}

Range find_line(const std::string& bytes, Random& random)
{
    const std::size_t at = random.below(bytes.size());
    const std::size_t before = bytes.rfind('\n', at == 0 ? 0 : at - 1), behind = bytes.find('\n', at);
    return {before == std::string::npos ? 0 : before + 1, behind == std::string::npos ? bytes.size() : behind + 1};
}

std::string piece(const std::string& bytes, Range range)
{
    return range.begin < range.end ? bytes.substr(range.begin, range.end - range.begin) : std::string();
}

void put_word(std::string& bytes, Random& random)
{
    // Most fields that matter are in the first bytes.
    const std::size_t span = random.one_in(2) ? std::min<std::size_t>(bytes.size(), 128) : bytes.size();
    const std::size_t at = random.below(span), size = std::size_t(1) << random.below(4);
    std::uint64_t word = words[random.below(words.size())];
    if (random.one_in(4)) word = random.next();
    const bool is_big = random.one_in(2);
    for (std::size_t i = 0; i < size && at + i < bytes.size(); ++i)
        bytes[at + i] = static_cast<char>(word >> (8 * (is_big ? size - 1 - i : i)));
}

void repeat(std::string& bytes, Range range, Random& random)
{
    const std::string part = piece(bytes, range);
    const std::size_t count = random.one_in(8) ? 1 + random.below(40) : 1;
    std::string more;
    for (std::size_t i = 0; i < count && more.size() < 4096; ++i) more += part;
    bytes.insert(range.begin, more);
}

void damage_once(std::string& bytes, const std::vector<std::string>& seeds, Random& random)
{
    if (bytes.empty()) bytes = "0";
    const std::size_t at = random.below(bytes.size());
    switch (random.below(16)) {
    case 0:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << random.below(8)));
        break;
    case 1:
        bytes[at] = static_cast<char>(random.next());
        break;
    case 2:
    case 3:
    case 4:
        put_word(bytes, random);
        break;
    case 5:
        bytes.resize(at);
        break;
    case 6: {
        const Range range = find_block(bytes, random);
        bytes.erase(range.begin, range.end - range.begin);
        break;
    }
    case 7:
        repeat(bytes, find_block(bytes, random), random);
        break;
    case 8: {
        const std::string part = piece(bytes, find_block(bytes, random));
        bytes.replace(at, std::min(part.size(), bytes.size() - at), part);
        break;
    }
    case 9:
    case 10:
    case 11: {
        const Range range = find_run(bytes, random, is_digit);
        // With what a number may have before and behind its digits, half of the time.
        Range wide = range;
        if (random.one_in(2)) {
            while (wide.begin > 0 && is_word(bytes[wide.begin - 1])) --wide.begin;
            while (wide.end < bytes.size() && is_word(bytes[wide.end])) ++wide.end;
        }
        bytes.replace(wide.begin, wide.end - wide.begin, numbers[random.below(numbers.size())]);
        break;
    }
    case 12: {
        const Range from = find_run(bytes, random, is_word), to = find_run(bytes, random, is_word);
        bytes.replace(to.begin, to.end - to.begin, random.one_in(4) ? std::string() : piece(bytes, from));
        break;
    }
    case 13: {
        const Range line = find_line(bytes, random);
        if (random.one_in(2))
            bytes.erase(line.begin, line.end - line.begin);
        else
            repeat(bytes, line, random);
        break;
    }
    case 14: {
        const Range line = find_line(bytes, random);
        const std::string part = piece(bytes, line);
        bytes.erase(line.begin, line.end - line.begin);
        bytes.insert(random.below(bytes.size() + 1), part);
        break;
    }
    default: {
        const std::string& other = seeds[random.below(seeds.size())];
        if (other.empty()) break;
        const std::string part = piece(other, random.one_in(2) ? find_line(other, random) : find_block(other, random));
        bytes.insert(at, part);
    }
    }
}

std::uint32_t little(std::string_view bytes, std::size_t at)
{
    std::uint32_t n = 0;
    for (std::size_t i = 0; i < 4; ++i) n |= std::uint32_t(static_cast<std::uint8_t>(bytes[at + i])) << (8 * i);
    return n;
}
void put_little(std::string& bytes, std::size_t at, std::uint32_t n)
{
    for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<char>(n >> (8 * i));
}

void repair_png(std::string& bytes)
{
    for (std::size_t at = 8; at + 12 <= bytes.size();) {
        std::uint32_t size = 0;
        for (std::size_t i = 0; i < 4; ++i) size = size << 8 | static_cast<std::uint8_t>(bytes[at + i]);
        if (size > bytes.size() - at - 12) return;
        const auto sum = ::crc32(0, reinterpret_cast<const Bytef*>(bytes.data() + at + 4), size + 4);
        for (std::size_t i = 0; i < 4; ++i) bytes[at + 8 + size + i] = static_cast<char>(sum >> (8 * (3 - i)));
        at += 12 + size;
    }
}

// The JSON chunk ends at the last brace before the binary one, wherever that has moved to.
void repair_glb(std::string& bytes)
{
    if (bytes.size() < 20) return;
    std::size_t binary = bytes.find(std::string("BIN\0", 4));
    if (binary == std::string::npos || binary < 24) binary = bytes.size() + 4;
    const std::size_t end = std::min(binary - 4, bytes.size()); // of the JSON chunk
    put_little(bytes, 12, static_cast<std::uint32_t>(end - 20));
    if (end % 4 != 0) {
        bytes.insert(end, 4 - end % 4, ' ');
        put_little(bytes, 12, static_cast<std::uint32_t>(end + 4 - end % 4 - 20));
    }
    const std::size_t chunk = 20 + little(bytes, 12);
    if (chunk + 8 <= bytes.size()) put_little(bytes, chunk, static_cast<std::uint32_t>(bytes.size() - chunk - 8));
    put_little(bytes, 8, static_cast<std::uint32_t>(bytes.size()));
}

} // namespace

std::string repair(const std::string& format, std::string bytes)
{
    if (format == "png") repair_png(bytes);
    if (format == "glb") repair_glb(bytes);
    return bytes;
}

std::string mutate(const std::string& format, const std::vector<std::string>& seeds, Random& random)
{
    std::string bytes = seeds[random.below(seeds.size())];
    for (std::size_t i = 0, count = random.one_in(2) ? 1 : 1 + random.below(4); i < count; ++i)
        damage_once(bytes, seeds, random);
    if (bytes.size() > 1 << 16) bytes.resize(1 << 16);
    return random.one_in(8) ? bytes : repair(format, std::move(bytes));
}

} // namespace snell::hostile
