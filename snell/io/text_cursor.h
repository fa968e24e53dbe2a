// Reading numbers and words from text in memory, with places for errors.
#pragma once

#include "snell/core/error.h"
#include "snell/io/read_number.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>
#include <string_view>
#include <system_error>

namespace snell {

inline bool is_blank(char c)
{
    return c == ' ' || c == '\t';
}

inline bool is_space(char c)
{
    return c == ' ' || (c >= '\t' && c <= '\r');
}

inline std::string_view trim(std::string_view text)
{
    while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
    while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
    return text;
}

// Where `at`, a part of `text`, begins; counts the lines before it, so only for errors.
inline Place place_in(const std::string& file, std::string_view text, const char* at)
{
    const std::string_view before = text.substr(0, static_cast<std::size_t>(at - text.data()));
    const std::size_t start = before.rfind('\n');
    const auto column = start == std::string_view::npos ? before.size() : before.size() - start - 1;
    constexpr std::ptrdiff_t most = std::numeric_limits<int>::max() - 1;
    const std::ptrdiff_t line = std::min<std::ptrdiff_t>(most, std::count(before.begin(), before.end(), '\n'));
    return {file, static_cast<int>(line) + 1, static_cast<int>(std::min<std::size_t>(column, most)) + 1};
}

// What to print of a word of unknown length and content.
inline std::string show_word(std::string_view word)
{
    std::string shown = "'";
    for (const char c : word.substr(0, 40)) shown += c >= ' ' && c <= '~' ? c : '?';
    return shown + (word.size() > 40 ? "...'" : "'");
}

// A place in a text that is read word by word; line ends are spaces like any other.
class TextCursor
{
  public:
    TextCursor(std::string file, std::string_view text, std::size_t offset = 0)
        : file_(std::move(file)), text_(text), p_(text.data() + offset), end_(text.data() + text.size())
    {
    }

    bool at_end()
    {
        skip_spaces();
        return p_ == end_;
    }

    // The next word; empty at the end.
    std::string_view word()
    {
        skip_spaces();
        const char* start = p_;
        while (p_ < end_ && !is_space(*p_)) ++p_;
        return {start, static_cast<std::size_t>(p_ - start)};
    }

    std::string_view rest_of_line()
    {
        const char* start = p_;
        while (p_ < end_ && *p_ != '\n' && *p_ != '\r') ++p_;
        return trim({start, static_cast<std::size_t>(p_ - start)});
    }

    // `what`: what the number is, for the error.
    float number(std::string_view what)
    {
        skip_spaces();
        const char* start = p_;
        float value = 0;
        if (!read_float(p_, end_, value) || (p_ < end_ && !is_space(*p_))) fail_at(start, what);
        return value;
    }

    long long integer(std::string_view what)
    {
        skip_spaces();
        const char* start = p_;
        long long value = 0;
        const auto result = std::from_chars(p_, end_, value);
        p_ = result.ptr;
        if (result.ec != std::errc() || (p_ < end_ && !is_space(*p_))) fail_at(start, what);
        return value;
    }

    void skip_word()
    {
        if (word().empty()) fail_at(p_, "a value");
    }

    std::size_t bytes_left() const { return static_cast<std::size_t>(end_ - p_); }
    Place place(std::string_view at) const { return place_in(file_, text_, at.data()); }
    Place place() const { return place_in(file_, text_, p_); }

  private:
    void skip_spaces()
    {
        while (p_ < end_ && is_space(*p_)) ++p_;
    }

    [[noreturn]] void fail_at(const char* start, std::string_view what)
    {
        p_ = start;
        const std::string_view found = word();
        if (found.empty())
            throw Error(place_in(file_, text_, start), fmt::format("the file ends where {} should be", what),
                        "it is truncated: get or write it again");
        throw Error(place_in(file_, text_, start),
                    fmt::format("{} should be here, but there is {}", what, show_word(found)),
                    "mend the file or write it again");
    }

    std::string file_;
    std::string_view text_;
    const char* p_;
    const char* end_;
};

} // namespace snell
