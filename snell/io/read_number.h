// Decimal numbers from text: the inner loop of all text formats.
#pragma once

#include <bit>
#include <charconv>
#include <cstdint>
#include <cstdlib>
#include <string>

namespace snell {

// The common case of read_float(): sign, up to 19 digits with a point among them, a small exponent. Returns the
// position behind the number, or null if this is not it or the result could be rounded wrongly.
//
// The digits as an integer below 2^53, times or divided by a power of ten up to 10^22, is the correctly rounded double
// (Clinger 1990). Rounding it once more to float is right unless the double lies exactly between two floats, for then
// the digits may have been a little to one side of it.
inline const char* read_plain_float(const char* p, const char* end, float& value)
{
    static constexpr double powers[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                        1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    if (p == end) return nullptr;
    const bool is_negative = *p == '-';
    if (is_negative || *p == '+') ++p;
    const auto digit = [](char c) { return static_cast<unsigned>(static_cast<unsigned char>(c)) - '0'; };

    std::uint64_t digits = 0;
    const char* const first = p;
    for (; p < end && digit(*p) < 10; ++p) digits = 10 * digits + digit(*p);
    std::ptrdiff_t count = p - first, exponent = 0;
    if (p < end && *p == '.') {
        const char* const point = p++;
        for (; p < end && digit(*p) < 10; ++p) digits = 10 * digits + digit(*p);
        exponent = point + 1 - p;
        count -= exponent;
    }
    if (count == 0 || count > 19) return nullptr;
    if (p < end && (*p | 0x20) == 'e') {
        const char* q = p + 1;
        const bool is_small = q < end && *q == '-';
        if (q < end && (is_small || *q == '+')) ++q;
        int power = 0;
        const char* const start = q;
        for (; q < end && digit(*q) < 10 && q - start < 4; ++q) power = 10 * power + static_cast<int>(digit(*q));
        if (q == start || q - start > 3) return nullptr;
        exponent += is_small ? -power : power;
        p = q;
    }
    if (digits >= std::uint64_t{1} << 53 || exponent < -22 || exponent > 22) return nullptr;
    const double number = static_cast<double>(digits);
    const double exact = exponent < 0 ? number / powers[-exponent] : number * powers[exponent];
    constexpr std::uint64_t dropped = (std::uint64_t{1} << 29) - 1, half = std::uint64_t{1} << 28;
    if ((std::bit_cast<std::uint64_t>(exact) & dropped) == half) return nullptr;
    if (digits != 0 && (exact < 1.2e-38 || exact > 3.4e38)) return nullptr;
    value = static_cast<float>(is_negative ? -exact : exact);
    return p;
}

// Reads the float that [p, end) begins with, correctly rounded, and moves p behind it; +1, .5, nan and inf are numbers,
// too large ones become infinite. False, with p unmoved, if there is none.
inline bool read_float(const char*& p, const char* end, float& value)
{
    if (const char* const behind = read_plain_float(p, end, value)) {
        p = behind;
        return true;
    }
    const char* start = p;
    if (start < end && *start == '+') ++start; // from_chars takes no plus
    if (start == end || (start != p && (*start == '-' || *start == '+'))) return false;
    const auto result = std::from_chars(start, end, value);
    if (result.ec == std::errc::invalid_argument) return false;
    if (result.ec == std::errc::result_out_of_range)
        value = static_cast<float>(std::strtod(std::string(start, result.ptr).c_str(), nullptr));
    p = result.ptr;
    return true;
}

} // namespace snell
