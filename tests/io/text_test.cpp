#include "snell/io/read_number.h"
#include "snell/io/text_encoding.h"
#include "tests/io/mesh_files.h"

#include <bit>
#include <cmath>
#include <cstdlib>

namespace snell {
namespace {

TEST(TextEncoding, IsKnownByItsFirstBytes)
{
    const auto detect = [](std::string_view start) {
        std::size_t mark = 99;
        const Encoding encoding = detect_encoding(start, mark);
        return std::pair(encoding, mark);
    };
    using namespace std::string_view_literals;
    EXPECT_EQ(detect("v 0 "), std::pair(Encoding::bytes, std::size_t{0}));
    EXPECT_EQ(detect("\xEF\xBB\xBFv"), std::pair(Encoding::bytes, std::size_t{3}));
    EXPECT_EQ(detect("\xFF\xFEv\0"sv), std::pair(Encoding::utf16_little, std::size_t{2}));
    EXPECT_EQ(detect("\xFE\xFF\0v"sv), std::pair(Encoding::utf16_big, std::size_t{2}));
    EXPECT_EQ(detect("v\0 \0"sv), std::pair(Encoding::utf16_little, std::size_t{0}));
    EXPECT_EQ(detect("\0v\0 "sv), std::pair(Encoding::utf16_big, std::size_t{0}));
    // A binary file that begins like a mark.
    EXPECT_EQ(detect("\xFF\xFE\x12\x34"), std::pair(Encoding::bytes, std::size_t{0}));
    EXPECT_EQ(detect("\xFF\xFE"), std::pair(Encoding::bytes, std::size_t{0}));
}

TEST(TextEncoding, Utf16BecomesUtf8)
{
    using namespace std::string_literals;
    EXPECT_EQ(to_utf8("\xFF\xFEv\0\xFC\0\xAC\x20\x3D\xD8\x22\xDC"s), "v\xC3\xBC\xE2\x82\xAC\xF0\x9F\x90\xA2");
    EXPECT_EQ(to_utf8("\xFE\xFF\0v\xD8\x3D\xDC\x22"s), "v\xF0\x9F\x90\xA2");
    EXPECT_EQ(to_utf8("\xFF\xFEv\0\x3D\xD8v\0"s), "v\xEF\xBF\xBDv"); // half a pair
    EXPECT_EQ(to_utf8("\xFF\xFEv\0\x22\xDC"s), "v\xEF\xBF\xBD");
    EXPECT_EQ(to_utf8("\xFF\xFEv\0v"s), "v\xEF\xBF\xBD"); // half a character
    EXPECT_EQ(to_utf8("\xEF\xBB\xBFplain"), "plain");
}

float parse(const std::string& text)
{
    const char* p = text.data();
    float value = -77;
    EXPECT_TRUE(read_float(p, text.data() + text.size(), value)) << text;
    EXPECT_EQ(p, text.data() + text.size()) << text;
    return value;
}

TEST(ReadNumber, IsRoundedAsTheStandardLibraryDoes)
{
    std::uint32_t state = 3;
    const auto random = [&state] { return state = state * 1664525u + 1013904223u; };
    const auto expect = [](const std::string& text) {
        EXPECT_EQ(std::bit_cast<std::uint32_t>(parse(text)),
                  std::bit_cast<std::uint32_t>(std::strtof(text.c_str(), nullptr)))
            << text;
    };
    for (int i = 0; i < 20000; ++i) {
        const float value = std::bit_cast<float>(random());
        if (!std::isfinite(value)) continue;
        expect(fmt::format("{}", value));
        expect(fmt::format("{:.6f}", std::fmod(value, 1000.0f)));
        expect(fmt::format("{:.{}g}", value, 1 + random() % 17));
        // Halfway between two floats, and a digit more or less: rounding twice would go wrong here.
        const float next = std::nextafter(value, 1e30f);
        if (!(std::abs(value) > 1e-3f && std::abs(value) < 1e6f)) continue;
        const std::string half = fmt::format("{:.17g}", 0.5 * (double(value) + double(next)));
        expect(half);
        expect(half + "1");
    }
    for (const char* text : {"0", "-0", "+1", ".5", "-.5e1", "5.", "1e-45", "1e-50", "3.4028236e38", "1e39",
                             "123456789012345678901234567890", "0.000000000000000000000000000001", "1e+05", "1E5",
                             "16777217", "16777219", "9007199254740993", "1.17549435e-38", "1e-400"})
        expect(text);
    EXPECT_TRUE(std::signbit(parse("-0")));
}

TEST(ReadNumber, TakesWhatIsANumberAndNoMore)
{
    const auto rest = [](const std::string& text) {
        const char* p = text.data();
        float value = 0;
        return read_float(p, text.data() + text.size(), value) ? std::string(p) : "no number";
    };
    EXPECT_EQ(rest("1e5x"), "x");
    EXPECT_EQ(rest("1.5.5"), ".5");
    EXPECT_EQ(rest("1e"), "e");
    EXPECT_EQ(rest("1e+"), "e+");
    EXPECT_EQ(rest("12/3"), "/3");
    for (const char* text : {"", "-", "+", ".", "+-1", "--1", "e5", "x", ".e1"})
        EXPECT_EQ(rest(text), "no number") << text;
}

} // namespace
} // namespace snell
